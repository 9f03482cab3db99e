// SPDX-License-Identifier: Apache-2.0
// Reads the takeovers that rtpus publish, and makes receipts of them.
#include "chimera/manager/switch/takeover_receipts.h"

#include <algorithm>

#include "chimera/control/receipt/receipt_json.h"
#include "chimera/control/receipt/receipt_text.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

// Number of the last handled takeover of that incarnation; 0: none.
std::uint32_t dealt_with(std::uint64_t word, std::uint32_t incarnation) {
  return word >> 32 == incarnation ? static_cast<std::uint32_t>(word) : 0;
}

bool is_in_range(const VariablePart& part, const Takeover& takeover, const ApplicationSpec& spec) {
  return part.handover.variable.index < spec.variables.size() && part.handover.from.task == takeover.from &&
         part.handover.to.task == takeover.standby.task;
}

}  // namespace

TakeoverReceipts::TakeoverReceipts(ManagerState& state, ReceiptArchive& archive)
    : state_(state), archive_(archive), journal_(state.own.block().journal()) {
  for (const LineJournal::Line& one : journal_.unfiled()) {
    const Json receipt = Json::parse_or_none(one.text).value_or(nullptr);
    if (text_at(receipt, "way") != "takeover") continue;
    left_.push_back({whole_at(receipt, "asked_ns"), text_at(receipt["asked_by"], "task")});
  }
}

void TakeoverReceipts::look(Nanoseconds now) {
  if (state_.spec().standbys.empty()) return;
  for (std::uint32_t r = 0; r < state_.peers.n_rtpus(); ++r)
    if (state_.peers[RtpuId(r)].is_there()) look(RtpuId(r), now);
}

// A dead rtpu publishes nothing more: a takeover that it had begun is filed as it is.
void TakeoverReceipts::look(RtpuId rtpu, Nanoseconds now) {
  const BlockView block = state_.peers[rtpu].block();
  const std::uint32_t incarnation = block.head().incarnation;
  const RtpuRecord& record = state_.rtpus[rtpu.index];
  const bool is_alive = record.is_alive && record.incarnation == incarnation;
  std::atomic<std::uint64_t>& word = state_.own.block().memory().takeovers[rtpu.index];  // only this process writes it
  std::uint32_t number = dealt_with(word.load(std::memory_order_relaxed), incarnation) + 1;
  if (const std::uint32_t oldest = block.takeovers().oldest(); number < oldest) {
    state_.tell("note", TaskId{}, rtpu, "takeovers without a receipt: " + std::to_string(oldest - number), now);
    number = oldest;
  }
  for (Takeover takeover; block.takeovers().read(number, is_alive, takeover); ++number) {
    if (is_possible(takeover, rtpu, now)) file(takeover, now);
    word.store(std::uint64_t{incarnation} << 32 | number, std::memory_order_relaxed);
  }
}

// Checks a takeover: a dead rtpu may have left any value.
bool TakeoverReceipts::is_possible(const Takeover& takeover, RtpuId rtpu, Nanoseconds now) const {
  const ApplicationSpec& spec = state_.spec();
  const TaskId task = takeover.standby.task;
  const auto in_range = [&](const VariablePart& part) { return is_in_range(part, takeover, spec); };
  return (takeover.set < spec.sets.size() || takeover.set == kNoSet) && takeover.from.index < spec.tasks.size() &&
         task.index < spec.tasks.size() && spec.tasks[task.index].rtpu == rtpu && spec.stand_in(task, takeover.from) &&
         (takeover.end == SwitchEnd::kDone || takeover.end == SwitchEnd::kAborted) && takeover.lost <= now &&
         takeover.lost >= Nanoseconds{} &&
         std::ranges::all_of(takeover.kept(), in_range);
}

void TakeoverReceipts::file(const Takeover& takeover, Nanoseconds now) {
  const ApplicationSpec& spec = state_.spec();
  const Key key{(takeover.lost - state_.keeper.origin).count, state_.name(takeover.standby.task)};
  if (std::ranges::find(left_, key) != left_.end()) return;
  TaskPart tasks[2];
  VariablePart variables[Takeover::kVariablesKept];
  SwitchReceipt receipt;
  receipt.tasks = tasks;
  receipt.variables = variables;
  write_receipt(takeover, receipt);
  if (receipt.ended == kNever) receipt.ended = std::max(takeover.lost, takeover.at == kNever ? now : takeover.at);
  receipt.number = journal_.next();
  const std::string text = control::receipt_text(receipt, spec, state_.zero());
  state_.tell("switch", TaskId{}, RtpuId{}, text.substr(0, text.find('\n')), now);
  for (const std::string& line : control::bump_lines(receipt, spec))
    state_.tell("bump", TaskId{}, RtpuId{}, line, now);
  archive_.add(receipt.number,
               control::receipt_json(receipt, spec, state_.keeper.origin, {"", wall_ns(receipt.asked)}), now, [] {});
}

}  // namespace chimera::manager
