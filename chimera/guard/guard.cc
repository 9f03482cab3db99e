// SPDX-License-Identifier: Apache-2.0
// Waits for deaths, and writes the safe frames that the dead rtpus left.
#include "chimera/guard/guard.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <utility>

#include "chimera/platform/descriptor.h"
#include "chimera/platform/process.h"
#include "chimera/runtime/hosted/pages.h"

namespace chimera {

using Kind = GuardMessage::Kind;

Guard::Guard(Channel keeper, const ApplicationImage& image)
    : keeper_(std::move(keeper)), spec_(image.spec()), writes_(static_cast<std::uint32_t>(image.spec().tasks.size())) {}

Result<std::unique_ptr<Guard>> Guard::create(Channel keeper, const ApplicationImage& image,
                                             std::span<const SilenceLimit> limits) {
  std::unique_ptr<Guard> guard(new Guard(std::move(keeper), image));
  if (const auto prepared = guard->prepare(limits); !prepared) return prepared.error();
  return guard;
}

Result<void> Guard::prepare(std::span<const SilenceLimit> limits) {
  for (std::uint32_t rtpu = 0; rtpu < spec_.rtpus.size(); ++rtpu) {
    auto layout = PeerLayout::of(spec_, rtpu, memory_);
    if (!layout) return layout.error();
    layouts_.push_back(*layout);
  }
  rtpus_ = std::vector<Rtpu>(spec_.rtpus.size());
  for (const SilenceLimit& limit : limits) {
    if (limit.task.index >= spec_.tasks.size() || limit.periods == 0)
      return Error{ErrorCode::kBadInput, {"a limit of silence for a task that there is not"}, {}};
    silences_.emplace_back(limit.task, spec_.tasks[limit.task.index].period, limit.periods);
  }
  for (const StandbySpec& each : spec_.standbys) {
    if (each.stale_after.count > 0)
      silences_.push_back(Silence::of(each, spec_.tasks[each.primary.index].period));
  }
  return {};
}

void Guard::say_ready(bool has_rights) noexcept { tell({.kind = Kind::kReady, .good = has_rights ? 1u : 0u}); }

// If the keeper is gone or its channel is full, the message is dropped: the guard must not wait.
void Guard::tell(GuardMessage message) noexcept {
  if (keeper_.is_open()) (void)keeper_.send(bytes_of(message));
}

void Guard::tell_unguarded(std::uint32_t index, std::uint32_t incarnation, int error) noexcept {
  const auto bad = static_cast<std::uint32_t>(error != 0 ? error : EPROTO);
  tell({.kind = Kind::kUnguarded, .index = index, .incarnation = incarnation, .bad = bad});
}

// A segment, and that of a successor that the keeper has started already.
std::uint64_t Guard::room() const noexcept {
  std::uint64_t bytes = 0;
  for (const PeerLayout& layout : layouts_)
    bytes += 2 * peer_segment_bytes(layout.table(), static_cast<std::uint32_t>(spec_.tasks.size()));
  return bytes;
}

bool Guard::is_needed() const noexcept {
  return keeper_.is_open() ||
         std::ranges::any_of(rtpus_, [](const Rtpu& rtpu) { return rtpu.life.process.fd >= 0 || rtpu.is_writing; });
}

bool Guard::step(Nanoseconds at_most) noexcept {
  wait(at_most);
  writes_.advance(clock_.now());
  for (std::uint32_t index = 0; index < rtpus_.size(); ++index) finish(index);
  if (!silences_.empty()) look_for_silence();
  return is_needed();
}

// Handles messages of the keeper before deaths: a successor that has taken over a device gets no frame of a dead rtpu.
void Guard::wait(Nanoseconds at_most) noexcept {
  std::array<Watched, 1 + 2 * kMaxRtpus> watched{};
  watched[0].descriptor = keeper_.descriptor();
  for (std::uint32_t index = 0; index < rtpus_.size(); ++index) {
    watched[1 + 2 * index].descriptor = rtpus_[index].life.process.fd;
    watched[2 + 2 * index].descriptor = rtpus_[index].life.line.descriptor();
  }
  Nanoseconds due = writes_.due();
  for (const Silence& silence : silences_) due = std::min(due, silence.due());
  const Nanoseconds until_due = due == kNever ? kNever : due - clock_.now();
  if (await_ready(watched, std::min(until_due, at_most)) <= 0) return;
  if (watched[0].is_ready) listen_to_keeper();
  for (std::uint32_t index = 0; index < rtpus_.size(); ++index) {
    Rtpu& rtpu = rtpus_[index];
    if (watched[2 + 2 * index].is_ready) listen_to(rtpu.life, index);
    if (watched[1 + 2 * index].is_ready || rtpu.next.process.fd >= 0) bury(index);
  }
}

void Guard::listen_to_keeper() noexcept {
  GuardMessage message;
  for (int passed = -1;;) {
    const Channel::Got got = keeper_.receive(bytes_of(message), passed);
    if (got == Channel::Got::kNothing) return;
    if (got == Channel::Got::kClosed) {
      keeper_ = Channel();
      return;
    }
    take(message, OwnedDescriptor(passed));
  }
}

// The keeper starts an rtpu only after the death of its predecessor, even if the guard has not seen that death yet.
void Guard::take(const GuardMessage& message, OwnedDescriptor passed) noexcept {
  if (message.index >= rtpus_.size()) return;
  if (passed.fd < 0) return tell_unguarded(message.index, message.incarnation, EMFILE);
  Rtpu& rtpu = rtpus_[message.index];
  if (message.kind == Kind::kRtpu) {
    if (rtpu.next.process.fd >= 0) bury(message.index);
    const bool is_next = rtpu.life.process.fd >= 0;
    if (!is_next) finish(message.index, true);  // from here on the devices are the successor's
    Life& life = is_next ? rtpu.next : rtpu.life;
    life.process = std::move(passed);
    life.incarnation = message.incarnation;
  } else if (message.kind == Kind::kLine) {
    for (Life* const life : {&rtpu.life, &rtpu.next})
      if (life->incarnation == message.incarnation) life->line = Channel(passed.release());
  }
}

// Reads the messages of an rtpu. They can be read after its death, too.
void Guard::listen_to(Life& life, std::uint32_t index) noexcept {
  while (listen_once(life, index)) continue;
}

// Reads the next message; false if there is none.
bool Guard::listen_once(Life& life, std::uint32_t index) noexcept {
  GuardMessage message;
  int passed = -1;
  const Channel::Got got = life.line.is_open() ? life.line.receive(bytes_of(message), passed) : Channel::Got::kNothing;
  OwnedDescriptor owned(passed);
  if (got == Channel::Got::kClosed) life.line = Channel();
  if (got != Channel::Got::kMessage) return false;
  if (message.kind == Kind::kSegment) {
    open_segment(life, index, owned.fd);
  } else if (message.kind == Kind::kFrame && message.task < spec_.tasks.size() &&
             spec_.tasks[message.task].rtpu.index == index) {
    if (owned.fd == kLostDescriptor) tell_unguarded(index, life.incarnation, EMFILE);
    writes_.keep(message.task, message.frame, std::move(owned), message.pause);
  }
  return true;
}

void Guard::open_segment(Life& life, std::uint32_t index, int descriptor) noexcept {
  const auto n_tasks = static_cast<std::uint32_t>(spec_.tasks.size());
  errno = 0;
  auto opened = PeerSegment::open(descriptor, layouts_[index], n_tasks, index, life.incarnation);
  if (!opened) return tell_unguarded(index, life.incarnation, errno);
  life.segment = *std::move(opened);
}

// The process is proved dead: its memory does not change any more. A successor shows its memory by its first message;
// later messages wait, because the devices are not the successor's yet.
void Guard::bury(std::uint32_t index) noexcept {
  Rtpu& rtpu = rtpus_[index];
  listen_to(rtpu.life, index);
  (void)listen_once(rtpu.next, index);
  const Life life = std::move(rtpu.life);
  const bool has_next = rtpu.next.process.fd >= 0;
  rtpu.life = std::exchange(rtpu.next, Life());
  rtpu.written_of = life.incarnation;
  rtpu.died = clock_.now();
  rtpu.is_writing = true;
  if (life.segment.is_there() && life.segment.incarnation() == life.incarnation)
    for (std::uint32_t task = 0; task < spec_.tasks.size(); ++task)
      if (spec_.tasks[task].rtpu.index == index)
        writes_.begin(TaskId(task), life.segment.block(), rtpu.life.segment.block(), rtpu.died);
  writes_.advance(clock_.now());
  finish(index, has_next);
}

void Guard::finish(std::uint32_t index, bool is_at_once) noexcept {
  Rtpu& rtpu = rtpus_[index];
  if (!rtpu.is_writing) return;
  WrittenFrames written;
  bool is_over = true;
  for (std::uint32_t task = 0; task < spec_.tasks.size(); ++task)
    if (spec_.tasks[task].rtpu.index == index) is_over &= !writes_.is_on_its_way(TaskId(task));
  if (!is_over && !is_at_once) return;
  for (std::uint32_t task = 0; task < spec_.tasks.size(); ++task)
    if (spec_.tasks[task].rtpu.index == index) writes_.finish(TaskId(task), written);
  rtpu.is_writing = false;
  tell({.kind = Kind::kWritten,
        .index = index,
        .incarnation = rtpu.written_of,
        .good = written.good,
        .bad = written.bad,
        .late = written.late,
        .died = rtpu.died,
        .at = written.at});
}

bool Guard::is_there(std::uint32_t index) const noexcept {
  return rtpus_[index].life.process.fd >= 0 && rtpus_[index].life.segment.is_there();
}

TaskStatus Guard::status(TaskId task) const noexcept {
  const std::uint32_t index = spec_.tasks[task.index].rtpu.index;
  return is_there(index) ? rtpus_[index].life.segment.block().status(task) : TaskStatus{};
}

// Ends the rtpu of a silent primary. SIGKILL alone proves nothing: frames are written, and a standby takes over, only
// when the death is proved. A primary whose standbys cannot take over is left alone.
void Guard::look_for_silence() noexcept {
  const Nanoseconds now = clock_.now();
  for (Silence& silence : silences_) {
    if (silence.due() > now) continue;
    const std::uint32_t index = spec_.tasks[silence.task().index].rtpu.index;
    const Life& rtpu = rtpus_[index].life;
    const TaskStatus shown = status(silence.task());
    chimera_slot slot{};
    if (is_there(index)) {
      const GroupReader group = rtpu.segment.group(layouts_[index].outputs(silence.task(), shown.incarnation));
      if (!group.try_read_part(slot, 0, {})) slot = {};
    }
    const bool has_successor = !silence.standby().is_valid() || status(silence.standby()).state == State::kOff;
    if (!silence.look(shown.state == State::kOn && has_successor, slot.sequence, now)) continue;
    (void)signal_process(rtpu.process.fd, SIGKILL);
    tell({.kind = Kind::kSilent,
          .index = index,
          .incarnation = rtpu.incarnation,
          .task = silence.task().index,
          .good = silence.standby().is_valid() ? 1u : 0u});
  }
}

}  // namespace chimera
