// SPDX-License-Identifier: Apache-2.0
// The advice of the schedule analysis, in words and as edits.
#include "chimera/analysis/schedule_words.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/criticality.h"

namespace chimera {
namespace {

/// The value of an rtpu like `model` on that CPU.
std::string rtpu_value(const RtpuSpec& model, std::uint32_t cpu, bool is_preemptive) {
  return "{cpu: " + std::to_string(cpu) + ", policy: " + std::string(policy_name(model.policy)) +
         (is_preemptive ? ", executor: preemptive}" : "}");
}

/// Moves the task to a new rtpu on the first CPU without one.
std::vector<EditAct> new_rtpu_acts(const Configuration& configuration, std::size_t task) {
  const auto rtpus = configuration.rtpus();
  const RtpuSpec& model = rtpus[configuration.tasks()[task].rtpu];
  std::uint32_t cpu = 0;
  while (std::ranges::count(rtpus, cpu, &RtpuSpec::cpu) > 0) ++cpu;
  std::string name;
  for (int n = 2; name.empty() || std::ranges::count(rtpus, name, &RtpuSpec::name) > 0; ++n)
    name = std::string(model.name) + '_' + std::to_string(n);
  std::vector<EditAct> acts;
  if (configuration.draft().rtpus.empty())  // the first rtpu of a text is that of the tasks that name none
    acts.push_back(SetValue{{"rtpus", std::string(model.name)}, rtpu_value(model, model.cpu, model.preemptive)});
  acts.push_back(SetValue{{"rtpus", name}, rtpu_value(model, cpu, model.preemptive)});
  acts.push_back(SetValue{{"tasks", configuration.tasks()[task].name, "rtpu"}, name});
  return acts;
}

}  // namespace

std::string remedy_text(const Configuration& configuration, const Remedy& remedy) {
  const std::string task = "task '" + configuration.tasks()[remedy.task].name + "'";
  const std::string rtpu(configuration.rtpus()[remedy.rtpu].name);
  switch (remedy.kind) {
    case Remedy::Kind::kExecutor:
      return "rtpu '" + rtpu + "' with executor: preemptive";
    case Remedy::Kind::kRate:
      return task + " at rate: " + formatted("%g", remedy.hz) + " Hz";
    case Remedy::Kind::kProcessor:
      return task + " on rtpu: " + rtpu;
    case Remedy::Kind::kNewProcessor:
      return task + " on an rtpu of another CPU";
    case Remedy::Kind::kCriticality:
      break;
  }
  return task + " with criticality: " + criticality_name(remedy.criticality) +
         (remedy.is_for_others ? " (then all others are guaranteed)" : "");
}

std::vector<EditAct> remedy_acts(const Configuration& configuration, const Remedy& remedy) {
  const RtpuSpec& rtpu = configuration.rtpus()[remedy.rtpu];
  const auto set = [&](const char* key, std::string value) -> std::vector<EditAct> {
    return {SetValue{{"tasks", configuration.tasks()[remedy.task].name, key}, std::move(value)}};
  };
  switch (remedy.kind) {
    case Remedy::Kind::kExecutor:
      if (configuration.draft().rtpus.empty())
        return {SetValue{{"rtpus", std::string(rtpu.name)}, rtpu_value(rtpu, rtpu.cpu, true)}};
      return {SetValue{{"rtpus", std::string(rtpu.name), "executor"}, "preemptive"}};
    case Remedy::Kind::kRate:
      return set("rate", formatted("%g Hz", remedy.hz));
    case Remedy::Kind::kProcessor:
      return set("rtpu", std::string(rtpu.name));
    case Remedy::Kind::kNewProcessor:
      return new_rtpu_acts(configuration, remedy.task);
    case Remedy::Kind::kCriticality:
      break;
  }
  return set("criticality", criticality_name(remedy.criticality));
}

std::string scale_text(double scale) { return formatted("%.3g", scale) + " times as long as stated"; }

}  // namespace chimera
