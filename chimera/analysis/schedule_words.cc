// SPDX-License-Identifier: Apache-2.0
// The advice of the schedule analysis, in words.
#include "chimera/analysis/schedule_words.h"

#include "chimera/base/hosted/wording.h"
#include "chimera/description/criticality.h"

namespace chimera {

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

std::string scale_text(double scale) { return formatted("%.3g", scale) + " times as long as stated"; }

}  // namespace chimera
