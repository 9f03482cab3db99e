// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/safe_frame.h"

#include <gtest/gtest.h>

#include <string>

namespace chimera {
namespace {

struct SafeFrameTest : ::testing::Test {
  void put(const std::string& text) { frame.put(std::as_bytes(std::span(text))); }
  std::string last() {
    const auto bytes = frame.last_words();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  SafeFrame frame{};
};

TEST_F(SafeFrameTest, TheLastBytesStand) {
  EXPECT_EQ(last(), "");
  put("first");
  EXPECT_EQ(last(), "first");
  put("second");
  EXPECT_EQ(last(), "second");
  put("");
  EXPECT_EQ(last(), "");
  put(std::string(kSafeBytes, 'x'));
  EXPECT_EQ(last(), std::string(kSafeBytes, 'x'));
}

TEST_F(SafeFrameTest, AWriterThatDiesWhileItWritesLeavesTheFrameBefore) {
  put("whole");
  const auto standing = frame.last_words();
  put("new");
  EXPECT_NE(frame.last_words().data(), standing.data()) << "the next frame is written beside the present one";
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(standing.data()), 5), "whole");
}

TEST_F(SafeFrameTest, AnInvalidWordIsNoFrame) {
  auto* word = reinterpret_cast<std::uint32_t*>(&frame);
  *word = (kSafeBytes + 1) << 1;
  EXPECT_EQ(last(), "");
}

}  // namespace
}  // namespace chimera
