// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/documents.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "chimera/base/testing/tree_path.h"

namespace chimera::web {
namespace {

namespace fs = std::filesystem;

struct DocumentsTest : ::testing::Test {
  void SetUp() override {
    char made[] = "/tmp/chimera-documents-XXXXXX";
    place = ::mkdtemp(made);
  }
  void TearDown() override { fs::remove_all(place); }
  void put(const std::string& name, const std::string& text) const {
    fs::create_directories(fs::path(place + "/" + name).parent_path());
    std::ofstream(place + "/" + name) << text;
  }
  std::string refusal(const Documents& documents, const std::string& name) const {
    const auto text = documents.read(name);
    return text ? "" : text.error().message.c_str();
  }

  std::string place;
};

TEST_F(DocumentsTest, ListsTextsAndPicturesOfTheFoldersThatPeopleRead) {
  for (const char* name : {"README.md", "docs/a.md", "docs/pictures/b.svg", "examples/1/c.yaml", "library/d/d.cc",
                           "docs/program.so", "docs/.hidden/e.md", "docs/.f.md", "build/g.md", "secret.md"})
    put(name, "# " + std::string(name) + "\n");
  const Documents documents = Documents::in(place);
  EXPECT_EQ(documents.names(), (std::vector<std::string>{"README.md", "docs/a.md", "docs/pictures/b.svg",
                                                         "examples/1/c.yaml", "library/d/d.cc"}));
  EXPECT_EQ(documents.titles().size(), 2u);
  EXPECT_EQ(documents.titles().find("docs/a.md")->second, "docs/a.md");
  EXPECT_EQ(*documents.read("docs/a.md"), "# docs/a.md\n");
}

TEST_F(DocumentsTest, OpensNothingUnderANameThatIsNotListed) {
  put("docs/a.md", "text");
  put("secret.md", "secret");
  const Documents documents = Documents::in(place);
  for (const std::string name : {"secret.md", "docs/../secret.md", "docs/./a.md", "/etc/passwd", "", "docs",
                                 "docs/a.md/", "docs//a.md", "DOCS/A.MD", "docs/b.md", "../../etc/passwd"})
    EXPECT_EQ(refusal(documents, name), "no such document") << name;
  EXPECT_EQ(refusal(documents, std::string("docs/a.md\0", 10)), "no such document");
  EXPECT_TRUE(documents.read("docs/a.md"));
}

TEST_F(DocumentsTest, RefusesSymbolicLinks) {
  put("outside/secret.md", "secret");
  put("docs/a.md", "text");
  put("docs/deep/b.md", "text");
  fs::create_symlink(place + "/outside/secret.md", place + "/docs/link.md");
  fs::create_directory_symlink(place + "/outside", place + "/docs/folder");
  fs::create_directory_symlink(place + "/outside", place + "/library");
  const Documents documents = Documents::in(place);
  EXPECT_EQ(documents.names(), (std::vector<std::string>{"docs/a.md", "docs/deep/b.md"}));
  fs::remove(place + "/docs/a.md");  // after the listing
  fs::create_symlink(place + "/outside/secret.md", place + "/docs/a.md");
  EXPECT_EQ(refusal(documents, "docs/a.md"), "is reached through a symbolic link");
  fs::rename(place + "/docs/deep", place + "/moved");
  fs::create_directory_symlink(place + "/moved", place + "/docs/deep");
  EXPECT_EQ(refusal(documents, "docs/deep/b.md"), "is reached through a symbolic link");
}

TEST_F(DocumentsTest, RefusesWhatIsTooLargeGoneOrNoOrdinaryFile) {
  put("docs/large.md", std::string((1 << 20) + 1, 'a'));
  put("docs/whole.md", std::string(1 << 20, 'a'));
  put("docs/large.png", std::string((4 << 20) + 1, 'a'));
  put("docs/gone.md", "text");
  put("docs/pipe.md", "text");
  const Documents documents = Documents::in(place);
  EXPECT_EQ(refusal(documents, "docs/large.md"), "has more than 1048576 bytes");
  EXPECT_EQ(documents.read("docs/whole.md")->size(), std::size_t{1} << 20);
  EXPECT_EQ(refusal(documents, "docs/large.png"), "has more than 4194304 bytes");
  fs::remove(place + "/docs/gone.md");
  EXPECT_EQ(refusal(documents, "docs/gone.md"), "cannot be opened: No such file or directory");
  fs::remove(place + "/docs/pipe.md");
  ASSERT_EQ(::mkfifo((place + "/docs/pipe.md").c_str(), 0600), 0);
  EXPECT_EQ(refusal(documents, "docs/pipe.md"), "is no ordinary file but a pipe");
}

TEST_F(DocumentsTest, IsEmptyWithoutItsFolder) {
  EXPECT_TRUE(Documents::in(place + "/none").names().empty());
  EXPECT_EQ(refusal(Documents::in(place + "/none"), "README.md"), "no such document");
}

TEST(Documents, HasTheGlossaryTheLessonsAndTheSheetsOfTheCheckout) {
  const Documents documents = Documents::in(source_path(""));
  for (const char* name : {"docs/glossary.md", "docs/papers.md", "examples/01_puma_pid/README.md",
                           "library/pid/README.md", "library/pid/pid.cc", "library/lowpass/response.svg"})
    EXPECT_TRUE(documents.has(name)) << name;
  EXPECT_EQ(documents.titles().find("library/pid/README.md")->second, "pid");
  EXPECT_LT(documents.names().size(), 4000u);
}

TEST(Documents, WriteBytesInBase64) {
  const std::pair<std::string, std::string> kCases[] = {{"", ""},        {"f", "Zg=="},          {"fo", "Zm8="},
                                                        {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}, {"\xff\xfe", "//4="}};
  for (const auto& [bytes, text] : kCases) EXPECT_EQ(base64(bytes), text);  // RFC 4648, section 10
}

}  // namespace
}  // namespace chimera::web
