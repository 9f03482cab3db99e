// SPDX-License-Identifier: Apache-2.0
// Common part of the three simulated robot interfaces: everything except the command.
#pragma once

#include <algorithm>

#include "library/mujoco/arm_body.h"
#include "library/mujoco/simulated_arm.h"

namespace chimera::library {

/// Base of a component that moves a simulated arm. The component adds the in-var of the command, cycle(), and init()
/// and reinit(), which load the arm.
struct RobotBody : ArmBody<SimulatedArm> {
  InConst<double[]> start_pose{"start_pose", "rad", "[ndof<=10]", initial = 0.0, frame = "joint",
                               doc = "Where the arm stands at init, within the joint limits."};
  InConst<double[]> torque_limit{"torque_limit", "N.m", "[ndof<=10]", initial = 0.0, range(0, 1e6), frame = "joint",
                                 doc = "Cuts the torque of the drives; 0: the limit of the model."};
  OutConst<std::int32_t> ndof{"ndof", "1", doc = "Joints from the base to the tip."};
  OutConst<DhLink[]> dh{"dh", "1", "[ndof<=10]", doc = "Denavit-Hartenberg rows, base to tip."};
  OutConst<Pose> base{"base", "1", frame = "base", doc = "Frame 0."};
  OutConst<Pose> tool{"tool", "1", frame = "last", doc = "Tool frame in frame ndof."};
  OutConst<double[]> q_min{"q_min", "rad", "[ndof<=10]", frame = "joint", doc = "Lower joint limits; -1e6 for none."};
  OutConst<double[]> q_max{"q_max", "rad", "[ndof<=10]", frame = "joint", doc = "Upper joint limits; 1e6 for none."};
  OutConst<double[]> tau_max{"tau_max", "N.m", "[ndof<=10]", frame = "joint",
                             doc = "Largest torque of the drives; 1e6 without a limit."};
  OutConst<bool[]> is_continuous{"is_continuous", "1", "[ndof<=10]", doc = "The joint turns without end."};

 protected:
  /// For init: `load` reads the arm and returns a Result<void>. Throws its error, or that of place().
  template <class Load>
  void start(Load load) {
    check(load());
    tell();
    check(arm_.place({start_pose.begin(), arm_.joints()}));
  }
  /// For reinit: changes limits or drives and keeps the place, at rest.
  template <class Load>
  void restart(Load load) {
    ArmVector here;
    const std::size_t joints = arm_.joints();
    std::ranges::copy(arm_.position(), here.begin());
    check(load());
    tell();
    check(arm_.place({here.data(), joints}));
  }
  /// Gives the user a note about the model file, if there is one.
  void tell_note(Cycle c) const {
    if (!arm_.note().empty()) c.note(arm_.note().c_str());
  }
  Outcome move(ArmInterface interface, const In<double[]>& command, Cycle c) {
    const bool moved = c.illegal() ? arm_.step_locally_stable(c.dt())
                                   : arm_.step(interface, {command.begin(), command.size()}, c.dt());
    return after(moved, c.illegal());
  }

 private:
  void tell() {
    const ArmModel& arm = arm_.arm();
    *ndof = static_cast<std::int32_t>(arm.ndof);
    arm_.limit_torque({torque_limit.begin(), arm.ndof});
    std::copy_n(arm.chain.dh.begin(), arm.ndof, dh.begin());
    *base = arm.chain.base;
    *tool = arm.chain.tool;
    std::copy_n(arm.low.begin(), arm.ndof, q_min.begin());
    std::copy_n(arm.high.begin(), arm.ndof, q_max.begin());
    std::copy_n(arm.torque_limit.begin(), arm.ndof, tau_max.begin());
    std::copy_n(arm.is_continuous.begin(), arm.ndof, is_continuous.begin());
  }
};

/// An arm from a file of the user.
struct RobotFace : RobotBody {
  InConst<Text<64>> tip{"tip", "1", initial = "",
                        doc = "Link, body or site that is the tool; empty: behind the most joints."};
  Resource model{"model", shared, doc = "MJCF or URDF file."};

  void init(Cycle c) {
    start([this] { return arm_.load(model.c_str(), tip->c_str()); });
    tell_note(c);
  }
  void reinit() {
    restart([this] { return arm_.load(model.c_str(), tip->c_str()); });
  }
};

}  // namespace chimera::library
