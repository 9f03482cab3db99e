// SPDX-License-Identifier: Apache-2.0
// Makes results and errors of what the step function answers to a signal.
#include "chimera/manager/signal_answer.h"

#include <nlohmann/json.hpp>

#include "chimera/manager/cause.h"

namespace chimera::manager {

using control::Json;
using control::RpcResponse;
using subsystem::RefusalKind;

namespace {

/// The slow method that the unit is known to hang in, and what a person can do; "": nothing is known. Of a cycle the
/// data of the error tell.
std::string under_way(const ManagerState& world, RtpuId rtpu) {
  const RtpuRecord& record = world.rtpus[rtpu.index];
  const PeerSegment& segment = world.peers[rtpu];
  const bool serves = segment.is_there() && segment.block().head().serving.load(std::memory_order_relaxed) != 0;
  if (!serves || !record.is_alive || record.hang.empty()) return "";
  return ": " + record.hang + "; it goes on: `chimera status` shows when it has ended, `kill -KILL " +
         std::to_string(record.pid) + "` ends the process of " + world.name(rtpu) +
         ", and the tasks that were ON come back";
}

}  // namespace

RpcResponse signal_answer(const ManagerState& world, const subsystem::CommandAnswer& answer) {
  if (answer.is_accepted()) {
    Json tasks = Json::array();
    for (const subsystem::TaskOutcome& outcome : answer.outcomes) {
      tasks.push_back({{"task", world.name(outcome.task)},
                       {"before", state_name(outcome.before)},
                       {"after", state_name(outcome.after)}});
      if (outcome.is_already) tasks.back()["already"] = true;
    }
    return RpcResponse::good({{"tasks", std::move(tasks)}});
  }
  const auto& [kind, reason, remedy] = answer.refusal;
  if (kind == RefusalKind::kNoAnswer && answer.at.is_valid())
    return no_answer(world, world.spec().tasks[answer.at.index].rtpu, answer.refusal.text());
  return RpcResponse::refused(subsystem::refusal_kind_name(kind), answer.refusal.text(),
                              answer.at.is_valid() ? world.name(answer.at) : "", remedy);
}

RpcResponse no_answer(const ManagerState& world, RtpuId rtpu, const std::string& text) {
  const PeerSegment& segment = world.peers[rtpu];
  const std::string running = segment.is_there() ? running_text(world.spec(), segment.block().head().running) : "";
  const std::string why = under_way(world, rtpu);
  return RpcResponse::error(control::kNoAnswer, text + why,
                       {{"rtpu", world.name(rtpu)}, {"running", running.empty() ? Json() : Json(running)}});
}

}  // namespace chimera::manager
