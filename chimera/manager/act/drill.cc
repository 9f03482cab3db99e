// SPDX-License-Identifier: Apache-2.0
// Raises the flag for a drill, reads what the hardware tasks publish, lowers it again.
#include "chimera/manager/act/drill.h"

#include <algorithm>
#include <cstdio>

#include "chimera/base/assert.h"
#include "chimera/base/hosted/wording.h"

namespace chimera::manager {
namespace {

constexpr Nanoseconds kDrillLooksEvery = milliseconds(1);

std::string in_ms(Nanoseconds time) { return formatted("%.1f ms", static_cast<double>(time.count) / 1e6); }

}  // namespace

const char* verdict_word(DrillVerdict verdict) noexcept {
  constexpr const char* kWords[] = {"waiting", "safe", "left", "cannot-tell"};
  return kWords[static_cast<unsigned>(verdict)];
}

bool DrillOutcome::is_safe() const noexcept {
  if (killed.rtpu.is_valid() && (killed.good == 0 || killed.bad > 0)) return false;
  return !tasks.empty() &&
         std::ranges::all_of(tasks, [](const DrillPart& part) { return part.verdict == DrillVerdict::kSafe; });
}

std::vector<DrillPart> hardware_of(const ApplicationSpec& spec, const Library& library) {
  std::vector<DrillPart> found;
  for (std::size_t t = 0; t < spec.tasks.size(); ++t) {
    const LibraryEntry* entry = library.find(spec.tasks[t].component);
    if (entry == nullptr) continue;
    DrillPart part{.task = TaskId(t), .verdict = DrillVerdict::kCannotTell};
    bool may_move = false;
    std::uint32_t outputs = 0;
    for (const PortSpec& port : spec.tasks[t].ports) {
      const bool says_so = port.declared < entry->descriptor.ports.size() &&
                           entry->descriptor.ports[port.declared].safe_state;
      if (port.kind == CHIMERA_RESOURCE && !says_so) may_move = true;
      if (port.kind != CHIMERA_OUT_VAR) continue;
      if (says_so) part = {.task = TaskId(t), .output = outputs};
      ++outputs;
    }
    if (may_move || part.verdict == DrillVerdict::kWaiting) found.push_back(part);
  }
  return found;
}

Drill::Drill(ManagerState& state, std::function<void(RtpuId)> end_rtpu)
    : state_(state), end_rtpu_(std::move(end_rtpu)) {
  if (state.configuration) hardware_ = hardware_of(state.spec(), state.bundle.library);
}

void Drill::begin(Nanoseconds wait, RtpuId to_kill, Nanoseconds now, Drilled drilled) {
  CHIMERA_ASSERT(!is_under_way());
  Present present{{}, now, now + wait, wait, std::move(drilled), to_kill, state_.acting};
  for (const DrillPart& part : hardware_) {
    if (state_.state(part.task) != State::kOn) continue;
    present.outcome.tasks.push_back(part);
    const RtpuId rtpu = state_.spec().tasks[part.task.index].rtpu;
    present.outcome.tasks.back().incarnation = state_.rtpus[rtpu.index].incarnation;
  }
  present_ = std::move(present);
  due_ = now;
  show_flag(true);
  state_.tell("drill", TaskId{}, RtpuId{}, "the drill raised the flag", now);
  look(now);
}

void Drill::show_flag(bool up) {
  auto& flag = state_.own.block().head().flag;
  const std::uint32_t before = flag.load(std::memory_order_relaxed);
  flag.store(up ? before | kDrillFlag : before & ~kDrillFlag, std::memory_order_release);  // BlockHead
  state_.announce();
}

// Judges a task only by publications after the flag went up; earlier ones prove nothing.
void Drill::judge(DrillPart& part) const {
  if (part.verdict != DrillVerdict::kWaiting) return;
  const TaskStatus status = state_.peers.status(part.task);
  const RtpuId rtpu = state_.spec().tasks[part.task.index].rtpu;
  const RtpuRecord& record = state_.rtpus[rtpu.index];
  if (status.state != State::kOn || !record.is_alive || record.incarnation != part.incarnation) {
    part.verdict = DrillVerdict::kLeft;
    return;
  }
  const PeerLayout& layout = state_.peers.layout(rtpu);
  const GroupId group = layout.outputs(part.task, status.incarnation);
  const VariablePlace& place = layout.variables(group)[part.output];
  std::byte value{};
  chimera_slot slot{};
  if (!state_.peers[rtpu].group(group).try_read_part(slot, place.offset, {&value, 1})) return;
  if (slot.published_ns <= present_->raised.count || value == std::byte{0}) return;
  part.verdict = DrillVerdict::kSafe;
  part.after = {slot.published_ns - present_->raised.count};
}

// Waits for the tasks first, then for the guard. True if the drill must go on. An rtpu that has died already is not
// killed again.
bool Drill::goes_on(Nanoseconds now) {
  DrillOutcome& outcome = present_->outcome;
  const bool is_over = now >= present_->until;
  if (outcome.killed.rtpu.is_valid()) return !outcome.killed.is_told && !is_over;
  for (DrillPart& part : outcome.tasks) judge(part);
  const bool waits = std::ranges::any_of(
      outcome.tasks, [](const DrillPart& part) { return part.verdict == DrillVerdict::kWaiting; });
  if (waits && !is_over) return true;
  if (!present_->to_kill.is_valid()) return false;
  outcome.killed.rtpu = present_->to_kill;
  present_->until = now + present_->wait;
  present_->killed_at = manager::now();
  end_rtpu_(present_->to_kill);
  return true;
}

void Drill::take(const KeeperMessage& written) {
  if (!present_ || !present_->outcome.killed.rtpu.is_valid()) return;
  DrillKill& killed = present_->outcome.killed;
  if (written.kind != KeeperMessage::Kind::kFramesWritten || written.index != killed.rtpu.index) return;
  killed.is_told = true;
  killed.good = static_cast<std::uint32_t>(written.code);
  killed.bad = written.letter + written.late;
  if (killed.good > 0) killed.after = written.at - present_->killed_at;
  due_ = {};
}

void Drill::look(Nanoseconds now) {
  if (!present_ || now < due_) return;
  due_ = now + kDrillLooksEvery;
  DrillOutcome& outcome = present_->outcome;
  if (!state_.is_ending() && goes_on(now)) return;
  outcome.flag_for = now - present_->raised;
  for (const DrillPart& part : outcome.tasks)  // a report may be newer than `now`, the start of this round
    if (part.verdict == DrillVerdict::kSafe) outcome.flag_for = std::max(outcome.flag_for, part.after);
  show_flag(false);
  const Present over = std::move(*present_);
  present_.reset();
  const Acting acting(state_, over.by);
  tell(over.outcome, now);
  over.drilled(over.outcome);
}

void Drill::tell(const DrillOutcome& outcome, Nanoseconds now) {
  for (const DrillPart& part : outcome.tasks) {
    std::string text = verdict_word(part.verdict);
    if (part.verdict == DrillVerdict::kSafe) text += " " + in_ms(part.after) + " after the flag";
    state_.tell("drill", part.task, RtpuId{}, text, now);
  }
  if (outcome.killed.rtpu.is_valid())
    state_.tell("drill", TaskId{}, outcome.killed.rtpu,
                "killed for the drill; safe frames written: " + std::to_string(outcome.killed.good) +
                    ", lost: " + std::to_string(outcome.killed.bad),
                now);
  state_.tell("drill", TaskId{}, RtpuId{}, "the drill lowered the flag after " + in_ms(outcome.flag_for), now);
}

}  // namespace chimera::manager
