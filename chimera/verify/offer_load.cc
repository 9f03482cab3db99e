// SPDX-License-Identifier: Apache-2.0
// Computes loads of CPUs from the outline, and makes edits that lower them.
#include "chimera/verify/offer_load.h"

#include <algorithm>
#include <cstdlib>

#include "chimera/base/hosted/wording.h"
#include "chimera/schedule/utilisation.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

struct Load {
  const OutlineTask* task = nullptr;
  const DraftServer* server = nullptr;
  double share = 0;  // of the CPU
  int times = 1;     // by which its rate is lowered
};

std::uint32_t cpu_of(const OutlineTask& task, const Outline& outline) {
  return std::ranges::find(outline.rtpus, task.rtpu, [](const DraftRtpu& rtpu) { return rtpu.name.text; })->cpu.value;
}

Load load_of(const OutlineTask& task, const Draft& draft) {
  const auto written = std::ranges::find(draft.tasks, task.name, [](const DraftTask& one) { return one.name.text; });
  const DraftServer* server = written != draft.tasks.end() && written->server ? &*written->server : nullptr;
  const Nanoseconds time = server != nullptr ? server->capacity.value : task.budget;
  const Nanoseconds period = server != nullptr ? server->period.value : task.period;
  return {&task, server, period.count == 0 ? 0 : static_cast<double>(time.count) / static_cast<double>(period.count)};
}

/// The tasks of the fault that are on the CPU of `heaviest`. A standby replaces its primary.
std::vector<Load> loads(const Fault& fault, const OutlineTask& heaviest, const Draft& draft, const Outline& outline) {
  std::vector<Load> all;
  const auto set = std::ranges::find(outline.configurations, fault.set, &OutlineSet::name);
  for (const OutlineTask& task : outline.tasks) {
    const bool is_in = set != outline.configurations.end() && std::ranges::count(set->tasks, task.name) > 0;
    const bool runs = &task == &heaviest || (is_in && task.name != heaviest.standby_for);
    if (runs && cpu_of(task, outline) == cpu_of(heaviest, outline)) all.push_back(load_of(task, draft));
  }
  return all;
}

SetValue lowered(const Load& load) {
  if (load.server != nullptr)
    return {{"tasks", load.task->name, "server", "period"},
            say(Nanoseconds{load.server->period.value.count * load.times})};
  return {{"tasks", load.task->name, "rate"}, formatted("%.10g Hz", load.task->rate_hz / load.times)};
}

}  // namespace

std::vector<Offer> lighter(const Fault& fault, const Draft& draft, const Outline& outline) {
  const auto heaviest = std::ranges::find(outline.tasks, fault.task, &OutlineTask::name);
  std::vector<Load> all = loads(fault, *heaviest, draft, outline);
  double sum = std::strtod(fault.found.c_str(), nullptr);
  do {
    Load& most = *std::ranges::max_element(all, {}, &Load::share);
    if (most.share == 0 || most.times > 1 << 20) return {};
    most.share /= 2;
    most.times *= 2;
    sum -= most.share;
  } while (sum > kMaxUtilisation);
  Offer offer;
  for (const Load& load : all) {
    if (load.times == 1) continue;
    offer.acts.push_back(lowered(load));
    append_joined(offer.label, ", ",
                  (load.server != nullptr ? "server period of '" : "rate of '") + load.task->name +
                      "': " + std::get<SetValue>(offer.acts.back()).value);
  }
  return {offer};
}

std::vector<Offer> moves(const OutlineTask& task, const Outline& outline) {
  std::vector<Offer> offers;
  for (const DraftRtpu& rtpu : outline.rtpus)
    if (rtpu.name.text != task.rtpu)
      offers.push_back({"move '" + task.name + "' to rtpu '" + rtpu.name.text + "'",
                        {SetValue{{"tasks", task.name, "rtpu"}, rtpu.name.text}}});
  return offers;
}

}  // namespace chimera
