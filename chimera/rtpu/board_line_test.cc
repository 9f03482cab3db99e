// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/board_line.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "chimera/base/testing/await.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::board_line_test {

struct Axis {
  In<double> u{"u", "V"};
  Out<double> q{"q", "rad", initial = 0.0};
  void cycle(Cycle) {}
};

/// A line to a board whose side the test plays, over UDP on this machine.
class Scene {
 public:
  explicit Scene(Nanoseconds stale_after) {
    std::mt19937 random(std::random_device{}());
    for (Result<ByteLine> opened = ByteLine::open_udp(""); !board_.is_open();) {
      const std::string a = std::to_string(20000 + random() % 20000), b = std::to_string(20000 + random() % 20000);
      address_ = "127.0.0.1:" + a + "@" + b;
      opened = ByteLine::open_udp("127.0.0.1:" + b + "@" + a);
      if (opened) board_ = *std::move(opened);
    }
    app_.add("axis", testing::component<Axis>("axis")).rtpu = RtpuId(0u);
    app_.give(app_.operators, "u", CHIMERA_FLOAT64, testing::bytes_of(0.0));
    app_.make({}, false);
    rtpus_[0].link = {address_, true, 115200, milliseconds(5), stale_after};
    app_.spec.rtpus = rtpus_;
    over_ = *WakeEvent::open(Message("test"));
    line_.emplace(app_.spec, RtpuId(0u));
    layout_.plan(app_.spec, RtpuId(0u), heap_);
    line_->start(over_);
  }

  void send(std::vector<std::byte> payload) {
    std::vector<std::byte> line(board_link::line_bytes(payload.size()));
    line.resize(board_link::encode_frame(payload, line));
    board_.write(line);
  }
  std::vector<std::byte> payload(std::uint64_t us, double q, State state = State::kOn) {
    std::vector<std::byte> bytes(layout_.fault_at());
    const board_link::FrameHead head{.kind = board_link::FrameKind::kFromBoard,
                                     .sequence = ++sequence_,
                                     .layout = layout_.hash(),
                                     .sent_us = us};
    const board_link::TaskNews news{.state = static_cast<std::uint8_t>(state), .sequence = sequence_, .age_us = 250};
    std::memcpy(bytes.data(), &head, sizeof head);
    std::memcpy(bytes.data() + board_link::LinkLayout::news_at(0), &news, sizeof news);
    std::memcpy(bytes.data() + layout_.exports_at(), &q, sizeof q);
    return bytes;
  }
  /// Sends frames until `is_it` holds.
  template <class IsIt>
  void send_until(const char* what, double q, IsIt is_it) {
    EXPECT_TRUE(await_that([&] {
      send(payload(now_us_ += 1000, q));
      return is_it();
    })) << what;
  }
  /// The next frame that the line sent, or one that came before.
  std::optional<std::vector<std::byte>> received() {
    std::array<std::byte, 4096> bytes;
    std::optional<std::vector<std::byte>> last;
    for (std::size_t n; (n = board_.read(bytes)) > 0;)
      for (std::size_t i = 0; i < n; ++i)
        if (reader_.add(bytes[i])) last.emplace(reader_.payload().begin(), reader_.payload().end());
    return last;
  }

  BoardLine& line() { return *line_; }
  BoardLine::Life life() const { return line_->life(); }
  const board_link::LinkLayout& layout() const { return layout_; }
  std::uint64_t now_us() const { return now_us_; }

 private:
  std::string address_;
  ByteLine board_;
  testing::TestApplication app_;
  RtpuSpec rtpus_[1] = {{.name = "board"}};
  HeapMemory heap_;
  board_link::LinkLayout layout_;
  board_link::FrameDecoder reader_;
  WakeEvent over_;
  std::optional<BoardLine> line_;
  std::uint16_t sequence_ = 0;
  std::uint64_t now_us_ = 1'000'000;
};

constexpr Nanoseconds kLong = seconds(3600);

TEST(BoardLine, IsUpWithTheFirstFrameAndGivesItsValues) {
  Scene scene(kLong);
  EXPECT_EQ(scene.life(), BoardLine::Life::kWaiting);
  EXPECT_EQ(scene.line().task(0).frames, 0u);
  scene.send_until("the line is up", 1.5, [&] { return scene.life() == BoardLine::Life::kUp; });
  EXPECT_EQ(scene.line().task(0).state, State::kOn);
  EXPECT_EQ(scene.line().task(0).age, microseconds(250));
  double q = 0;
  scene.line().read_outputs(0, reinterpret_cast<std::byte*>(&q));
  EXPECT_EQ(q, 1.5);
}

