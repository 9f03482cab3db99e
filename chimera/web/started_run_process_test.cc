// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/started_run.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <filesystem>
#include <fstream>

#include "chimera/base/testing/await.h"
#include "chimera/text/json.h"

namespace chimera::web {
namespace {

namespace fs = std::filesystem;

/// A script in the place of `chimera`.
struct StartedRunTest : ::testing::Test {
  StartedRunTest() : place(::mkdtemp(made)) {}
  ~StartedRunTest() override { fs::remove_all(place); }
  void script(const std::string& text) {
    std::ofstream(place + "/chimera") << "#!/bin/sh\n" << text;
    fs::permissions(place + "/chimera", fs::perms::owner_all);
    run.emplace(place + "/chimera", place + "/state/drafts");
  }
  void await_end() {
    ASSERT_TRUE(await_that([this] {
      pollfd ended{run->descriptor(), POLLIN, 0};
      ::poll(&ended, 1, 5);
      run->serve(seconds(1));
      return run->descriptor() < 0;
    }));
  }
  Json output() { return *run->output().result; }

  char made[40] = "/tmp/chimera_start_XXXXXX";
  std::string place;
  std::optional<StartedRun> run;
};

TEST_F(StartedRunTest, RunsFileAndShowsItsOutputAndItsEnd) {
  script("echo \"$@\"; echo error >&2; cat; exit 3\n");
  EXPECT_EQ(output().dump(), R"({"ended":null,"pid":null,"text":""})");
  const control::RpcResponse started = run->start("/a/arm.yaml");
  ASSERT_TRUE(started.is_good()) << started.message;
  await_end();
  EXPECT_EQ(output()["pid"], (*started.result)["pid"]);
  EXPECT_EQ(output()["ended"], Json("with status 3"));
  EXPECT_EQ(output()["text"], Json("run /a/arm.yaml\nerror\n"));
  EXPECT_EQ(static_cast<unsigned>(fs::status(place + "/state/drafts/output").permissions()), 0600u);
}

TEST_F(StartedRunTest, RefusesASecondOneWhileTheFirstRunsAndShowsTheLast16KiB) {
  script("if [ -e \"$2\" ]; then echo again; exit; fi; touch \"$2\"; "
         "i=0; while [ $i -lt 3000 ]; do echo 'line of 16 char'; i=$((i+1)); done; echo last; "
         "while [ ! -e \"$2.go\" ]; do sleep 0.01; done; kill -9 $$\n");
  const std::string file = place + "/file";
  ASSERT_TRUE(run->start(file).is_good());
  EXPECT_EQ(run->start(file).detail("kind"), "under-way");
  ASSERT_TRUE(await_that([this] { return output()["text"].as_string().ends_with("last\n"); }));
  EXPECT_EQ(output()["text"].as_string().size(), StartedRun::kShown);
  EXPECT_TRUE(output()["ended"].is_null());
  std::ofstream(file + ".go") << "";
  await_end();
  EXPECT_EQ(output()["ended"], Json("by signal 9 (SIGKILL)"));
  ASSERT_TRUE(run->start(file).is_good());
  await_end();
  EXPECT_EQ(output()["text"], Json("again\n"));
}

TEST_F(StartedRunTest, WritesThroughNoLink) {
  script("echo mine\n");
  fs::create_directories(place + "/state/drafts");
  std::ofstream(place + "/other") << "must stay";
  fs::create_symlink(place + "/other", place + "/state/drafts/output");
  ASSERT_TRUE(run->start("x").is_good());
  await_end();
  EXPECT_EQ(fs::file_size(place + "/other"), 9u);
}

TEST_F(StartedRunTest, NamesWhatIsMissing) {
  run.emplace(place + "/nothing", place + "/state/drafts");
  EXPECT_NE(run->start("x").message.find("nothing"), std::string::npos);
  run.emplace("/bin/true", "");
  EXPECT_FALSE(run->start("x").is_good());
}

}  // namespace
}  // namespace chimera::web
