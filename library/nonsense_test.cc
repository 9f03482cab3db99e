// SPDX-License-Identifier: Apache-2.0
// Gives every component invalid constants (also those that the checker refuses, because another component may provide
// them), inputs, resources and old outputs. The component refuses with a text or continues, without a report of the
// sanitizers. If all numbers have a finite square, its outputs are numbers. A failure prints the seed.
// CHIMERA_NONSENSE=COUNT sets the number of trials.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <cstring>
#include <map>
#include <random>

#include "chimera/task/rig.h"
#include "library/testing/sound_inputs.h"

namespace chimera {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kHostile[] = {NAN,    kUnbounded, -kUnbounded, 0,   -0.0, -1,  1e308,
                               -1e308, 5e-324,     1e-300,      1e6, -1e6, 1e18};

class Nonsense {
 public:
  Nonsense(const chimera_component& component, unsigned seed) : component_(component), random_(seed) {}

  /// Returns the first error, or "".
  std::string run() {
    Rig rig(component_.name);
    if (component_.name == std::string_view("csv_player")) rig.joined("out", "signal", "1", 0);
    shape(rig);
    const bool is_hostile = draw(4) != 0;
    for (std::uint32_t i = 0; i < component_.n_ports; ++i)
      give(rig, component_.ports[i], is_hostile && draw(4) == 0);
    if (!answered(rig.init(), "init")) return wrong_;
    if (is_faulty_) return end(rig);
    if (draw(3) == 0) inherit(rig);
    answered(rig.on(), "on");
    for (int cycle = 0; cycle < 20 && wrong_.empty(); ++cycle) {
      for (std::uint32_t i = 0; i < component_.n_ports; ++i)
        if (component_.ports[i].kind == CHIMERA_IN_VAR) give(rig, component_.ports[i], draw(6) == 0);
      step(rig);
    }
    return end(rig);
  }

 private:
  void step(Rig& rig) {
    if (component_.methods[CHIMERA_SYNC] != nullptr) answered(rig.sync(), "sync");
    rig.illegal(draw(8) == 0);
    const RigAnswer answer = rig.cycle(draw(10) == 0 ? milliseconds(50) : milliseconds(1));
    answered(answer, "cycle");
    if (answer && !is_extreme_) judge_outputs(rig);
    if (is_faulty_) answered(rig.error(), "error"), answered(rig.clear(), "clear");
    is_faulty_ = false;
  }
  std::string end(Rig& rig) {
    answered(rig.off(), "off");
    answered(rig.background(), "background");
    answered(rig.kill(), "kill");
    return wrong_;
  }
  bool answered(const RigAnswer& answer, const char* method) {
    is_faulty_ = answer.status == CHIMERA_FAULT;
    const bool is_told = !is_faulty_ || !answer.text.empty() || std::string_view("error clear").find(method) == 0;
    if (!is_told) wrong_ = std::string(method) + " failed without a text";
    return wrong_.empty();
  }
  void judge_outputs(Rig& rig) {
    for (std::uint32_t i = 0; i < component_.n_ports; ++i) {
      const chimera_port_decl& port = component_.ports[i];
      if (port.kind != CHIMERA_OUT_VAR || port.type != CHIMERA_FLOAT64 || !wrong_.empty()) continue;
      for (std::uint32_t e = 0; e < rig.size(port.name); ++e) {
        if (std::isfinite(rig.get<double>(port.name, e))) continue;
        wrong_ = std::string(port.name) + "[" + std::to_string(e) + "] is " +
                 std::to_string(rig.get<double>(port.name, e)) + " after " + told_;
        return;
      }
    }
  }

