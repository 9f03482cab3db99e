// SPDX-License-Identifier: Apache-2.0
// Checks STL and OBJ files for their numbers of triangles and vertices.
#include "chimera/base/hosted/ordinary_file.h"
#include "library/mujoco/mesh_file.h"

#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace chimera::library {
namespace {

constexpr std::uintmax_t kLongest = std::uintmax_t{64} << 20;
constexpr std::size_t kStlHead = 84, kStlFace = 50;

std::string fault_of_stl(const std::string& bytes) {
  std::uint32_t faces = 0;
  if (bytes.size() >= kStlHead) std::memcpy(&faces, bytes.data() + 80, sizeof faces);
  if (bytes.size() >= kStlHead && bytes.size() == kStlHead + std::uint64_t{faces} * kStlFace) return {};
  if (bytes.starts_with("solid")) return "is an STL of text; MuJoCo reads binary ones";
  return "is a damaged STL";
}

/// Checks that each word begins with a valid vertex number, up to the first '/'. OBJ counts from 1; negative numbers
/// count from the end.
bool has_its_vertices(std::istringstream& words, long vertices) {
  for (std::string word; words >> word;) {
    char* end = nullptr;
    const long number = std::strtol(word.c_str(), &end, 10);
    const bool is_number = end != word.c_str() && (*end == '\0' || *end == '/');
    if (!is_number || number == 0 || number > vertices || number < -vertices) return false;
  }
  return true;
}

bool is_point(std::istringstream& words) {
  for (int i = 0; i < 3; ++i) {
    std::string word;
    char* end = nullptr;
    if (!(words >> word) || !std::isfinite(std::strtod(word.c_str(), &end)) || *end != '\0') return false;
  }
  return true;
}

std::string fault_of_obj(const std::string& bytes) {
  long vertices = 0, faces = 0;
  std::istringstream lines(bytes);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    if (!(words >> kind)) continue;
    if (kind == "v" && !is_point(words)) return "is a damaged OBJ";
    if (kind == "v") ++vertices;
    if (kind == "f" && !has_its_vertices(words, vertices)) return "is a damaged OBJ";
    if (kind == "f") ++faces;
  }
  return vertices < 4 || faces == 0 ? "is an OBJ without a body" : "";
}

}  // namespace

std::string mesh_extension(std::string_view name) {
  std::string extension = std::filesystem::path(name).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".stl" || extension == ".obj" ? extension : "";
}

std::string read_mesh(const std::string& path, const std::string& extension, std::string& why) {
  why = not_ordinary(path, SIZE_MAX);
  if (!why.empty()) return "";
  std::error_code fault;
  const std::uintmax_t size = std::filesystem::file_size(path, fault);
  if (!fault && size > kLongest) return why = "is larger than 64 MiB", "";
  std::ifstream file(path, std::ios::binary);
  std::string bytes(fault ? 0 : static_cast<std::size_t>(size), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (fault || !file) return why = "cannot be read", "";
  why = extension == ".stl" ? fault_of_stl(bytes) : fault_of_obj(bytes);
  return why.empty() ? bytes : "";
}

}  // namespace chimera::library