TEST(BoardLine, SendsImportsWantedTasksAndFlag) {
  Scene scene(kLong);
  const double u = 12;
  scene.line().want(0, true);
  scene.line().set_flag(true);
  scene.line().set_import(0, &u, true, LinuxClock().now());
  board_link::FrameHead head;
  double got = 0;
  std::uint64_t valid = 0;
  EXPECT_TRUE(await_that([&] {
    const auto frame = scene.received();
    if (!frame) return false;
    std::memcpy(&head, frame->data(), sizeof head);
    std::memcpy(&got, frame->data() + scene.layout().imports_at(), sizeof got);
    std::memcpy(&valid, frame->data() + board_link::LinkLayout::valid_at(), sizeof valid);
    return got == u && head.wanted == 1;
  })) << "a frame with all of it";
  EXPECT_EQ(valid, 1u);
  EXPECT_EQ(head.flags, board_link::kFlagIsUp);
  EXPECT_EQ(head.layout, scene.layout().hash());
}

TEST(BoardLine, EndsAfterSilenceAndSaysHowLong) {
  Scene scene(milliseconds(20));
  scene.send_until("the line is up", 0, [&] { return scene.life() != BoardLine::Life::kWaiting; });
  EXPECT_TRUE(await_that([&] { return scene.line().has_ended(); })) << "the line has ended";
  EXPECT_EQ(scene.life(), BoardLine::Life::kSilent);
  EXPECT_TRUE(scene.line().trouble().ends_with("('stale_after' is 20 ms)")) << scene.line().trouble();
}

TEST(BoardLine, EndsWhenTheBoardBeginsAnew) {
  Scene scene(kLong);
  scene.send_until("the line is up", 0, [&] { return scene.life() == BoardLine::Life::kUp; });
  EXPECT_TRUE(await_that([&] {
    scene.send(scene.payload(10, 0));
    return scene.line().has_ended();
  })) << "the line has ended";
  EXPECT_EQ(scene.life(), BoardLine::Life::kRestarted);
  EXPECT_EQ(scene.line().trouble(), "the board was restarted");
}

TEST(BoardLine, TellsAnImageOfAnotherDescription) {
  Scene scene(kLong);
  auto other = scene.payload(5, 0);
  other[4] ^= std::byte{1};
  EXPECT_TRUE(await_that([&] {
    scene.send(other);
    return scene.life() == BoardLine::Life::kForeign;
  })) << "the image is foreign";
  scene.send_until("the right image", 0, [&] { return scene.life() == BoardLine::Life::kUp; });
}

TEST(BoardLine, IgnoresNoiseAndRepeatedFrames) {
  Scene scene(kLong);
  scene.send_until("the line is up", 3, [&] { return scene.life() == BoardLine::Life::kUp; });
  const auto last = scene.payload(scene.now_us() + 1, 4);
  const std::uint32_t before = scene.line().task(0).frames;
  std::mt19937 random(7);
  std::vector<std::byte> noise(200);
  for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
  EXPECT_TRUE(await_that([&] {
    scene.send(noise);
    scene.send(last);
    return scene.line().task(0).frames > before;
  })) << "a frame behind noise and repetitions";
  EXPECT_EQ(scene.life(), BoardLine::Life::kUp);
  double q = 0;
  scene.line().read_outputs(0, reinterpret_cast<std::byte*>(&q));
  EXPECT_TRUE(q == 3 || q == 4) << q;
}

TEST(BoardLine, WantsNothingAtTheEnd) {
  Scene scene(kLong);
  scene.line().want(0, true);
  EXPECT_TRUE(await_that([&] {
    const auto frame = scene.received();
    if (!frame) return false;
    board_link::FrameHead head;
    std::memcpy(&head, frame->data(), sizeof head);
    return head.wanted == 1;
  })) << "a frame that wants the task";
  scene.line().stop();
  const auto frame = scene.received();
  ASSERT_TRUE(frame);
  board_link::FrameHead head;
  std::memcpy(&head, frame->data(), sizeof head);
  EXPECT_EQ(head.wanted, 0u);
}

}  // namespace chimera::board_line_test
