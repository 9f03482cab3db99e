// SPDX-License-Identifier: Apache-2.0
// For tests: two tools of another mass on two rtpus, each in a configuration of its own. The arm that holds one of them
// and the law that reckons with what the arm makes of it stay ON, so that a switch between the two is slow.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "chimera/runtime/testing/test_application.h"

namespace chimera::testing::tool_scene {

/// Orders to the components of a run, and their observations. One run at a time. What steps of a slow switch call is
/// called by one context after the other; the rest is of one task alone.
struct Shop {
  std::vector<std::string> story;            // steps
  std::string fails;                         // the step that answers with a fault: "on heavy"
  std::function<void(const std::string&)> in_step;
  double ramp = 0;                           // what light adds to its grip in each cycle
  std::vector<double> weighed;               // by the cycles of the arm
  int illegal = 0, illegal_of_law = 0;       // cycles that saw the flag up, of the arm, of the law
};
inline Shop shop;

inline Outcome tell(const char* what) {
  shop.story.emplace_back(what);
  if (shop.in_step) shop.in_step(what);
  return shop.fails == what ? fault("no") : ok();
}

struct Light {
  OutConst<double> mass{"mass", "kg"};
  Out<double> grip{"grip", "1", initial = 0.0};
  void init(Cycle) { *mass = 1; }
  Outcome on(Cycle) { return tell("on light"); }
  void cycle(Cycle c) { *grip = 1 + shop.ramp * static_cast<double>(c.count()); }
  Outcome off(Cycle) { return tell("off light"); }
};

struct Heavy {
  OutConst<double> mass{"mass", "kg"};
  Out<double> grip{"grip", "1", initial = 0.0};
  void init(Cycle) { *mass = 3; }
  Outcome on(Cycle) { return tell("on heavy"); }
  void cycle(Cycle) { *grip = 2; }
  Outcome off(Cycle) { return tell("off heavy"); }
};

struct Arm {
  InConst<double> mass{"mass", "kg"};
  In<double> grip{"grip", "1"};
  Out<double> force{"force", "N", initial = 0.0};
  OutConst<double> load{"load", "kg"};
  Resource link{"link"};
  void init(Cycle) { *load = *mass * 10; }
  Outcome reinit(Cycle) {
    *load = *mass * 10;
    return tell("reinit arm");
  }
  void cycle(Cycle c) {
    shop.weighed.push_back(*mass);
    shop.illegal += c.illegal() ? 1 : 0;
    *force = *mass;
  }
};

struct Law {
  InConst<double> load{"load", "kg"};
  In<double> force{"force", "N"};
  Out<double> u{"u", "N", initial = 0.0};
  Outcome reinit(Cycle) { return tell("reinit law"); }
  void cycle(Cycle c) {
    shop.illegal_of_law += c.illegal() ? 1 : 0;
    *u = *load;
  }
};

inline constexpr TaskId kLight{0u}, kHeavy{1u}, kArm{2u}, kLaw{3u};
inline constexpr std::uint32_t kWithLight = 0, kWithHeavy = 1;

/// The tasks of the configurations.
inline const std::vector<TaskId> kSets[] = {{kLight, kArm, kLaw}, {kHeavy, kArm, kLaw}};
inline const NamedSet kNamedSets[] = {{"light", kSets[0]}, {"heavy", kSets[1]}};

/// All tasks at 1 kHz: the arm on the first rtpu, the other tool and the law on the second.
inline std::unique_ptr<TestApplication> application(std::uint32_t rtpu_of_light) {
  auto app = std::make_unique<TestApplication>();
  app->rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
  const auto add = [&](const char* name, const chimera_component* what, std::uint32_t rtpu) {
    app->add(name, what).rtpu = RtpuId(rtpu);
  };
  add("light", component<Light>("light"), rtpu_of_light);
  add("heavy", component<Heavy>("heavy"), 1);
  add("arm", component<Arm>("arm"), 0);
  add("law", component<Law>("law"), 1);
  app->make(kSets[kWithLight], false);
  app->spec.sets = kNamedSets;
  return app;
}

}  // namespace chimera::testing::tool_scene
