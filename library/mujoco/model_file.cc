// SPDX-License-Identifier: Apache-2.0
// Loads MJCF and URDF files, and tries again without the meshes that MuJoCo refuses.
#include "library/mujoco/model_file.h"

#include <mujoco/mujoco.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>

#include "chimera/base/hosted/classic_locale.h"
#include "library/mujoco/mujoco_guard.h"
#include "library/mujoco/urdf_meshes.h"

namespace chimera::library {
namespace {

constexpr char kMain[] = "model.xml";

/// Files in memory that MuJoCo can open.
class MemoryFiles {
 public:
  MemoryFiles() { mj_defaultVFS(files_.get()); }
  ~MemoryFiles() { mj_deleteVFS(files_.get()); }
  MemoryFiles(const MemoryFiles&) = delete;
  MemoryFiles& operator=(const MemoryFiles&) = delete;

  void add(const char* name, const std::string& bytes) {
    if (mj_makeEmptyFileVFS(files_.get(), name, static_cast<int>(bytes.size())) != 0) return;
    std::memcpy(files_->filedata[files_->nfile - 1], bytes.data(), bytes.size());
  }
  const mjVFS& all() const noexcept { return *files_; }

 private:
  std::unique_ptr<mjVFS> files_ = std::make_unique<mjVFS>();
};

/// Joins the lines of a MuJoCo message.
std::string one_line(const char* text) {
  std::string line;
  for (; *text != '\0'; ++text) {
    if (*text != '\n') line += *text;
    else if (!line.empty() && line.back() != ' ' && text[1] != '\0') line += ' ';
  }
  return line;
}

mjModel* load(const char* path, const mjVFS* files, std::string& why) {
  const ClassicLocale decimal_point;
  struct Call {
    const char* path;
    const mjVFS* files;
    mjModel* model;
    char said[1000];
  } call{path, files, nullptr, ""};
  const bool has_returned = guarded_setup(
      [](void* with) {
        Call& c = *static_cast<Call*>(with);
        c.model = mj_loadXML(c.path, c.files, c.said, sizeof c.said);
      },
      &call);
  why = one_line(has_returned ? call.said : mujoco_error());
  return has_returned ? call.model : nullptr;
}

mjModel* load_with(const UrdfMeshes& urdf, std::string& why) {
  MemoryFiles files;
  files.add(kMain, urdf.text());
  for (const UrdfMesh& mesh : urdf.meshes())
    if (mesh.why.empty()) files.add(mesh.as.c_str(), mesh.bytes);
  return load(kMain, &files.all(), why);
}

/// Returns true if MuJoCo accepts the mesh as a body. Some well-formed meshes have no volume or are inside out.
bool is_body(const UrdfMesh& mesh, std::string& why) {
  const std::string scale = mesh.scale.empty() ? "" : " scale='" + mesh.scale + "'";
  MemoryFiles files;
  files.add(mesh.as.c_str(), mesh.bytes);
  files.add(kMain, "<mujoco><asset><mesh name='m' file='" + mesh.as + "'" + scale +
                       "/></asset><worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>");
  mjModel* model = load(kMain, &files.all(), why);
  mj_deleteModel(model);
  return model != nullptr;
}

/// Leaves out each mesh that MuJoCo refuses. Returns false if there is none.
bool leave_out_refused(UrdfMeshes& urdf) {
  bool any = false;
  for (std::size_t i = 0; i < urdf.meshes().size(); ++i) {
    std::string why;
    if (!urdf.meshes()[i].why.empty() || is_body(urdf.meshes()[i], why)) continue;
    urdf.leave_out(i, why);
    any = true;
  }
  return any;
}

mjModel* load_urdf(UrdfMeshes urdf, std::string& why, std::string& note) {
  mjModel* model = load_with(urdf, why);
  if (model == nullptr && leave_out_refused(urdf)) model = load_with(urdf, why);
  if (model != nullptr) note = urdf.note();
  else if (why.find("mjMINVAL") != std::string::npos) why += "; a mesh weighs nothing, say it in <inertial>";
  return model;
}

}  // namespace

mjModel_* load_model(const char* path, std::string& why, std::string& note) {
  std::ifstream file(path, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(file), {});
  if (!UrdfMeshes::are_in(text)) return load(path, nullptr, why);
  return load_urdf(UrdfMeshes(std::move(text), path), why, note);
}

mjModel_* load_model(const char* path, const mjVFS_& files, std::string& why) { return load(path, &files, why); }

}  // namespace chimera::library
