// SPDX-License-Identifier: Apache-2.0
// Takes what arrived, turns tasks ON and OFF as Linux wants, and sends the groups of all tasks.
#include "firmware/link/host_link.h"

#include <algorithm>
#include <cstring>

#include "chimera/base/fixed.h"
#include "chimera/runtime/cycle/boundary_signals.h"

namespace chimera::firmware {
namespace {

constexpr std::int64_t kNsPerUs = 1000;

template <class T>
T read_as(const std::byte* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

template <class T>
void write_as(std::byte* at, const T& value) noexcept {
  std::memcpy(at, &value, sizeof value);
}

std::uint32_t age_us(Nanoseconds age) noexcept {
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(age.count / kNsPerUs, 0, UINT32_MAX));
}

}  // namespace

HostLink::HostLink(TaskSet& set, const Times& times, SetupMemory& memory)
    : BoundaryListener(no_bell_), set_(set), times_(times) {
  layout_.plan(set.spec(), RtpuId(0u), memory);
  payload_ = memory.take_bytes(layout_.most_from_board_bytes(), 8);
  out_ = memory.take_bytes(board_link::line_bytes(layout_.most_from_board_bytes()), 8);
  set_.flag().watch(flags_);
  set_due(Nanoseconds{});
}

int HostLink::next_byte() noexcept {
  const std::uint32_t at = out_sent_.load(std::memory_order_relaxed);
  if (at >= out_size_.load(std::memory_order_acquire)) return -1;
  const int byte = std::to_integer<int>(out_[at]);
  out_sent_.store(at + 1, std::memory_order_release);
  return byte;
}

void HostLink::take(BoundarySignals& signals, Nanoseconds now) noexcept {
  bool has_news = false;
  for (int byte; (byte = in_.take()) >= 0;)
    if (reader_.add(static_cast<std::byte>(byte))) has_news = accept(reader_.payload(), now) || has_news;
  if (has_news) follow_wanted(signals, now);
  if (!is_stale_ && now - heard_at_ > times_.stale_after) go_stale();
  if (now >= send_at_) send(now);
  set_due(now + times_.tick);
}

bool HostLink::accept(std::span<const std::byte> payload, Nanoseconds now) noexcept {
  const bool is_whole = payload.size() == layout_.to_board_bytes();
  const auto head = is_whole ? read_as<board_link::FrameHead>(payload.data()) : board_link::FrameHead{};
  if (!is_whole || head.kind != board_link::FrameKind::kToBoard || head.layout != layout_.hash()) {
    ++foreign_;
    return false;
  }
  if (!is_stale_ && head.sequence == last_sequence_) return false;  // the line repeated it
  last_sequence_ = head.sequence;
  ++received_;
  heard_at_ = now;
  is_stale_ = false;
  wanted_ = head.wanted;
  flag_word_.store(head.flags & board_link::kFlagIsUp, std::memory_order_relaxed);
  set_imports(payload.data(), now);
  return true;
}

void HostLink::set_imports(const std::byte* payload, Nanoseconds now) noexcept {
  const auto valid = read_as<std::uint64_t>(payload + board_link::LinkLayout::valid_at());
  for (std::size_t i = 0; i < layout_.imports().size(); ++i) {
    const board_link::Import& import = layout_.imports()[i];
    const auto age = read_as<std::uint32_t>(payload + board_link::LinkLayout::ages_at() + 4 * i);
    const std::uint32_t index = set_.spec().variables[import.variable.index].operator_index;
    set_.table().set_operator(index, {payload + layout_.imports_at() + import.offset, import.bytes},
                              now - Nanoseconds{age * kNsPerUs}, (valid >> i & 1) != 0);
  }
}

// The last values stand, but are not valid; their age keeps the time of their publication.
void HostLink::go_stale() noexcept {
  is_stale_ = true;
  flag_word_.store(kStaleFlag, std::memory_order_relaxed);
  for (const board_link::Import& import : layout_.imports()) {
    const std::uint32_t index = set_.spec().variables[import.variable.index].operator_index;
    const chimera_slot& last = *set_.table().operators()[index].published();
    const auto* value = reinterpret_cast<const std::byte*>(&last + 1);
    set_.table().set_operator(index, {value, import.bytes}, Nanoseconds{last.published_ns}, false);
  }
}

void HostLink::follow_wanted(BoundarySignals& signals, Nanoseconds now) noexcept {
  for (std::size_t i = layout_.exports().size(); i-- > 0;) {
    const TaskId id = layout_.exports()[i].task;
    const State state = set_.tasks()[id.index].shown_state();
    if (is_wanted(i)) continue;
    if (state == State::kOn) (void)signals.operate({&id, 1}, Signal::kOff, now);
    if (state == State::kError) (void)signals.operate({&id, 1}, Signal::kClear, now);
  }
  turn_on_wanted(signals, now);
}

// All together, because tasks may need each other; if that is refused, each alone.
void HostLink::turn_on_wanted(BoundarySignals& signals, Nanoseconds now) noexcept {
  FixedVector<TaskId, board_link::kMostTasks> missing;
  for (const TaskId id : set_.spec().on_order)
    for (std::size_t i = 0; i < layout_.exports().size(); ++i)
      if (layout_.exports()[i].task == id && is_wanted(i) && set_.tasks()[id.index].shown_state() == State::kOff)
        (void)missing.try_push(id);
  if (missing.empty()) return;
  const SignalReport all = signals.operate({missing.begin(), missing.size()}, Signal::kOn, now);
  if (all.is_accepted || missing.size() == 1) return;
  for (const TaskId id : missing) (void)signals.operate({&id, 1}, Signal::kOn, now);
}

void HostLink::send(Nanoseconds now) noexcept {
  send_at_ = now + times_.period;
  if (out_sent_.load(std::memory_order_acquire) != out_size_.load(std::memory_order_relaxed)) return;
  const std::size_t size = board_link::encode_frame(payload_.first(fill(payload_.data(), now)), out_);
  out_size_.store(0, std::memory_order_relaxed);
  out_sent_.store(0, std::memory_order_relaxed);
  out_size_.store(static_cast<std::uint32_t>(size), std::memory_order_release);
}

std::size_t HostLink::fill(std::byte* payload, Nanoseconds now) noexcept {
  board_link::FrameHead head{
      .kind = board_link::FrameKind::kFromBoard, .sequence = ++sequence_, .layout = layout_.hash()};
  head.sent_us = static_cast<std::uint64_t>(now.count / kNsPerUs);
  head.received = received_;
  head.wanted = wanted_;
  write_as(payload, head);
  for (std::size_t i = 0; i < layout_.exports().size(); ++i) {
    const board_link::Export& its = layout_.exports()[i];
    const Task& task = set_.tasks()[its.task.index];
    const GroupReader group = set_.memory(its.task).reader();
    const chimera_slot& slot = *group.published();
    board_link::TaskNews news{.state = static_cast<std::uint8_t>(task.shown_state()),
                        .faults = static_cast<std::uint8_t>(task.faults.count)};
    if (!group.is_initial(slot.sequence))
      news.sequence = std::max<std::uint16_t>(1, static_cast<std::uint16_t>(slot.sequence));
    news.age_us = age_us(now - Nanoseconds{slot.published_ns});
    write_as(payload + board_link::LinkLayout::news_at(i), news);
    std::memcpy(payload + layout_.exports_at() + its.offset, &slot + 1, its.bytes);
  }
  return add_fault(payload);
}

// One task in ERROR after the other.
std::size_t HostLink::add_fault(std::byte* payload) noexcept {
  const std::size_t n = layout_.exports().size();
  for (std::size_t looked = 0; looked < n; ++looked) {
    const std::uint8_t i = next_fault_;
    next_fault_ = static_cast<std::uint8_t>(next_fault_ + 1u < n ? next_fault_ + 1u : 0);
    const Task& task = set_.tasks()[layout_.exports()[i].task.index];
    if (task.state != State::kError) continue;
    board_link::FaultNews news{.task = i, .method = static_cast<std::uint8_t>(task.faults.method),
                         .code = task.faults.last.code};
    std::strncpy(news.text, task.faults.last.text, sizeof news.text - 1);
    write_as(payload + layout_.fault_at(), news);
    return layout_.most_from_board_bytes();
  }
  return layout_.fault_at();
}

}  // namespace chimera::firmware
