// SPDX-License-Identifier: Apache-2.0
// The main() of a fuzz target without a fuzzer: runs the target once for each file of a corpus folder.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);

namespace {

std::vector<std::string> files_of(const char* folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.is_regular_file(error)) files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

bool replay(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) return false;
  // A block of exactly this size, so that the address sanitizer sees a read behind the last byte.
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: %s CORPUS\n", argv[0]), 2;
  const std::vector<std::string> files = files_of(argv[1]);
  if (files.empty()) return std::fprintf(stderr, "no inputs in %s\n", argv[1]), 1;
  for (const std::string& path : files) {
    // Prints the path first. If the target aborts, the last line before its message names the input.
    std::fprintf(stderr, "%s\n", path.c_str());
    if (!replay(path)) return std::fprintf(stderr, "%s cannot be read\n", path.c_str()), 1;
  }
  std::printf("%zu inputs replayed\n", files.size());
  return 0;
}
