// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/bench.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "chimera/base/testing/tree_path.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process_state.h"
#include "chimera/platform/socket_place.h"
#include "chimera/text/json.h"

namespace chimera::web {
namespace {

/// Connections that wait at a socket: each is a question whether a process listens there.
std::size_t questions(const SocketPlace& socket) {
  std::size_t n = 0;
  while (accept_now(socket.descriptor()).fd >= 0) ++n;
  return n;
}

struct BenchTest : ::testing::Test {
  void SetUp() override {
    char made[] = "/tmp/chimera-bench-XXXXXX";
    place = ::mkdtemp(made);
    bench.emplace(facts("/a/arm.yaml"), clock, [](const std::string&) {});
  }
  void TearDown() override { std::filesystem::remove_all(place); }
  BenchFacts facts(const std::string& file) const { return {"1.2.3", file, own(), service(), place, "", {}}; }
  std::string own() const { return place + "/own"; }
  std::string service() const { return place + "/service"; }
  static SocketPlace listen(const std::string& folder, const std::string& name) {
    return *SocketPlace::open(folder, name, false);
  }
  control::RpcResponse call(const char* method) {
    control::RpcResponse answer;
    bench->call(*control::find_method(method), Json::object(), {control::Role::kConfigure, 1, 0},
                [&](const control::RpcResponse& given) { answer = given; });
    return answer;
  }
  std::string machines() { return (*call("machines").result)["machines"].dump(); }
  void pass(Nanoseconds span) { clock.advance(span); }

