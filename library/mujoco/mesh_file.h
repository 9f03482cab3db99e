// SPDX-License-Identifier: Apache-2.0
// The file of a mesh, looked at before MuJoCo reads it.
#pragma once

#include <string>
#include <string_view>

namespace chimera::library {

/// ".stl" or ".obj", in small letters; empty for what MuJoCo 2.2 does not read. Context: setup.
std::string mesh_extension(std::string_view name);

/// What stands in the file at `path`; empty, with `why`, for one that cannot be read, is larger than 64 MiB, or is no
/// mesh: an STL file that is text or has not the length that its count of faces says; an OBJ file with a vertex that is
/// no number or a face of vertices that there are not, which MuJoCo takes without a word. Context: setup; may block.
std::string read_mesh(const std::string& path, const std::string& extension, std::string& why);

}  // namespace chimera::library
