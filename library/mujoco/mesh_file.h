// SPDX-License-Identifier: Apache-2.0
// Checks the file of a mesh before MuJoCo reads it.
#pragma once

#include <string>
#include <string_view>

namespace chimera::library {

/// Returns ".stl" or ".obj" in small letters, or an empty text for a form that MuJoCo 2.2 does not read. Context:
/// setup.
std::string mesh_extension(std::string_view name);

/// Returns the bytes of the file at `path`. Returns an empty text, and sets `why`, if the file cannot be read, is
/// larger than 64 MiB or is no mesh: an STL file in text form or with a length that contradicts its number of faces; an
/// OBJ file with a vertex that is no number or a face with a missing vertex, which MuJoCo would accept. Context: setup;
/// may block.
std::string read_mesh(const std::string& path, const std::string& extension, std::string& why);

}  // namespace chimera::library