  std::string place;
  VirtualClock clock;
  std::optional<Bench> bench;
};

TEST_F(BenchTest, SaysWhoItIs) {
  const Json hello = *call("hello").result;
  EXPECT_EQ(hello["protocol"], Json(1));
  EXPECT_EQ(hello["program"], Json("1.2.3"));
  EXPECT_EQ(hello["role"], Json("configure"));
  EXPECT_EQ(hello["file"], Json("/a/arm.yaml"));
  EXPECT_EQ(hello["user"], Json(user_name(own_user())));
  EXPECT_EQ(hello["pid"].as_int64(), own_process_id());
  EXPECT_EQ(hello["folder"], Json(std::filesystem::current_path().string()));
  EXPECT_FALSE(hello["host"].as_string().empty());
  bench.emplace(facts(""), clock, [](const std::string&) {});
  EXPECT_TRUE((*call("hello").result)["file"].is_null());
}

TEST_F(BenchTest, NamesOwnSubsystemsThenServicesOfOtherNames) {
  EXPECT_EQ(machines(), "[]");
  pass(seconds(1));
  const SocketPlace b = listen(own(), "b"), a = listen(own(), "a");
  const SocketPlace same = listen(service(), "a"), c = listen(service(), "c");
  EXPECT_EQ(machines(), R"([{"name":"a","service":false},{"name":"b","service":false},{"name":"c","service":true}])");
}

TEST_F(BenchTest, ListsNoFolderToWhichOthersMayWrite) {
  const SocketPlace a = listen(own(), "a");
  std::filesystem::permissions(own(), std::filesystem::perms::all);
  EXPECT_EQ(machines(), "[]");
}

TEST_F(BenchTest, ConnectsToTheSubsystemOfTheUserBeforeAService) {
  EXPECT_LT(bench->connect("a").fd, 0);
  EXPECT_EQ(errno, ENOENT);
  const SocketPlace serving = listen(service(), "a");
  EXPECT_GE(bench->connect("a").fd, 0);
  EXPECT_EQ(questions(serving), 1u);
  const SocketPlace a = listen(own(), "a");
  EXPECT_GE(bench->connect("a").fd, 0);
  EXPECT_EQ(questions(serving), 0u);
  EXPECT_EQ(questions(a), 1u);
}

TEST_F(BenchTest, ListsOnceASecond) {
  EXPECT_EQ(machines(), "[]");
  const SocketPlace a = listen(own(), "a");
  pass(milliseconds(999));
  EXPECT_EQ(machines(), "[]");
  pass(milliseconds(1));
  EXPECT_EQ(machines(), R"([{"name":"a","service":false}])");
}

TEST_F(BenchTest, ConnectsToSocketsOnlyAfterAChangeAndEveryTenSeconds) {
  const SocketPlace a = listen(own(), "a");
  (void)questions(a);
  EXPECT_NE(machines(), "[]");
  pass(seconds(2));
  EXPECT_NE(machines(), "[]");
  (void)questions(a);
  for (int i = 0; i < 7; ++i) pass(seconds(1)), (void)machines();
  EXPECT_EQ(questions(a), 0u);
  pass(seconds(1)), (void)machines();
  EXPECT_EQ(questions(a), 1u);
  pass(seconds(1)), (void)machines();
  EXPECT_EQ(questions(a), 0u);
  bench->look_again();
  (void)machines();  // within the second of the last listing
  EXPECT_EQ(questions(a), 0u);
  pass(seconds(1)), (void)machines();
  EXPECT_EQ(questions(a), 1u);
}

TEST_F(BenchTest, NotifiesAtOnceAndAtEachChange) {
  const Json to_machines{{"to", "machines"}};
  EXPECT_TRUE(bench->open(1, to_machines).is_good());
  EXPECT_EQ(bench->pull(1)->dump(), R"({"machines":[]})");
  EXPECT_EQ(bench->pull(1), nullptr);
  std::optional<SocketPlace> a = listen(own(), "a");
  pass(seconds(1));
  EXPECT_TRUE(bench->open(2, to_machines).is_good());
  const std::string one = R"({"machines":[{"name":"a","service":false}]})";
  EXPECT_EQ(bench->pull(1)->dump(), one);
  EXPECT_EQ(bench->pull(2)->dump(), one);
  bench->close(1);
  a.reset();
  pass(seconds(1));
  EXPECT_EQ(bench->pull(2)->dump(), R"({"machines":[]})");
  EXPECT_EQ(bench->pull(2), nullptr);
}

TEST_F(BenchTest, WithoutFileThereIsNoDraft) {
  bench.emplace(facts(""), clock, [](const std::string&) {});
  for (const char* method :
       {"draft", "edit", "replace", "remedies", "transitions", "differences", "write", "keep", "start"}) {
    EXPECT_EQ(call(method).code, control::kRefused) << method;
    EXPECT_EQ(call(method).detail("kind"), "draft") << method;
  }
  EXPECT_EQ(bench->open(1, {{"to", "draft"}}).detail("kind"), "draft");
  EXPECT_EQ(call("output").result->dump(), R"({"ended":null,"pid":null,"text":""})");
}

TEST_F(BenchTest, NotifiesOfTheDraftAtOnceAndAtEachChange) {
  const std::string file = place + "/arm.yaml";
  bench.emplace(facts(file), clock, [](const std::string&) {});
  EXPECT_TRUE(bench->open(1, {{"to", "draft"}}).is_good());
  EXPECT_EQ(bench->pull(1)->dump(Json::Style::kAsMade),
            "{\"version\":1,\"file\":\"" + file +
                "\",\"exists\":false,\"touched\":false,\"outside\":false,\"problem\":null}");
  EXPECT_EQ(bench->pull(1), nullptr);
  std::ofstream(file) << "a: 1";
  pass(milliseconds(499));
  EXPECT_EQ(bench->pull(1), nullptr);
  pass(milliseconds(1));
  EXPECT_EQ((*bench->pull(1))["version"], Json(2));
  EXPECT_EQ(bench->pull(1), nullptr);
}

TEST_F(BenchTest, ListsComponentsAndDescriptorsThatCannotBeRead) {
  BenchFacts made = facts(place + "/arm.yaml");
  made.workplace.unit_files = {source_path("share/chimera/units.xml")};
  bench.emplace(made, clock, [](const std::string&) {});
  const auto faults = [this] { return Json::parse(*call("library").text)["faults"]; };
  EXPECT_EQ(faults().size(), 0u);
  std::filesystem::create_directories(place + "/build/components");
  std::ofstream(place + "/build/components/cut.component.json") << "{";
  EXPECT_EQ(faults().size(), 0u) << "folders are read once a second";
  pass(seconds(1));
  ASSERT_EQ(faults().size(), 1u);
  EXPECT_EQ(faults()[0]["file"], Json(place + "/build/components/cut.component.json"));
  EXPECT_FALSE(faults()[0]["message"].as_string().empty());
  made.workplace.unit_files = {"/nowhere/units.xml"};
  bench.emplace(made, clock, [](const std::string&) {});
  EXPECT_EQ(call("library").detail("kind"), "library");
  const control::RpcResponse draft = call("draft");
  EXPECT_TRUE(draft.is_good()) << "the text is there without components";
}

TEST_F(BenchTest, RefusesWhatASubsystemAnswers) {
  EXPECT_EQ(call("status").code, control::kNoMethod);
  EXPECT_EQ(call("end").message, "'end' is a method of a subsystem: connect to /machine/NAME");
  EXPECT_EQ(bench->open(1, {{"to", "values"}}).code, control::kBadParameters);
}

}  // namespace
}  // namespace chimera::web
