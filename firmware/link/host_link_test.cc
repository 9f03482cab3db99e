// SPDX-License-Identifier: Apache-2.0
#include "firmware/link/host_link.h"

#include <gtest/gtest.h>

#include <cstring>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::firmware::host_link_test {

struct Seen {
  bool is_valid = false, is_illegal = false, fails = false;
  Nanoseconds age;
  double u = 0;
};
Seen seen;

struct Axis {
  In<double> u{"u", "V"};
  Out<double> q{"q", "rad", initial = 0.0};
  Outcome cycle(Cycle c) {
    seen.is_valid = u.valid();
    seen.is_illegal = c.illegal();
    seen.age = u.age();
    seen.u = *u;
    if (seen.fails) return fault("the encoder is gone", 7);
    *q += *u;
    return ok();
  }
};

struct Lamp {
  Out<bool> lit{"lit", "1", initial = false};
  void cycle(Cycle c) { *lit = c.count() % 2 == 0; }
};

constexpr HostLink::Times kTimes{milliseconds(10), milliseconds(50), milliseconds(1)};

/// A board with two tasks of 1 ms on a stepped clock, and the other end of its line.
class Board : private Clock, private JobClock {
 public:
  Board() {
    seen = {};
    app_.add("axis", testing::component<Axis>("axis")).rtpu = RtpuId(0u);
    app_.add("lamp", testing::component<Lamp>("lamp")).rtpu = RtpuId(0u);
    app_.give(app_.operators, "u", CHIMERA_FLOAT64, testing::bytes_of(0.0));
    app_.make({}, false);
    app_.spec.on_order = order_;
    app_.spec.start = {};
    set_ = *HeapTaskSet::create(app_.spec, app_.components);
    link_.emplace(*set_, kTimes, heap_);
    layout_.plan(app_.spec, RtpuId(0u), heap_);
    RunOptions options;
    options.guest = &*link_;
    executive_.emplace(*set_, static_cast<Clock&>(*this), static_cast<JobClock&>(*this), options);
    EXPECT_TRUE(executive_->start());
  }
  ~Board() { executive_->shut_down(); }

  void run_ms(int time) {
    until_ += milliseconds(time);
    EXPECT_EQ(executive_->run(until_), RunEnd::kTime);
  }
  /// A frame of Linux: `wanted` tasks, the value of u.
  std::vector<std::byte> frame(std::uint32_t wanted, double u, bool valid = true, std::uint8_t flags = 0) {
    std::vector<std::byte> payload(layout_.to_board_bytes());
    const board_link::FrameHead head{.kind = board_link::FrameKind::kToBoard, .flags = flags, .sequence = ++sequence_,
                               .layout = layout_.hash(), .wanted = wanted};
    const std::uint64_t bits = valid ? 1 : 0;
    const std::uint32_t age = 3000;
    std::memcpy(payload.data(), &head, sizeof head);
    std::memcpy(payload.data() + board_link::LinkLayout::valid_at(), &bits, 8);
    std::memcpy(payload.data() + board_link::LinkLayout::ages_at(), &age, 4);
    std::memcpy(payload.data() + layout_.imports_at(), &u, 8);
    std::vector<std::byte> line(board_link::line_bytes(payload.size()));
    line.resize(board_link::encode_frame(payload, line));
    return line;
  }
  void send(const std::vector<std::byte>& bytes) {
    for (const std::byte byte : bytes) link_->receive(std::to_integer<std::uint8_t>(byte));
  }
  /// Sends a frame every 10 ms, as Linux does.
  void keep_up_ms(int time, std::uint32_t wanted, double u) {
    for (int t = 0; t < time; t += 10) send(frame(wanted, u)), run_ms(10);
  }
  /// The payloads of all frames that the board sent since the last call.
  std::vector<std::vector<std::byte>> sent() {
    std::vector<std::vector<std::byte>> found;
    for (const std::byte byte : out_)
      if (reader_.add(byte)) found.emplace_back(reader_.payload().begin(), reader_.payload().end());
    out_.clear();
    return found;
  }
  board_link::TaskNews news(const std::vector<std::byte>& payload, std::size_t i) const {
    board_link::TaskNews news;
    std::memcpy(&news, payload.data() + board_link::LinkLayout::news_at(i), sizeof news);
    return news;
  }
  double q(const std::vector<std::byte>& payload) const {
    double value = 0;
    std::memcpy(&value, payload.data() + layout_.exports_at(), sizeof value);
    return value;
  }

  State state(std::size_t task) const { return set_->tasks()[task].shown_state(); }
  HostLink& link() { return *link_; }
  const board_link::LinkLayout& layout() const { return layout_; }

 private:
  Nanoseconds now() noexcept override { return now_; }
  void spend(Nanoseconds time) noexcept override { now_ += time; }
  WaitEnd wait_until(Nanoseconds instant) noexcept override {
    for (int byte; (byte = link_->next_byte()) >= 0;) out_.push_back(static_cast<std::byte>(byte));
    now_ = std::max(now_, instant);
    return WaitEnd::kReached;
  }

