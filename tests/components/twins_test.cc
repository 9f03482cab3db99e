// SPDX-License-Identifier: Apache-2.0
// Components of the library beside their twins in C (t_tderiv.c, t_limit.c, t_pid_joint.c): on every executor of one
// context both publish the same bytes and have the same faults.
#include <gtest/gtest.h>

#include <cstring>
#include <deque>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "chimera/runtime/testing/test_application.h"
#include "chimera/task/registry.h"
#include "tests/conformance/runner.h"

namespace chimera::toy::c_twins_test {
namespace {

constexpr std::size_t kValues = 1 + 3 + 2;  // of dx, y and tau
std::vector<double> recorded;               // a row of the C++ components, then one of the C components, ...

/// Publishes inputs. Now and then one of them is infinite.
struct Feed {
  Out<double> x{"x", "1"};
  Out<double[3]> xs{"xs", "1"};
  Out<double[2]> q_ref{"q_ref", "1"}, qd_ref{"qd_ref", "1"}, q{"q", "1"}, qd{"qd", "1"};
  Out<double[2]> kp{"kp", "1"}, ki{"ki", "1"}, kd{"kd", "1"};

  void cycle() {
    *x = next();
    for (double& value : xs) value = next();
    for (auto* port : {&q_ref, &qd_ref, &q, &qd, &kp, &ki, &kd})
      for (double& value : *port) value = next();
  }
  double next() {
    seed_ = seed_ * 6364136223846793005u + 1442695040888963407u;
    if (seed_ >> 33 < 1u << 24) return std::numeric_limits<double>::infinity();  // 1 of 128
    return 20 * (static_cast<double>(seed_ >> 11) * 0x1p-53 - 0.5);
  }
  std::uint64_t seed_ = 1;
};

struct Recorder {
  In<double> dx{"dx", "1", intermittent}, c_dx{"c_dx", "1", intermittent};
  In<double[3]> y{"y", "1", intermittent}, c_y{"c_y", "1", intermittent};
  In<double[2]> tau{"tau", "1", intermittent}, c_tau{"c_tau", "1", intermittent};

  void cycle() {
    recorded.push_back(*dx);
    recorded.insert(recorded.end(), y.begin(), y.end());
    recorded.insert(recorded.end(), tau.begin(), tau.end());
    recorded.push_back(*c_dx);
    recorded.insert(recorded.end(), c_y.begin(), c_y.end());
    recorded.insert(recorded.end(), c_tau.begin(), c_tau.end());
  }
};

const chimera_component* linked(const std::string& name) {
  std::uint32_t count = 0;
  const chimera_component* const* all = chimera_components(CHIMERA_ABI_VERSION, &count);
  for (std::uint32_t i = 0; i < count; ++i)
    if (all[i]->name == name) return all[i];
  ADD_FAILURE() << "no component " << name;
  std::abort();
}

class Scene {
 public:
  Scene() {
    add("feed", testing::component<Feed>("feed")).offset = milliseconds(3);
    for (const std::string prefix : {"", "t_"}) {
      add_twin(prefix + "tderiv", 1);
      const std::size_t limit = add_twin(prefix + "limit", 3);
      link(limit, "x", "xs");
      give(limit, "low", std::vector<double>{-5, -1, 0});
      give(limit, "high", std::vector<double>{5, 0.5, 9});
      const std::size_t pid = add_twin(prefix + "pid_joint", 2);
      give(pid, "ndof", std::vector<std::int32_t>{2});
      give(pid, "tau_max", std::vector<double>{50, 120});
      give(pid, "is_continuous", std::vector<std::uint8_t>{0, 1});
    }
    add("recorder", testing::component<Recorder>("recorder"));
  }

  TaskSet& build() {
    set_ = *HeapTaskSet::create(app_.make(), app_.components);
    return *set_;
  }
  const Task& task(std::size_t index) const { return set_->tasks()[index]; }

  static constexpr std::size_t kTwins = 3;  // the C++ tasks are 1 to 3, the C tasks 4 to 6

 private:
  const chimera_port_decl& declared(std::size_t task, std::size_t port) { return app_.components[task]->ports[port]; }
  std::size_t port(std::size_t task, std::string_view name) {
    std::size_t found = 0;
    while (name != declared(task, found).name) ++found;
    return found;
  }
  void link(std::size_t task, const char* name, std::string_view to) { app_.link(task, port(task, name), to); }

