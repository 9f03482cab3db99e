// SPDX-License-Identifier: Apache-2.0
#include "library/frame/frame.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "library/frame/values.h"

namespace chimera::library {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes framed(const Bytes& payload) {
  Bytes made(payload.size() + kFrameOverhead);
  std::memcpy(made.data() + 2, payload.data(), payload.size());
  EXPECT_EQ(close_frame(made.data(), payload.size()), made.size());
  return made;
}

struct FrameReaderTest : ::testing::Test {
  FrameReader reader;
  std::vector<Bytes> got;

  void feed(const Bytes& bytes) {
    if (bytes.empty()) return;
    ASSERT_LE(bytes.size(), reader.room().size());
    std::memcpy(reader.room().data(), bytes.data(), bytes.size());
    reader.taken(bytes.size());
    reader.frames([this](std::span<const std::uint8_t> payload) { got.emplace_back(payload.begin(), payload.end()); });
  }
};

TEST(Crc16, IsCcittFalse) {
  const std::string check = "123456789";  // check value in catalogues of CRCs
  EXPECT_EQ(crc16({reinterpret_cast<const std::uint8_t*>(check.data()), check.size()}), 0x29B1);
  EXPECT_EQ(crc16({}), 0xFFFF);
}

TEST_F(FrameReaderTest, FindsFramesHoweverTheyAreCut) {
  Bytes stream;
  for (std::uint8_t i = 0; i < 50; ++i) {
    const Bytes frame = framed({i, 0xA5, 0x04, i});
    stream.insert(stream.end(), frame.begin(), frame.end());
  }
  for (std::size_t cut = 1; cut < 20; ++cut) {
    got.clear();
    reader.reset(4);
    for (std::size_t at = 0; at < stream.size(); at += cut)
      feed({stream.begin() + static_cast<std::ptrdiff_t>(at),
            stream.begin() + static_cast<std::ptrdiff_t>(std::min(at + cut, stream.size()))});
    ASSERT_EQ(got.size(), 50u) << cut;
    for (std::uint8_t i = 0; i < 50; ++i) ASSERT_EQ(got[i], (Bytes{i, 0xA5, 0x04, i}));
  }
  EXPECT_EQ(reader.wrong(), 0);
  EXPECT_EQ(reader.noise(), 0);
}

TEST_F(FrameReaderTest, AFalseStartHidesNoFrame) {
  reader.reset(4);
  Bytes bytes = {0xA5, 0x04, 0x11};  // start of a frame that never completes
  const Bytes frame = framed({1, 2, 3, 4});
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  feed(bytes);
  EXPECT_EQ(got, std::vector<Bytes>({{1, 2, 3, 4}}));
  EXPECT_EQ(reader.wrong(), 1);
  EXPECT_EQ(reader.noise(), 2);
}

TEST_F(FrameReaderTest, NoFlippedBitPasses) {
  const Bytes good = framed({9, 8, 7, 6});
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    reader.reset(4);
    Bytes bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1u << (bit % 8)));
    feed(bad);
    ASSERT_TRUE(got.empty()) << bit;
  }
}

TEST_F(FrameReaderTest, TrueFramesAreFoundInNoise) {
  std::mt19937 random(7);
  reader.reset(3);
  std::size_t sent = 0;
  for (int i = 0; i < 20000; ++i) {
    Bytes noise(random() % 40);
    for (auto& byte : noise) byte = random() % 4 == 0 ? kFrameStart : static_cast<std::uint8_t>(random() % 0xA0);
    feed(noise);
    feed(framed({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8), 77}));
    ++sent;
  }
  feed(Bytes(20, 0));  // no byte waits after a false start
  std::size_t true_ones = 0;
  for (const Bytes& payload : got) true_ones += payload[2] == 77 ? 1 : 0;
  EXPECT_EQ(true_ones, sent);
}

TEST(Values, ComeBackAndAreHeldWithinTheirForm) {
  std::uint8_t bytes[4];
  put_value(bytes, Form::kFloat32, 1.5, 0.5);
  EXPECT_EQ(std::memcmp(bytes, "\x00\x00\x40\x40", 4), 0);  // 3.0f
  EXPECT_EQ(get_value(bytes, Form::kFloat32, 0.5), 1.5);
  put_value(bytes, Form::kInt16, -0.2, 0.1);
  EXPECT_EQ(std::memcmp(bytes, "\xFE\xFF", 2), 0);
  EXPECT_EQ(get_value(bytes, Form::kInt16, 0.5), -1.0);
  put_value(bytes, Form::kInt16, 1e6, 0.1);
  EXPECT_EQ(get_value(bytes, Form::kInt16, 1), 32767);
  put_value(bytes, Form::kInt16, -1e6, 0.1);
  EXPECT_EQ(get_value(bytes, Form::kInt16, 1), -32768);
}

}  // namespace
}  // namespace chimera::library
