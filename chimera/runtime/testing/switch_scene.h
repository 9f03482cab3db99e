// SPDX-License-Identifier: Apache-2.0
// For tests: an application on two rtpus with three configurations, in which the variable u of plant comes from a task
// of the other rtpu (direct), from there by way of a new task here (observed), or from a task of its own rtpu (beside).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "chimera/runtime/testing/test_application.h"

namespace chimera::testing::switch_scene {

/// Orders to the components of a run, and their observations. One run at a time.
struct Scene {
  std::vector<std::string> story;
  std::function<void(Cycle)> in_plant, in_reader;  // of two rtpus
  double on_of_two = 0;
  bool on_of_two_fails = false;
  int illegal = 0;  // cycles that saw the flag up
};
inline Scene scene;

struct Plant {
  In<double> u{"u", "1"};
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle c) {
    *y = *y + 0.1 * (*u - *y);
    if (scene.in_plant) scene.in_plant(c);
    scene.illegal += c.illegal() ? 1 : 0;
  }
};

struct Beacon {  // has no links to others
  Out<double> b{"b", "1", initial = 0.0};
  void cycle(Cycle c) { *b = static_cast<double>(c.count()); }
};

/// Reads u in the other rtpu.
struct Reader {
  In<double> u{"u", "1"};
  Out<double> seen{"seen", "1", initial = 0.0};
  void cycle(Cycle c) {
    *seen = *u;
    if (scene.in_reader) scene.in_reader(c);
    scene.illegal += c.illegal() ? 1 : 0;
  }
};

struct One {  // 7 while it cycles
  Out<double> u{"u", "1", initial = 0.0};
  void on(Cycle) { scene.story.emplace_back("on one"); }
  void cycle(Cycle) { *u = 7; }
  void off(Cycle) {
    scene.story.emplace_back("off one");
    *u = 1e6;  // no task may see this
  }
};

struct Observer {
  In<double> y{"y", "1"};
  Out<double> z{"z", "1", initial = 0.0};
  void on(Cycle) {
    scene.story.emplace_back("on observer");
    *z = *y;
  }
  void cycle(Cycle) { *z = *y; }
  void off(Cycle) { scene.story.emplace_back("off observer"); }
};

struct Two {  // 7 from its first cycle on, what on says before
  In<double> z{"z", "1"};
  Out<double> u{"u", "1", initial = 0.0};
  Outcome on(Cycle) {
    scene.story.emplace_back("on two");
    if (scene.on_of_two_fails) return fault("no current");
    *u = *u + scene.on_of_two;
    return ok();
  }
  void cycle(Cycle) { *u = 7; }
  void off(Cycle) {
    scene.story.emplace_back("off two");
    *u = 1e6;
  }
};

inline constexpr TaskId kPlant{0u}, kBeacon{1u}, kReader{2u}, kOne{3u}, kObserver{4u}, kTwo{5u}, kThree{6u};
inline constexpr std::uint32_t kDirect = 0, kObserved = 1, kBeside = 2;

/// The tasks of the configurations.
inline const std::vector<TaskId> kSets[] = {{kPlant, kBeacon, kReader, kOne},
                                            {kPlant, kBeacon, kReader, kObserver, kTwo},
                                            {kPlant, kBeacon, kReader, kThree}};
inline const NamedSet kNamedSets[] = {{"direct", kSets[0]}, {"observed", kSets[1]}, {"beside", kSets[2]}};

/// All tasks at 1 kHz. `limit`: the max_step of u where task two writes it; 0: none. `limit` outlives the application.
inline std::unique_ptr<TestApplication> application(const double& limit, bool starts) {
  auto app = std::make_unique<TestApplication>();
  app->rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
  const auto add = [&](const char* name, const chimera_component* what, std::uint32_t rtpu) {
    app->add(name, what).rtpu = RtpuId(rtpu);
  };
  add("plant", component<Plant>("plant"), 0);
  add("beacon", component<Beacon>("beacon"), 0);
  add("reader", component<Reader>("reader"), 1);
  add("one", component<One>("one"), 1);
  add("observer", component<Observer>("observer"), 0);
  add("two", component<Two>("two"), 1);
  add("three", component<Two>("two"), 0);  // in the rtpu of plant
  app->link(kThree.index, 0, "y");
  if (limit > 0) app->port(kTwo.index, 1).max_step = std::as_bytes(std::span(&limit, 1));
  app->make(kSets[kDirect], starts);
  app->spec.sets = kNamedSets;
  return app;
}

}  // namespace chimera::testing::switch_scene
