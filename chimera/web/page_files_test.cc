// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/page_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace chimera::web {
namespace {

struct PageFilesTest : ::testing::Test {
  void SetUp() override {
    char made[] = "/tmp/chimera-page-XXXXXX";
    place = ::mkdtemp(made);
  }
  void TearDown() override { std::filesystem::remove_all(place); }
  void put(const std::string& folder, const std::string& mark) const {
    std::filesystem::create_directories(place + folder);
    for (const PageFile& file : kPageFiles) std::ofstream(place + folder + "/" + file.name) << mark << file.name;
  }
  Result<PageContents> read() const { return read_page(place + "/bin/chimera-web"); }

  std::string place;
};

TEST_F(PageFilesTest, PrefersThePageOfTheBuildTree) {
  put("/share/chimera/page", "installed ");
  ASSERT_TRUE(read());
  EXPECT_EQ((*read())[1], "installed page.js");
  put("/page", "built ");
  EXPECT_EQ((*read())[0], "built index.html");
  std::filesystem::remove(place + "/page/icon.svg");  // a page is taken whole
  EXPECT_EQ((*read())[0], "installed index.html");
}

TEST_F(PageFilesTest, SaysWhatIsMissing) {
  put("/share/chimera/page", "");
  std::filesystem::remove(place + "/share/chimera/page/page.css");
  const auto page = read();
  ASSERT_FALSE(page);
  EXPECT_EQ(page.error().where.view(), place + "/share/chimera/page/page.css");
  EXPECT_EQ(page.error().message.view(),
            "the page is not there: cannot be opened: No such file or directory, nor is it in " + place +
                "/page; `./dev install` builds and installs it");
}

}  // namespace
}  // namespace chimera::web
