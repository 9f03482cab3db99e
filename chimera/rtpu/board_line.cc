// SPDX-License-Identifier: Apache-2.0
// Opens the line again while it is lost, and decides when the board counts as gone.
#include "chimera/rtpu/board_line.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"

namespace chimera {
namespace {

constexpr Nanoseconds kOpenAgain = milliseconds(100), kLastWords = milliseconds(30), kLook = milliseconds(2);

std::string ms_text(Nanoseconds time) { return std::to_string(time.count / 1'000'000) + " ms"; }

template <class T>
T read_as(std::span<const std::byte> from, std::size_t at) {
  T value;
  std::memcpy(&value, from.data() + at, sizeof value);
  return value;
}

}  // namespace

BoardLine::BoardLine(const ApplicationSpec& spec, RtpuId rtpu) : spec_(spec.rtpus[rtpu.index].link) {
  layout_.plan(spec, rtpu, memory_);
  from_board_.resize(layout_.most_from_board_bytes());
  to_board_.resize(layout_.to_board_bytes());
  published_.resize(layout_.imports().size());
  faults_.resize(layout_.exports().size());
  has_fault_.resize(layout_.exports().size());
}

Nanoseconds BoardLine::now() noexcept { return LinuxClock().now(); }
void BoardLine::pause() noexcept { LinuxClock().wait_until(now() + kLook); }

void BoardLine::start(WakeEvent& ended) {
  ended_ = &ended;
  thread_ = std::thread([this] { run(); });
}

void BoardLine::stop() {
  is_stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

std::string BoardLine::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

std::size_t BoardLine::index_of(TaskId task) const noexcept {
  const auto found = std::ranges::find(layout_.exports(), task, &board_link::Export::task);
  return static_cast<std::size_t>(found - layout_.exports().begin());
}

void BoardLine::want(std::size_t i, bool on) noexcept {
  const std::lock_guard lock(mutex_);
  wanted_ = on ? wanted_ | 1u << i : wanted_ & ~(1u << i);
}

BoardTask BoardLine::task(std::size_t i) const {
  const std::lock_guard lock(mutex_);
  BoardTask task;
  task.frames = frames_;
  if (frames_ == 0) return task;
  const auto news = read_as<board_link::TaskNews>(from_board_, board_link::LinkLayout::news_at(i));
  task.state = static_cast<State>(news.state);
  task.is_wanted = (read_as<board_link::FrameHead>(from_board_, 0).wanted >> i & 1u) != 0;
  task.sequence = news.sequence;
  task.age = microseconds(news.age_us);
  task.fault = faults_[i];
  task.has_fault = has_fault_[i];
  return task;
}

void BoardLine::read_outputs(std::size_t i, std::byte* to) const {
  const board_link::Export& its = layout_.exports()[i];
  const std::lock_guard lock(mutex_);
  std::memcpy(to, from_board_.data() + layout_.exports_at() + its.offset, its.bytes);
}

void BoardLine::set_import(std::size_t i, const void* value, bool valid, Nanoseconds published) {
  const board_link::Import& import = layout_.imports()[i];
  const std::lock_guard lock(mutex_);
  std::memcpy(to_board_.data() + layout_.imports_at() + import.offset, value, import.bytes);
  auto bits = read_as<std::uint64_t>(to_board_, board_link::LinkLayout::valid_at());
  bits = valid ? bits | std::uint64_t{1} << i : bits & ~(std::uint64_t{1} << i);
  std::memcpy(to_board_.data() + board_link::LinkLayout::valid_at(), &bits, sizeof bits);
  published_[i] = published;
}

void BoardLine::run() {
  for (Nanoseconds next = now(); !is_stopping_; next = std::max(next + spec_.period, now())) {
    if (!line_.is_open() && !open()) {
      listen(now() + spec_.period);
      continue;
    }
    send(now());
    listen(next + spec_.period);
  }
  {
    const std::lock_guard lock(mutex_);
    wanted_ = 0;
  }
  sent_ = out_.size();
  send(now());
  line_.close();
}

bool BoardLine::open() {
  const Nanoseconds at = now();
  if (at < opens_at_) return false;
  opens_at_ = at + kOpenAgain;
  const std::string address(spec_.address);
  auto opened = spec_.is_udp ? ByteLine::open_udp(address) : ByteLine::open_serial(address, spec_.baud);
  if (!opened) {
    const std::lock_guard lock(mutex_);
    if (life() == Life::kWaiting) trouble_ = std::string(opened.error().message.view());
    return false;
  }
  line_ = *std::move(opened);
  return true;
}

// Ends a little early: the thread of an ordinary process is late rather than early.
void BoardLine::listen(Nanoseconds until) {
  std::array<std::byte, 512> bytes;
  do {
    const Nanoseconds rest = std::max(Nanoseconds{}, std::min(until - now(), spec_.period));
    Watched watched[] = {{line_.descriptor()}};
    if (line_.is_open()) (void)await_ready(watched, rest);
    else LinuxClock().wait_until(now() + rest);
    for (std::size_t n; (n = line_.read(bytes)) > 0;)
      for (std::size_t i = 0; i < n; ++i)
        if (reader_.add(bytes[i])) accept(reader_.payload(), now());
    look_for_silence(now());
  } while (now() < until && !is_stopping_);
}

void BoardLine::accept(std::span<const std::byte> payload, Nanoseconds at) {
  if (life() == Life::kSilent || life() == Life::kRestarted) return;
  const bool is_whole = payload.size() == layout_.fault_at() || payload.size() == layout_.most_from_board_bytes();
  if (payload.size() < sizeof(board_link::FrameHead)) return;
  const auto head = read_as<board_link::FrameHead>(payload, 0);
  if (head.kind != board_link::FrameKind::kFromBoard) return;
  if (!is_whole || head.layout != layout_.hash()) {
    const std::lock_guard lock(mutex_);
    if (life() != Life::kWaiting) return;
    trouble_ = "the board runs an image of another description: load the one that 'chimera run --flash' builds";
    return life_.store(Life::kForeign, std::memory_order_release);
  }
  const bool is_up = life() == Life::kUp;
  if (is_up && head.sent_us < board_us_) return go_down(Life::kRestarted, at, "the board was restarted");
  if (is_up && head.sequence == last_sequence_) return;
  last_sequence_ = head.sequence;
  board_us_ = head.sent_us;
  heard_at_ = at;
  {
    const std::lock_guard lock(mutex_);
    std::memcpy(from_board_.data(), payload.data(), payload.size());
    ++frames_;
    if (payload.size() > layout_.fault_at()) {
      auto fault = read_as<board_link::FaultNews>(payload, layout_.fault_at());
      fault.text[sizeof fault.text - 1] = '\0';  // from a line that anything may write to
      if (fault.task < faults_.size()) faults_[fault.task] = fault, has_fault_[fault.task] = true;
    }
  }
  life_.store(Life::kUp, std::memory_order_release);
}

void BoardLine::look_for_silence(Nanoseconds at) {
  if (life() == Life::kUp && at - heard_at_ > spec_.stale_after)
    go_down(Life::kSilent, at,
            "no frame came for " + ms_text(at - heard_at_) + " ('stale_after' is " + ms_text(spec_.stale_after) +
                ")");
  const bool is_down = life() == Life::kSilent || life() == Life::kRestarted;
  if (!is_down || has_ended_ || at - down_at_ < kLastWords) return;
  has_ended_.store(true, std::memory_order_release);
  ended_->ring();
}

void BoardLine::go_down(Life life, Nanoseconds at, std::string trouble) {
  down_at_ = at;
  {
    const std::lock_guard lock(mutex_);
    trouble_ = std::move(trouble);
  }
  life_.store(life, std::memory_order_release);
}

// A frame that the line does not take whole goes on in the next period: a slow line gets fewer frames, each whole.
void BoardLine::send(Nanoseconds at) {
  if (sent_ == out_.size()) {
    const std::lock_guard lock(mutex_);
    board_link::FrameHead head{
        .kind = board_link::FrameKind::kToBoard, .sequence = ++sequence_, .layout = layout_.hash()};
    head.flags = flag_.load(std::memory_order_relaxed) ? board_link::kFlagIsUp : 0;
    head.sent_us = static_cast<std::uint64_t>(at.count / 1000);
    head.wanted = wanted_;
    std::memcpy(to_board_.data(), &head, sizeof head);
    for (std::size_t i = 0; i < published_.size(); ++i) {
      const auto age = static_cast<std::uint32_t>(
          std::clamp<std::int64_t>((at - published_[i]).count / 1000, 0, UINT32_MAX));
      std::memcpy(to_board_.data() + board_link::LinkLayout::ages_at() + 4 * i, &age, sizeof age);
    }
    out_.resize(board_link::line_bytes(to_board_.size()));
    out_.resize(board_link::encode_frame(to_board_, out_));
    sent_ = 0;
  }
  sent_ += line_.write(std::span(out_).subspan(sent_));
  if (!line_.is_open()) sent_ = out_.size();
}

}  // namespace chimera