  testing::TestApplication app_;
  std::vector<TaskId> order_{TaskId(0u), TaskId(1u)};
  HeapMemory heap_;
  std::unique_ptr<HeapTaskSet> set_;
  std::optional<HostLink> link_;
  board_link::LinkLayout layout_;
  std::optional<Executive> executive_;
  board_link::FrameDecoder reader_;
  std::vector<std::byte> out_;
  std::uint16_t sequence_ = 0;
  Nanoseconds now_, until_;
};

TEST(HostLink, StartsNothingAndSendsFramesAtItsRate) {
  Board board;
  board.run_ms(100);
  EXPECT_EQ(board.state(0), State::kOff);
  const auto frames = board.sent();
  ASSERT_EQ(frames.size(), 10u);
  EXPECT_EQ(frames[9].size(), board.layout().fault_at());
  EXPECT_EQ(board.news(frames[9], 0).state, static_cast<std::uint8_t>(State::kOff));
  EXPECT_EQ(board.news(frames[9], 0).sequence, 0u) << "nothing was published";
}

TEST(HostLink, TurnsTasksOnAndOffAsWanted) {
  Board board;
  board.keep_up_ms(20, 1, 0.5);
  EXPECT_EQ(board.state(0), State::kOn);
  EXPECT_EQ(board.state(1), State::kOff);
  board.keep_up_ms(20, 3, 0.5);
  EXPECT_EQ(board.state(1), State::kOn);
  board.keep_up_ms(20, 2, 0.5);
  EXPECT_EQ(board.state(0), State::kOff);
  EXPECT_EQ(board.state(1), State::kOn);
}

TEST(HostLink, CarriesValuesWithAgeAndSequenceBothWays) {
  Board board;
  board.keep_up_ms(20, 1, 0.5);
  EXPECT_TRUE(seen.is_valid);
  EXPECT_EQ(seen.u, 0.5);
  EXPECT_GE(seen.age, milliseconds(3)) << "the age on Linux counts";
  EXPECT_LE(seen.age, milliseconds(13));
  const auto frames = board.sent();
  ASSERT_FALSE(frames.empty());
  EXPECT_GT(board.q(frames.back()), 0);
  EXPECT_NE(board.news(frames.back(), 0).sequence, 0u);
  EXPECT_LE(board.news(frames.back(), 0).age_us, 1000u);
}

TEST(HostLink, AValueThatIsNotValidOnLinuxIsNotValidOnTheBoard) {
  Board board;
  board.send(board.frame(1, 2, false));
  board.run_ms(5);
  EXPECT_FALSE(seen.is_valid);
}

TEST(HostLink, SilenceMakesValuesInvalidAndRaisesTheFlagUntilFramesComeBack) {
  Board board;
  board.keep_up_ms(20, 1, 0.5);
  EXPECT_FALSE(seen.is_illegal);
  board.run_ms(30);
  EXPECT_TRUE(seen.is_valid) << "40 ms after the last frame";
  board.run_ms(20);
  EXPECT_FALSE(seen.is_valid);
  EXPECT_TRUE(seen.is_illegal);
  EXPECT_EQ(board.state(0), State::kOn);
  board.keep_up_ms(10, 1, 0.25);
  EXPECT_TRUE(seen.is_valid);
  EXPECT_FALSE(seen.is_illegal);
}

TEST(HostLink, TellsFaultAndClearsItWhenTheTaskIsNotWanted) {
  Board board;
  board.keep_up_ms(20, 3, 0.5);
  seen.fails = true;
  board.keep_up_ms(20, 3, 0.5);
  EXPECT_EQ(board.state(0), State::kError);
  const auto frames = board.sent();
  ASSERT_EQ(frames.back().size(), board.layout().most_from_board_bytes());
  board_link::FaultNews fault;
  std::memcpy(&fault, frames.back().data() + board.layout().fault_at(), sizeof fault);
  EXPECT_EQ(fault.task, 0u);
  EXPECT_EQ(fault.code, 7);
  EXPECT_STREQ(fault.text, "the encoder is gone");
  seen.fails = false;
  board.keep_up_ms(10, 2, 0.5);
  EXPECT_EQ(board.state(0), State::kOff);
  board.keep_up_ms(10, 3, 0.5);
  EXPECT_EQ(board.state(0), State::kOn);
}

TEST(HostLink, CountsRepeatedForeignAndDamagedFramesAsNoFrames) {
  Board board;
  const auto first = board.frame(1, 0.5);
  board.send(first);
  board.run_ms(40);
  EXPECT_EQ(board.link().received(), 1u);
  board.send(first);
  auto damaged = board.frame(3, 0.5);
  damaged[12] ^= std::byte{1};
  board.send(damaged);
  std::mt19937 random(5);
  std::vector<std::byte> noise(400);
  for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
  board.send(noise);
  board.run_ms(20);
  EXPECT_EQ(board.link().received(), 1u);
  EXPECT_GE(board.link().dropped(), 1u);
  EXPECT_TRUE(board.link().is_stale());
  EXPECT_EQ(board.state(1), State::kOff);
}

}  // namespace chimera::firmware::host_link_test
