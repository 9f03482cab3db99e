// SPDX-License-Identifier: Apache-2.0
// Gives each input of each component three bad samples, or no sample for a while. No bad sample spoils a component for
// ever, and the data sheet says what the component does.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <set>

#include "chimera/base/testing/tree_path.h"
#include "chimera/task/rig.h"
#include "library/sequence/step.h"
#include "library/testing/sound_inputs.h"

namespace chimera::bad_samples_test {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::string sheet_of(const std::string& component) {
  std::ifstream file(source_path("library/" + component + "/README.md"));
  std::string text(std::istreambuf_iterator<char>(file), {});
  std::ranges::replace(text, '\n', ' ');
  return text;
}

/// One component with valid constants and inputs, but for one input.
class Sample {
 public:
  Sample(const chimera_component& component, const chimera_port_decl& port)
      : component_(component), port_(port), rig_(component.name) {
    const bool plays = std::string_view(component.name) == "csv_player";  // a file of one column
    rig_.shape("n", plays ? 1 : 2, 1);
    if (plays) rig_.instances("out", 1), rig_.joined("out", "signal", "1");
    rig_.extent("points", 2);
    for (std::uint32_t i = 0; i < component.n_ports; ++i) give(component.ports[i]);
    if (std::string_view(component.name) == "joint_trajectory") rig_.set("duration", 0.5);
    if (std::string_view(component.name) == "logic") rig_.set("function", Text<16>("and"));
    if (std::string_view(component.name) == "lookup_table") rig_.set("at", 1.5, 1);
    if (std::string_view(component.name) == "comparator") rig_.set("hysteresis", 0.1), rig_.set("hysteresis", 0.1, 1);
    if (std::string_view(component.name) == "encoder") rig_.instances("in", 1);
    for (std::size_t i = 0; i < 16 && std::string_view(component.name) == "sequence"; ++i) {
      rig_.set("step", library::Step{"step", 1, 0, 0, 0, 0, -1, false, false}, i);
      rig_.set("configuration", Text<72>("all"), 0, i);
    }
  }
  /// "" if init succeeds.
  std::string begin() { return is_fault(rig_.init()) ? said_ : ""; }
  /// "" if the component bears bad samples of `value`.
  std::string bear(double value) {
    put(port_, library::sound_number(port_));
    if (is_fault(rig_.on())) return "on: " + said_;
    if (!run(30)) return "before: " + said_;
    put(port_, value);
    sample(3);
    put(port_, library::sound_number(port_));
    return recover("");
  }
  /// "" if the component bears that the input is written late.
  std::string bear_late() {
    const bool is_on = !is_fault(rig_.on());
    if (is_on) sample(5);
    put(port_, library::sound_number(port_));
    return recover(is_on ? "" : "on");
  }