  std::uint32_t draw(std::size_t below) { return static_cast<std::uint32_t>(random_() % below); }
  void shape(Rig& rig) {
    const std::uint32_t rows = 1 + draw(3), columns = 1 + draw(2);
    rig.shape("n", rows, columns);
    for (std::uint32_t i = 0; i < component_.n_ports; ++i) {
      const chimera_port_decl& port = component_.ports[i];
      const bool is_repeated = (port.flags & CHIMERA_PORT_REPEATED) != 0;
      if (is_repeated) rig.instances(port.name, std::min<std::uint32_t>(port.max_instances, draw(4)));
      instances_[port.name] = is_repeated ? std::min<std::uint32_t>(port.max_instances, 3) : 1;
    }
  }
  void give(Rig& rig, const chimera_port_decl& port, bool is_hostile) {
    if (port.kind == CHIMERA_RESOURCE) return rig.resource(port.name, resource(port, is_hostile).c_str());
    if (port.kind != CHIMERA_IN_VAR && port.kind != CHIMERA_IN_CONST) return;
    const bool has_default = (port.flags & CHIMERA_PORT_HAS_INITIAL) != 0;
    if (!is_hostile && has_default) return;
    if (std::string_view(port.name) == "ndof") is_hostile = false;  // an extent: the framework keeps it in its range
    for (std::uint32_t instance = 0; instance < instances_[port.name]; ++instance)
      for (std::uint32_t e = 0; e < rig.size(port.name); ++e)
        put(rig, port, e, instance, is_hostile && (e == 0 || draw(2) == 0));
    if (is_hostile) told_ += std::string(port.name) + " ";
  }
  void inherit(Rig& rig) {
    for (std::uint32_t i = 0; i < component_.n_ports; ++i) {
      const chimera_port_decl& port = component_.ports[i];
      if (port.kind != CHIMERA_OUT_VAR) continue;
      const bool is_hostile = draw(3) == 0;
      for (std::uint32_t instance = 0; instance < instances_[port.name]; ++instance)
        for (std::uint32_t e = 0; e < rig.size(port.name); ++e) put(rig, port, e, instance, is_hostile && draw(2) == 0);
      rig.inherit(port.name, draw(2) == 0 ? milliseconds(2) : milliseconds(2000));
      if (is_hostile) told_ += std::string(port.name) + " ";
    }
  }
  void put(Rig& rig, const chimera_port_decl& port, std::uint32_t e, std::uint32_t instance, bool is_hostile) {
    const double value = is_hostile ? kHostile[draw(std::size(kHostile))] : library::sound_number(port);
    if (is_hostile) note(value);
    if (port.type == CHIMERA_STRING) return text(rig, port, e, instance, is_hostile);
    if (port.type == CHIMERA_STRUCT) return structure(rig, port, e, instance, is_hostile);
    library::put_number(rig, port, e, instance, value);
  }
  void note(double value) {
    is_extreme_ = is_extreme_ || !(std::abs(value) < 1e100);
    char text[32];
    std::snprintf(text, sizeof text, "%g ", value);
    told_ += text;
  }
  void text(Rig& rig, const chimera_port_decl& port, std::uint32_t e, std::uint32_t instance, bool is_hostile) {
    std::array<char, 256> bytes{};
    if (is_hostile) bytes.fill(draw(2) == 0 ? 'x' : '%');
    bytes[port.element_size - 1] = '\0';
    library::put_bytes(rig, port, e, instance, bytes.data());
  }
  void structure(Rig& rig, const chimera_port_decl& port, std::uint32_t e, std::uint32_t instance, bool is_hostile) {
    std::array<double, 64> numbers = library::sound_struct(port);
    if (is_hostile) note(numbers[draw(port.element_size / 8)] = kHostile[draw(std::size(kHostile))]);
    library::put_bytes(rig, port, e, instance, reinterpret_cast<const char*>(numbers.data()));
  }
  std::string resource(const chimera_port_decl& port, bool is_hostile) {
    if (!is_hostile) return library::sound_resource(component_.name, port.name);
    const char* kBad[] = {"", "/", "/dev/null", "no/such/thing", ":", "0:nan", "tcp:127.0.0.1:99999", "%s%n",
                          "0:1e400 1:x"};
    told_ += "resource ";
    return draw(8) == 0 ? std::string(255, 'x') : kBad[draw(std::size(kBad))];
  }

  const chimera_component& component_;
  std::mt19937 random_;
  std::map<std::string, std::uint32_t> instances_;
  std::string wrong_, told_;
  bool is_faulty_ = false;
  bool is_extreme_ = false;  // an input was NaN, infinite or too large to be squared
};

TEST(AnyComponent, RefusesNonsenseWithATextOrGoesOnAndPublishesNumbers) {
  const char* asked = std::getenv("CHIMERA_NONSENSE");
  const unsigned trials = asked != nullptr ? static_cast<unsigned>(std::atoi(asked)) : 15;
  const std::filesystem::path before = std::filesystem::current_path();
  const std::filesystem::path folder = testing::TempDir() + "nonsense_" + std::to_string(::getpid());
  std::filesystem::create_directory(folder);
  std::filesystem::current_path(folder);  // because a log writes to any file name
  std::uint32_t count = 0;
  const chimera_component* const* all = chimera_components(CHIMERA_ABI_VERSION, &count);
  ASSERT_GT(count, 50u);
  for (std::uint32_t c = 0; c < count; ++c) {
    if (std::string_view(all[c]->name) == "faulty") continue;  // because it publishes NaN on purpose
    for (unsigned trial = 0; trial < trials; ++trial) {
      const std::string wrong = Nonsense(*all[c], trial).run();
      EXPECT_EQ(wrong, "") << all[c]->name << ", seed " << trial;
      if (!wrong.empty()) break;
    }
  }
  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace chimera
