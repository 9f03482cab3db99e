// SPDX-License-Identifier: Apache-2.0
// Compares the jobs of a producer and its reader as the policy of their rtpu does.
#include "chimera/analysis/link_age.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/criticality.h"
#include "chimera/text/time_text.h"
#include "chimera/verify/board_links.h"

namespace chimera {
namespace {

std::uint64_t place_of(const ApplicationSpec& spec, TaskId task) noexcept {
  return tie_of(spec.tasks[task.index].place, task.index);
}

/// The time that the policy compares of jobs released together.
Nanoseconds key_of(const TaskSpec& task, Policy policy) noexcept {
  if (policy == Policy::kRm) return task.period;
  const bool is_laxity = policy == Policy::kLlf || policy == Policy::kMufLaxity;
  return is_laxity ? task.deadline - task.budget : task.deadline;
}

/// True if jobs of `a` run before those of `b` that are released at the same instant.
bool runs_first(const ApplicationSpec& spec, TaskId a, TaskId b, Policy policy) noexcept {
  const auto urgency = [](const TaskSpec& t) {
    return Urgency{t.criticality, t.user_priority, t.period, t.deadline, t.budget};
  };
  const Urgency ua = urgency(spec.tasks[a.index]), ub = urgency(spec.tasks[b.index]);
  if (is_more_urgent(policy, ua, ub)) return true;
  return !is_more_urgent(policy, ub, ua) && place_of(spec, a) < place_of(spec, b);
}

}  // namespace

std::string late_text(const ApplicationSpec& spec, TaskId from, TaskId to) {
  const TaskSpec &a = spec.tasks[from.index], &b = spec.tasks[to.index];
  const RtpuSpec& rtpu = spec.rtpus[a.rtpu.index];
  const std::string reader = in_quotes(b.name), policy(policy_name(rtpu.policy));
  const auto helps = [](const std::string& change, const TaskSpec& of) {
    return "; remedy: " + change + " of " + in_quotes(of.name);
  };
  if (const Nanoseconds delay = link_delay(spec, from, to); delay.count > 0)
    return reader + " is at the other end of a link, which takes up to " + time_text(delay) +
           "; remedy: a higher 'rate' of the link";
  if (a.rtpu != b.rtpu) return reader + " runs on another rtpu" + helps("rtpu: " + std::string(rtpu.name), b);
  if (a.has_doorbell() || b.has_doorbell()) return "events release one of the two";
  const bool is_more_critical = has_criticalities(rtpu.policy) && a.criticality != b.criticality;
  const bool is_laxity = rtpu.policy == Policy::kLlf || rtpu.policy == Policy::kMufLaxity;
  if (is_laxity && rtpu.preemptive && !is_more_critical)
    return policy + " promises no order; remedy: policy: edf or muf of rtpu " + in_quotes(rtpu.name);
  const bool same_key = key_of(a, rtpu.policy) == key_of(b, rtpu.policy);
  if (!is_more_critical && same_key && a.period == b.period && a.offset != b.offset)
    return a.offset < b.offset ? "" : reader + " has the earlier offset" + helps("offset: " + time_text(a.offset), b);
  if (runs_first(spec, from, to, rtpu.policy)) return "";
  if (is_more_critical)
    return reader + " is more critical" + helps(std::string("criticality: ") + criticality_name(b.criticality), a);
  if (!same_key && rtpu.policy == Policy::kRm)
    return "rm runs the shorter period of " + reader + " first" + helps("the same rate", a);
  if (!same_key)
    return policy + " runs " + reader + " first, which " + (is_laxity ? "can wait less" : "is due sooner") +
           helps("deadline: " + time_text(key_of(b, rtpu.policy) + (a.deadline - key_of(a, rtpu.policy))), a);
  if (a.user_priority == b.user_priority) return "a loop is cut here";
  return reader + " has the higher priority" + helps("user_priority: " + std::to_string(b.user_priority), a);
}

std::vector<TaskLink> links_among(const ApplicationSpec& spec, std::span<const TaskId> tasks) {
  std::vector<TaskLink> links;
  const auto is_among = [&](const PortOf& port) { return std::ranges::count(tasks, port.task) > 0; };
  for (const Variable& variable : spec.variables)
    for (const PortOf& from : variable.producers)
      for (const PortOf& to : variable.consumers)
        if (from.task != to.task && is_among(from) && is_among(to))
          links.push_back({from.task, to.task, late_text(spec, from.task, to.task)});
  const auto places = [&](const TaskLink& link) {
    return std::pair(place_of(spec, link.from), place_of(spec, link.to));
  };
  std::ranges::sort(links, {}, places);
  const auto rest = std::ranges::unique(links, {}, places);
  links.erase(rest.begin(), rest.end());
  return links;
}

std::vector<TaskId> cycle_order(const ApplicationSpec& spec, std::vector<TaskId> tasks) {
  const auto policy = [&](TaskId task) { return spec.rtpus[spec.tasks[task.index].rtpu.index].policy; };
  std::ranges::sort(tasks, [&](TaskId a, TaskId b) { return runs_first(spec, a, b, policy(a)); });
  return tasks;
}

}  // namespace chimera
