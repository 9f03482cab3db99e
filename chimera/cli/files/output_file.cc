// SPDX-License-Identifier: Apache-2.0
// Tries whether a file can be written, and writes it.
#include "chimera/cli/files/output_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace chimera::cli {
namespace {

Error not_written(const std::string& path, int why) {
  return {ErrorCode::kSystem, {std::string("cannot be written: ") + std::strerror(why)}, {path}};
}

}  // namespace

Result<void> may_write(const std::string& path) {
  if (path.empty()) return {};
  std::error_code error;
  const bool existed = std::filesystem::exists(path, error);
  const bool may = static_cast<bool>(std::ofstream(path, std::ios::binary | std::ios::app));
  if (!may) return not_written(path, errno);
  if (!existed) std::filesystem::remove(path, error);
  return {};
}

Result<void> write_whole(const std::string& path, const std::string& text) {
  if (path.empty()) return {};
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (file.flush()) return {};
  return not_written(path, errno);
}

}  // namespace chimera::cli
