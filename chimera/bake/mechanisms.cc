// SPDX-License-Identifier: Apache-2.0
// Finds the parts of the runtime that an application needs.
#include "chimera/bake/mechanisms.h"

#include <algorithm>

namespace chimera::bake {

std::vector<Mechanism> mechanisms(const ApplicationSpec& spec, const baked::Run& run, const Target& target) {
  const auto any_task = [&](auto is) { return std::ranges::any_of(spec.tasks, is); };
  const bool switches =
      spec.sets.size() > 1 ||
      std::ranges::any_of(run.acts, [](const ScriptAct& act) { return act.kind == ScriptAct::Kind::kSwitch; });
  const bool has_constants =
      std::ranges::any_of(spec.constants, [](const ConstantSpec& constant) { return !constant.producers.empty(); });
  const bool is_safe = any_task([](const TaskSpec& task) {
    return std::ranges::any_of(task.ports, [](const PortSpec& port) { return port.safety; });
  });
  const bool reacts = any_task([](const TaskSpec& task) {
    return task.on_miss != OnMiss::kContinue || task.on_overrun != OnMiss::kContinue || task.max_consecutive != 0 ||
           task.tolerated_of != 0 || task.min_time > Nanoseconds{};
  });
  return {{"kPeers", false},
          {"kService", false},
          {"kPreemptive", false},
          {"kServers", false},
          {"kStandbys", false},
          {"kRestart", !spec.restarts.empty()},
          {"kTap", false},
          {"kBlame", false},
          {"kSwitch", switches && run.link_period.count == 0},  // else Linux switches
          {"kTransitions", false},
          {"kConstants", has_constants},
          {"kOperators", !spec.operators.empty()},
          {"kEvents", any_task([](const TaskSpec& task) { return task.aperiodic; })},
          {"kSafety", is_safe},
          {"kSignals", true},
          {"kReactions", reacts},
          {"kBudgets", any_task([](const TaskSpec& task) { return task.budget.count > 0; })},
          {"kDigest", run.duration != kNever},
          {"kSerial", target.uart.has_value()},
          {"kShell", target.has_shell() && run.link_period.count == 0},  // else Linux is the shell
          {"kLink", run.link_period.count > 0},
          {"kWatchdog", target.watchdog.count > 0},
          {"kInterrupts", !target.events.empty()},
          {"kStale", !spec.stale.empty()}};
}

std::string mechanisms_text(const std::vector<Mechanism>& mechanisms) {
  std::string text =
      "// Made by `chimera bake`: the parts of the runtime that this application needs.\n#pragma once\n\n"
      "namespace chimera::mechanisms {\n\n";
  for (const Mechanism& each : mechanisms)
    text += "inline constexpr bool " + std::string(each.name) + " = " + (each.is_used ? "true" : "false") + ";\n";
  text += "inline constexpr bool kVerified = true;\n";
  return text + "\n}  // namespace chimera::mechanisms\n";
}

}  // namespace chimera::bake
