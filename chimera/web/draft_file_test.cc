// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/draft_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "chimera/description/yaml_reader.h"

namespace chimera::web {
namespace {

namespace fs = std::filesystem;

struct DraftFileTest : ::testing::Test {
  DraftFileTest() : place(::mkdtemp(made)) {}
  ~DraftFileTest() override {
    fs::permissions(place, fs::perms::owner_all);
    fs::remove_all(place);
  }
  void write(const std::string& text) const { std::ofstream(path, std::ios::binary) << text; }
  static std::string content(const std::string& of) {
    std::ostringstream all;
    all << std::ifstream(of, std::ios::binary).rdbuf();
    return all.str();
  }
  std::string problem() { return file.read().problem; }
  KeptDraft keeper() {
    return {place + "/state/drafts", path, [this](const std::string& text) { told += text + "\n"; }};
  }

  char made[40] = "/tmp/chimera_draft_XXXXXX";
  std::string place, path = place + "/arm.yaml", told;
  DraftFile file{path};
};

TEST_F(DraftFileTest, ReadsOrdinaryTextsOnlyAndNamesTheReason) {
  EXPECT_EQ(file.read(), FileNow());
  write("a: 1\r\n\tb: [");
  EXPECT_EQ(file.read(), (FileNow{true, "a: 1\r\n\tb: [", ""})) << "no YAML is a text too";
  write(std::string(kMaxTextBytes + 1, '#'));
  EXPECT_EQ(problem(), path + ": the file has more than 262144 bytes");
  write("a: \xff");
  EXPECT_EQ(problem(), path + ": byte 0xFF is not valid UTF-8");
  write(std::string("a: \0", 4));
  EXPECT_EQ(problem(), path + ": byte 0x00 is a control character");
  fs::remove(path);
  fs::create_symlink("nowhere", path);
  EXPECT_EQ(problem(), path + ": is a link to a file that is not there");
  fs::remove(path);
  fs::create_symlink("arm.yaml", path);
  EXPECT_NE(problem().find("cannot be read: Too many levels of symbolic links"), std::string::npos) << problem();
  fs::remove(path);
  fs::create_directory(path);
  EXPECT_EQ(problem(), path + ": is no ordinary file but a folder");
  fs::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(problem(), path + ": is no ordinary file but a pipe");
}

TEST_F(DraftFileTest, SeesAReplacedFileAtMostTwiceASecond) {
  write("a");
  EXPECT_EQ(file.read().text, "a");
  const std::string other = place + "/other";
  std::ofstream(other) << "b";
  fs::rename(other, path);
  const auto seen = file.read_changed(seconds(10));
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->text, "b");
  write("c");
  EXPECT_FALSE(file.read_changed(seconds(10) + milliseconds(499)));
  EXPECT_EQ(file.read_changed(seconds(10) + milliseconds(500)).value_or(FileNow()).text, "c") << "in place, same tick";
  fs::remove(path);
  EXPECT_FALSE(file.read_changed(seconds(11)).value_or(FileNow{.exists = true}).exists);
  EXPECT_FALSE(file.read_changed(seconds(12))) << "it is still not there";
}

TEST_F(DraftFileTest, WritesOnlyOverTheFileThatItRead) {
  EXPECT_FALSE(file.read().exists);
  write("theirs");
  const auto made_between = file.write("mine");
  ASSERT_FALSE(made_between);
  EXPECT_EQ(made_between.error().message.view(), "is there already");
  EXPECT_EQ(content(path), "theirs");
  (void)file.read();
  EXPECT_TRUE(file.write("mine"));
  fs::remove(path);
  write("theirs again");
  EXPECT_EQ(file.write("mine").error().message.view(), "changed just now");
  EXPECT_EQ(content(path), "theirs again");
  fs::remove(path);
  (void)file.read();
  EXPECT_TRUE(file.write("made"));
  EXPECT_EQ(content(path), "made");
  EXPECT_EQ(std::distance(fs::directory_iterator(place), {}), 1) << "no part of a file is left";
}

TEST_F(DraftFileTest, LeavesALinkALink) {
  std::ofstream(place + "/real.yaml") << "a";
  fs::create_symlink("real.yaml", path);
  EXPECT_EQ(file.read().text, "a");
  EXPECT_TRUE(file.write("b"));
  EXPECT_TRUE(fs::is_symlink(path));
  EXPECT_EQ(content(place + "/real.yaml"), "b");
}

TEST_F(DraftFileTest, KeepsADraftForItsUserAloneAndReadsItBack) {
  const KeptText kept{"mine: \"x\"\r\nä\n", "theirs\n"};
  std::string at;
  {
    KeptDraft one = keeper();
    EXPECT_EQ(one.read(), std::nullopt);
    ASSERT_TRUE(one.keep(KeptText{"first", std::nullopt}));
    ASSERT_TRUE(one.keep(kept));
    at = one.path();
    EXPECT_EQ(static_cast<unsigned>(fs::status(at).permissions()), 0600u);
    EXPECT_EQ(static_cast<unsigned>(fs::status(place + "/state/drafts").permissions()), 0700u);
  }
  std::ofstream(at + ".AbCd12") << "part";
  KeptDraft two = keeper();
  EXPECT_EQ(two.read(), kept);
  EXPECT_FALSE(fs::exists(at + ".AbCd12"));
  ASSERT_TRUE(two.keep(std::nullopt));
  EXPECT_FALSE(fs::exists(at));
  EXPECT_EQ(told, "");
}

TEST_F(DraftFileTest, SetsAsideWhatIsNoKeptDraft) {
  const std::string at = keeper().path();
  const auto with = [&](const std::string& text) { return [=] { std::ofstream(at, std::ios::binary) << text; }; };
  std::string good;
  {
    KeptDraft one = keeper();
    ASSERT_TRUE(one.keep(KeptText{"mine", "theirs"}));
    good = content(at);
    fs::remove(at);
  }
  std::string foreign = good;
  foreign.replace(foreign.find("arm.yaml"), 3, "leg");
  const std::pair<std::function<void()>, const char*> cases[] = {
      {with(""), "is no kept draft"},
      {with("garbage"), "is no kept draft"},
      {with("[1]\nmine"), "is no kept draft"},
      {with(good.substr(0, good.size() - 1)), "is damaged"},
      {with(good + "x"), "is damaged"},
      {with(good + std::string(5'000'000, '#')), "is damaged"},
      {with(foreign), "is the draft of "},
      {[&] { fs::create_symlink(path, at); }, "is no ordinary file"},
      {[&] { fs::create_directory(at); }, "is no ordinary file"},
      {[&] { ASSERT_EQ(::mkfifo(at.c_str(), 0600), 0); }, "is no ordinary file"}};
  write("must stay");
  int number = 0;
  for (const auto& [make, why] : cases) {
    make();
    KeptDraft one = keeper();
    EXPECT_EQ(one.read(), std::nullopt) << why;
    EXPECT_NE(one.aside().find(why), std::string::npos) << one.aside();
    EXPECT_EQ(told, one.aside() + "\n");
    told.clear();
    EXPECT_EQ(fs::symlink_status(at).type(), fs::file_type::not_found);
    EXPECT_NE(fs::symlink_status(at + "-aside-" + std::to_string(++number)).type(), fs::file_type::not_found);
  }
  EXPECT_EQ(content(path), "must stay");
}

TEST_F(DraftFileTest, SetsAsideAFileThatAnotherProgramPutInThePlace) {
  KeptDraft one = keeper();
  ASSERT_TRUE(one.keep(KeptText{"first", std::nullopt}));
  fs::remove(one.path());
  fs::create_symlink(path, one.path());
  write("must stay");
  ASSERT_TRUE(one.keep(KeptText{"second", std::nullopt}));
  EXPECT_EQ(content(path), "must stay");
  EXPECT_EQ(fs::read_symlink(one.path() + "-aside-1"), path);
  EXPECT_NE(content(one.path()).find("second"), std::string::npos);
}

TEST_F(DraftFileTest, OneProcessAtATimeKeepsTheDraft) {
  std::optional<KeptDraft> one = keeper();
  ASSERT_TRUE(one->keep(KeptText{"first", std::nullopt}));
  KeptDraft two = keeper();
  EXPECT_EQ(two.read(), std::nullopt);
  const auto refused = two.keep(KeptText{"second", std::nullopt});
  ASSERT_FALSE(refused);
  EXPECT_NE(std::string(refused.error().message.view()).find("another chimera web (process "), std::string::npos);
  one.reset();
  ASSERT_TRUE(two.keep(KeptText{"second", std::nullopt}));
  EXPECT_NE(content(two.path() + "-aside-1").find("first"), std::string::npos) << "the draft of the first is not lost";
}

TEST_F(DraftFileTest, RefusesAStateFolderThatIsNone) {
  KeptDraft none("", path, [](const std::string&) {});
  EXPECT_EQ(none.read(), std::nullopt);
  EXPECT_FALSE(none.keep(KeptText{"a", std::nullopt}));
  fs::create_directory_symlink(place, place + "/linked");
  KeptDraft linked(place + "/linked", path, [](const std::string&) {});
  EXPECT_FALSE(linked.keep(KeptText{"a", std::nullopt}));
}

}  // namespace
}  // namespace chimera::web