 private:
  /// Good samples again. Without `error` the task is in ERROR until clear and on.
  std::string recover(std::string needs) {
    const std::string sheet = sheet_of(component_.name);
    if (has_faulted_ && !has_recovered_) {
      if (sheet.find("ERROR") == std::string::npos) return "ends in ERROR, and the sheet does not say so: " + said_;
      if (is_fault(rig_.clear())) return "clear: " + said_;
      needs = "on";
    } else if (has_faulted_ && sheet.find("input rule") == std::string::npos) {
      return "continues after a fault, and the sheet does not name the input rule: " + said_;
    }
    if (!needs.empty() && is_fault(rig_.on())) return "on again: " + said_;
    if (!run(300)) return "after: " + said_;
    return outputs();
  }
  void sample(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      if (!is_fault(rig_.cycle())) continue;
      has_faulted_ = true;
      has_recovered_ = component_.methods[CHIMERA_ERROR] != nullptr && static_cast<bool>(rig_.error());
      if (!has_recovered_) return;
    }
  }
  bool run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      const RigAnswer answer = rig_.cycle();
      if (answer.status == CHIMERA_ABORTED) said_ = "waits";
      if (is_fault(answer) || answer.status == CHIMERA_ABORTED) return false;
    }
    return true;
  }
  bool is_fault(const RigAnswer& answer) {
    if (answer.status == CHIMERA_FAULT) said_ = answer.text;
    return answer.status == CHIMERA_FAULT;
  }
  std::string outputs() {
    for (std::uint32_t i = 0; i < component_.n_ports; ++i) {
      const chimera_port_decl& port = component_.ports[i];
      if (port.kind != CHIMERA_OUT_VAR || port.type != CHIMERA_FLOAT64) continue;
      for (std::uint32_t e = 0; e < rig_.size(port.name); ++e)
        if (!std::isfinite(rig_.get<double>(port.name, e))) return std::string(port.name) + " stays not finite";
    }
    return {};
  }
  void give(const chimera_port_decl& port) {
    if (port.kind == CHIMERA_RESOURCE)
      return rig_.resource(port.name, library::sound_resource(component_.name, port.name).c_str());
    const bool is_constant = port.kind == CHIMERA_IN_CONST && (port.flags & CHIMERA_PORT_HAS_INITIAL) == 0;
    if (is_constant || (port.kind == CHIMERA_IN_VAR && &port != &port_)) put(port, library::sound_number(port));
  }
  void put(const chimera_port_decl& port, double value) {
    if (port.type == CHIMERA_STRING) return;
    const std::uint32_t instances = (port.flags & CHIMERA_PORT_REPEATED) != 0 ? port.max_instances : 1;
    for (std::uint32_t instance = 0; instance < instances; ++instance)
      for (std::uint32_t e = 0; e < rig_.size(port.name); ++e) {
        if (port.type != CHIMERA_STRUCT) {
          library::put_number(rig_, port, e, instance, value);
          continue;
        }
        std::array<double, 64> numbers = library::sound_struct(port);
        if (value != library::sound_number(port)) numbers[0] = value;
        library::put_bytes(rig_, port, e, instance, reinterpret_cast<const char*>(numbers.data()));
      }
  }

  const chimera_component& component_;
  const chimera_port_decl& port_;
  Rig rig_;
  std::string said_;
  bool has_faulted_ = false, has_recovered_ = false;
};

// Without a device, faulty on purpose, or with a text that must be given.
const std::set<std::string> kNotTried{"modbus_io", "serial_frame", "udp_frame", "faulty", "display_manager",
                                       "terminal"};

TEST(AnyComponent, NoBadSampleSpoilsItForEver) {
  const std::filesystem::path before = std::filesystem::current_path();
  const std::filesystem::path folder = testing::TempDir() + "bad_samples_" + std::to_string(::getpid());
  std::filesystem::create_directories(folder);
  std::filesystem::current_path(folder);
  std::uint32_t count = 0, inputs = 0;
  const chimera_component* const* all = chimera_components(CHIMERA_ABI_VERSION, &count);
  for (std::uint32_t c = 0; c < count; ++c) {
    const chimera_component& component = *all[c];
    if (kNotTried.contains(component.name)) continue;
    for (std::uint32_t p = 0; p < component.n_ports; ++p) {
      const chimera_port_decl& port = component.ports[p];
      if (port.kind != CHIMERA_IN_VAR) continue;
      ++inputs;
      for (const double value : {std::nan(""), kInfinite, -kInfinite, 1e300}) {
        Sample sample(component, port);
        const std::string refusal = sample.begin();
        EXPECT_EQ(refusal, "") << component.name;
        if (!refusal.empty()) break;
        EXPECT_EQ(sample.bear(value), "") << component.name << ", " << port.name << " = " << value;
      }
      Sample late(component, port);
      if (late.begin().empty()) {
        EXPECT_EQ(late.bear_late(), "") << component.name << ", " << port.name << " is written late";
      }
    }
  }
  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
  EXPECT_GT(inputs, 90u);
}

}  // namespace
}  // namespace chimera::bad_samples_test
