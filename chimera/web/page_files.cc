// SPDX-License-Identifier: Apache-2.0
// Reads the files of the page from the build tree or from the place where they are installed.
#include "chimera/web/page_files.h"

#include <filesystem>

#include "chimera/base/hosted/ordinary_file.h"

namespace chimera::web {
namespace {

constexpr std::size_t kMostBytes = std::size_t{16} << 20;

Result<PageContents> read_from(const std::filesystem::path& folder) {
  PageContents contents;
  for (std::size_t i = 0; i < contents.size(); ++i) {
    auto text = read_ordinary((folder / kPageFiles[i].name).string(), kMostBytes);
    if (!text) return text.error();
    contents[i] = *std::move(text);
  }
  return contents;
}

}  // namespace

Result<PageContents> read_page(const std::string& program) {
  const auto above = std::filesystem::path(program).parent_path().parent_path();
  const auto built = above / "page", installed = above / "share/chimera/page";
  if (auto contents = read_from(built)) return contents;
  auto contents = read_from(installed);
  if (contents) return contents;
  return Message("the page is not there: " + std::string(contents.error().message.view()) + ", nor is it in " +
                 built.string() + "; `./dev install` builds and installs it")
      .error(contents.error().code, contents.error().where.view());
}

}  // namespace chimera::web