  /// Every port of an open shape has `open` elements.
  TaskSpec& add(const std::string& name, const chimera_component* component, std::uint32_t open = 1) {
    TaskSpec& made = app_.add(names_.emplace_back(name).c_str(), component);
    const std::size_t task = app_.tasks.size() - 1;
    for (std::size_t p = 0; p < component->n_ports; ++p) {
      const char* const shape = declared(task, p).shape;
      std::uint32_t& extent = app_.port(task, p).extent[0].max;
      if (shape[0] != '\0') extent = shape[1] == 'n' ? open : static_cast<std::uint32_t>(shape[1] - '0');
      repeat(app_.port(task, p));
    }
    return made;
  }
  std::size_t add_twin(const std::string& name, std::uint32_t open) {
    const bool is_c = name.starts_with("t_");
    add(name, linked(name), open);
    const std::size_t task = app_.tasks.size() - 1;
    for (std::size_t p = 0; p < app_.components[task]->n_ports; ++p) {
      if (declared(task, p).kind == CHIMERA_IN_CONST) app_.link(task, p, "");
      if (declared(task, p).kind == CHIMERA_OUT_VAR && is_c)
        app_.link(task, p, names_.emplace_back(std::string("c_") + declared(task, p).name));
    }
    return task;
  }
  /// One initial value stands for all elements.
  void repeat(PortSpec& port) {
    if (port.value.empty() || port.value.size() >= port.max_bytes()) return;
    std::vector<std::byte>& all = values_.emplace_back();
    for (std::uint32_t i = 0; i < port.max_count(); ++i) all.insert(all.end(), port.value.begin(), port.value.end());
    port.value = all;
  }
  template <class T>
  void give(std::size_t task, const char* name, const std::vector<T>& value) {
    std::vector<std::byte>& all = values_.emplace_back(value.size() * sizeof(T));
    std::memcpy(all.data(), value.data(), all.size());
    app_.port(task, port(task, name)).value = all;
  }

  testing::TestApplication app_;
  std::deque<std::string> names_;
  std::deque<std::vector<std::byte>> values_;
  std::unique_ptr<HeapTaskSet> set_;
};

/// Both PID tasks go OFF and ON again, once with a torque that is handed over and once with an outdated one; then the
/// illegal-configuration flag is up for a while.
std::vector<ScriptAct> acts() {
  using Kind = ScriptAct::Kind;
  std::vector<ScriptAct> all;
  for (const std::size_t task : {3, 6}) {
    all.push_back({milliseconds(100), Kind::kSignal, Signal::kOff, TaskId(task)});
    all.push_back({milliseconds(104), Kind::kSignal, Signal::kOn, TaskId(task)});
    all.push_back({milliseconds(200), Kind::kSignal, Signal::kOff, TaskId(task)});
    all.push_back({milliseconds(250), Kind::kSignal, Signal::kOn, TaskId(task)});
  }
  all.push_back({milliseconds(300), Kind::kRaiseFlag, {}, TaskId()});
  all.push_back({milliseconds(310), Kind::kLowerFlag, {}, TaskId()});
  std::stable_sort(all.begin(), all.end(), [](const ScriptAct& a, const ScriptAct& b) { return a.at < b.at; });
  return all;
}

std::vector<double> run(toy::Kind kind) {
  Scene scene;
  TaskSet& set = scene.build();
  const std::vector<ScriptAct> script = acts();
  recorded.clear();
  Runner runner(set, kind, Policy::kEdf, script);
  EXPECT_TRUE(runner.start());
  runner.run(milliseconds(1000));
  EXPECT_TRUE(runner.refused().empty());
  for (std::size_t twin = 1; twin <= Scene::kTwins; ++twin) {
    const Task &cpp = scene.task(twin), &c = scene.task(twin + Scene::kTwins);
    EXPECT_EQ(cpp.faults.count, c.faults.count) << twin;
    EXPECT_STREQ(cpp.faults.last.text, c.faults.last.text);
    EXPECT_EQ(cpp.faults.last.code, c.faults.last.code);
    EXPECT_EQ(cpp.faults.at, c.faults.at);
    EXPECT_TRUE(twin == 1 || c.faults.count > 10) << "an infinite input is a fault";
  }
  return recorded;
}

class CTwins : public ::testing::TestWithParam<toy::Kind> {};
INSTANTIATE_TEST_SUITE_P(Executors, CTwins, kEachExecutor, name_of_kind);

TEST_P(CTwins, PublishTheBytesOfTheirCppTwins) {
  const std::vector<double> rows = run(GetParam());
  ASSERT_EQ(rows.size() % (2 * kValues), 0u);
  ASSERT_GT(rows.size(), 990 * 2 * kValues);
  std::size_t changes = 0;
  for (std::size_t at = 0; at < rows.size(); at += 2 * kValues) {
    ASSERT_EQ(std::memcmp(&rows[at], &rows[at + kValues], kValues * sizeof(double)), 0)
        << "row " << at / (2 * kValues);
    if (at > 0 && rows[at + kValues - 1] != rows[at - kValues - 1]) ++changes;
  }
  EXPECT_GT(changes, 500u) << "the torques are worth comparing";
  const std::vector<double> first = run(toy::Kind::kExecutiveOnTwin);
  ASSERT_EQ(rows.size(), first.size());
  EXPECT_EQ(std::memcmp(rows.data(), first.data(), rows.size() * sizeof(double)), 0) << "as in the executive";
}

}  // namespace
}  // namespace chimera::toy::c_twins_test
