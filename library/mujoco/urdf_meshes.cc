// SPDX-License-Identifier: Apache-2.0
// Scans the tags of a URDF file, reads its collision meshes and leaves out its visual ones.
#include "library/mujoco/urdf_meshes.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "library/mujoco/mesh_file.h"
#include "library/mujoco/mesh_folders.h"

namespace chimera::library {
namespace {

constexpr std::size_t kMostMeshes = 500;
constexpr std::size_t kShownName = 32;
constexpr std::string_view kWeightless =
    R"(<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>)";

std::string short_name(const std::string& called) {
  const std::string bare = std::filesystem::path(called).filename().string();
  return bare.size() <= kShownName ? bare : bare.substr(0, kShownName) + "...";
}

}  // namespace

bool UrdfMeshes::are_in(std::string_view text) {
  XmlTags tags(text);
  XmlTag tag;
  if (!tags.next(tag) || tag.element != "robot") return false;
  while (tags.next(tag))
    if (tag.element == "mesh") return true;
  return false;
}

UrdfMeshes::UrdfMeshes(std::string text, const std::string& path) : source_(std::move(text)) {
  XmlTags tags(source_);
  for (XmlTag tag; tags.next_of_all(tag);) tag.is_end ? close(tag) : take(tag);
  const MeshFolders folders(path, mesh_folder_);
  for (std::size_t i = 0; i < meshes_.size(); ++i) {
    UrdfMesh& mesh = meshes_[i];
    if (i >= kMostMeshes) {
      mesh.why = "is one of more than " + std::to_string(kMostMeshes);
      continue;
    }
    const std::string extension = mesh_extension(mesh.called);
    if (extension.empty()) mesh.why = "MuJoCo reads STL and OBJ";
    else if (const std::string found = folders.find(mesh.called, mesh.why); !found.empty())
      mesh.bytes = read_mesh(found, extension, mesh.why);
    mesh.as = "mesh_" + std::to_string(i) + extension;
  }
}

void UrdfMeshes::take(const XmlTag& tag) {
  if (tag.element == "compiler") mesh_folder_ = plain(value_of(tag, "meshdir"));
  if (tag.element == "link") link_ = {tag.end, false, false};
  if (tag.element == "inertial") link_.has_inertial = true;
  if (tag.element == "mesh" && is_in_part_) take_mesh(tag);
  const bool is_part = tag.element == "collision" || tag.element == "visual";
  if (!is_part || tag.is_empty) return;
  part_ = {{tag.begin, 0}, kPicture, {}};
  is_in_part_ = true;
  is_picture_ = tag.element == "visual";
  has_name_ = false;
}

void UrdfMeshes::take_mesh(const XmlTag& tag) {
  const std::string_view name = value_of(tag, "filename");
  if (has_name_ || name.data() == nullptr) return;
  const auto begin = static_cast<std::size_t>(name.data() - source_.data());
  part_.name = {begin, begin + name.size()};
  has_name_ = true;
  if (is_picture_) return;
  link_.has_mesh = true;
  part_.mesh = meshes_.size();
  meshes_.push_back({plain(name), std::string(value_of(tag, "scale")), {}, {}, {}});
}

void UrdfMeshes::close(const XmlTag& tag) {
  if (is_in_part_ && (tag.element == "collision" || tag.element == "visual")) {
    part_.whole.end = tag.end;
    if (has_name_) parts_.push_back(part_);
    is_in_part_ = false;
  }
  if (tag.element != "link") return;
  if (link_.has_mesh && !link_.has_inertial) weightless_.push_back(link_.inside);
  link_ = {};
}

void UrdfMeshes::leave_out(std::size_t i, std::string why) {
  meshes_[i].why = std::move(why);
  meshes_[i].bytes.clear();
}

std::string UrdfMeshes::text() const {
  std::string made;
  std::size_t at = 0;
  const auto copy_to = [&](std::size_t end) {
    made.append(source_, at, end - at);
    at = end;
  };
  std::size_t weightless = 0;
  const auto weigh_to = [&](std::size_t end) {
    for (; weightless < weightless_.size() && weightless_[weightless] <= end; ++weightless) {
      copy_to(weightless_[weightless]);
      made += kWeightless;
    }
  };
  for (const Part& part : parts_) {
    weigh_to(part.whole.begin);
    copy_to(part.whole.begin);
    if (part.mesh < meshes_.size() && meshes_[part.mesh].why.empty()) {
      copy_to(part.name.begin);
      made += meshes_[part.mesh].as;
      at = part.name.end;
      copy_to(part.whole.end);
    } else {
      for (; at < part.whole.end; ++at) made += source_[at] == '\n' ? '\n' : ' ';
    }
  }
  weigh_to(source_.size());
  copy_to(source_.size());
  return made;
}

std::string UrdfMeshes::note() const {
  const auto is_out = [](const UrdfMesh& mesh) { return !mesh.why.empty(); };
  const auto first = std::ranges::find_if(meshes_, is_out);
  if (first == meshes_.end()) return {};
  const auto out = static_cast<std::size_t>(std::ranges::count_if(meshes_, is_out));
  return std::to_string(out) + " of " + std::to_string(meshes_.size()) +
         " collision meshes left out, masses and joints as stated: " + short_name(first->called) + ": " + first->why +
         (out > 1 ? "; and " + std::to_string(out - 1) + " more" : "");
}

}  // namespace chimera::library
