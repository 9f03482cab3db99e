// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/link/frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <string_view>
#include <vector>

namespace chimera::board_link {
namespace {

using Bytes = std::vector<std::byte>;

Bytes encoded(const Bytes& payload) {
  Bytes line(line_bytes(payload.size()));
  line.resize(encode_frame(payload, line));
  return line;
}

/// The payloads of all whole frames on the line.
std::vector<Bytes> read(FrameDecoder& reader, const Bytes& line) {
  std::vector<Bytes> found;
  for (const std::byte byte : line)
    if (reader.add(byte)) found.emplace_back(reader.payload().begin(), reader.payload().end());
  return found;
}

Bytes text(std::string_view text) {
  Bytes bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

Bytes random_bytes(std::mt19937& random, std::size_t size) {
  Bytes bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() % 4 == 0 ? 0 : random());
  return bytes;
}

TEST(Frame, HasTheCrcOfEthernet) { EXPECT_EQ(crc32(text("123456789")), 0xcbf43926u); }

TEST(Frame, CarriesEverySizeAndNoZeroInside) {
  std::mt19937 random(1);
  for (std::size_t size = 1; size <= kMostPayload; ++size)
    for (const Bytes& payload : {random_bytes(random, size), Bytes(size, std::byte{0}), Bytes(size, std::byte{7})}) {
      const Bytes line = encoded(payload);
      EXPECT_EQ(std::count(line.begin() + 1, line.end() - 1, std::byte{0}), 0) << size;
      FrameDecoder reader;
      EXPECT_EQ(read(reader, line), std::vector<Bytes>{payload}) << size;
      EXPECT_EQ(reader.dropped(), 0u);
    }
}

TEST(FrameDecoder, FindsFramesBetweenTextLines) {
  Bytes line;
  for (const Bytes& piece : {text("stack 640 of 2048\n"), encoded(text("one")), text("ok\r\nstatus\r\n"),
                             encoded(text("two")), encoded(text("three"))})
    line.insert(line.end(), piece.begin(), piece.end());
  FrameDecoder reader;
  EXPECT_EQ(read(reader, line), (std::vector<Bytes>{text("one"), text("two"), text("three")}));
  EXPECT_EQ(reader.dropped(), 2u);  // the texts
}

TEST(FrameDecoder, RefusesEveryFrameWithADamagedByte) {
  std::mt19937 random(2);
  const Bytes payload = random_bytes(random, 80), line = encoded(payload);
  for (std::size_t at = 1; at + 1 < line.size(); ++at)
    for (unsigned change = 1; change < 256; ++change) {
      Bytes damaged = line;
      damaged[at] ^= static_cast<std::byte>(change);
      FrameDecoder reader;
      ASSERT_TRUE(read(reader, damaged).empty()) << at << " " << change;
      ASSERT_EQ(read(reader, line), std::vector<Bytes>{payload});  // and finds the next one
    }
}

TEST(FrameDecoder, RefusesAFrameThatLostOrGotAByte) {
  std::mt19937 random(3);
  const Bytes payload = random_bytes(random, 300), line = encoded(payload);
  for (std::size_t at = 1; at + 1 < line.size(); ++at) {
    Bytes less = line, more = line;
    less.erase(less.begin() + static_cast<std::ptrdiff_t>(at));
    more.insert(more.begin() + static_cast<std::ptrdiff_t>(at), std::byte{0x55});
    FrameDecoder reader;
    EXPECT_TRUE(read(reader, less).empty()) << at;
    EXPECT_TRUE(read(reader, more).empty()) << at;
  }
}

TEST(FrameDecoder, FindsTheNextFrameBehindAMegabyteOfNoise) {
  std::mt19937 random(4);
  FrameDecoder reader;
  for (const Bytes& noise : {random_bytes(random, 1 << 20), Bytes(1 << 20, std::byte{0x41})}) {
    EXPECT_TRUE(read(reader, noise).empty());
    EXPECT_EQ(read(reader, encoded(text("whole"))), std::vector<Bytes>{text("whole")});
  }
}

}  // namespace
}  // namespace chimera::board_link
