// SPDX-License-Identifier: Apache-2.0
// The simulated Reconfigurable Modular Manipulator System: provides the constants of its modules.
#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>

#include "library/mujoco/robot_face.h"
#include "library/rmms/module_store.h"

using namespace chimera;

namespace {

struct Rmms : library::RobotBody {
  In<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", frame = "joint", doc = "Wanted position; cut at the joint limits."};
  InConst<double> bandwidth{"bandwidth", "rad/s", initial = 100.0, range(1, 200),
                            doc = "Angular frequency at which a joint error decays."};
  InConst<double> speed_limit{"speed_limit", "rad/s", initial = 1.5, range(0.01, 10), doc = "Largest joint speed."};
  Resource store{"store", shared, doc = "Module store: a text file."};

  void init() {
    set_drives();
    start([this] { return load(); });
  }
  void reinit() {
    set_drives();
    restart([this] { return load(); });
  }
  Outcome cycle(Cycle c) { return move(library::ArmInterface::kPosition, q_ref, c); }

 private:
  void set_drives() {
    arm_.set_drives({.bandwidth = *bandwidth, .speed_limit = *speed_limit, .acceleration_limit = 10});
  }
  Result<void> load() {
    const Result<library::ModuleStore> modules = library::ModuleStore::read(store.c_str());
    if (!modules) return modules.error();
    const std::string text = modules->mjcf();
    const std::unique_ptr<mjVFS> files(new mjVFS);
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "rmms.xml", static_cast<int>(text.size()));
    std::memcpy(files->filedata[0], text.data(), text.size());
    Result<void> loaded = arm_.load("rmms.xml", "tip", files.get());
    mj_deleteVFS(files.get());
    return loaded;
  }
};

CHIMERA_COMPONENT(Rmms, "rmms", "Reconfigurable Modular Manipulator System, simulated.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3; Schmitz, Khosla and Kanade 1988");

}  // namespace
