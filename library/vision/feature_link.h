// SPDX-License-Identifier: Apache-2.0
// How pictures' features come from the vision subsystem: datagrams of one line of text, or a recording of such lines.
//
//   udp:ADDRESS:PORT   IPv4 in numbers; the reader binds it, the writer sends there
//   unix:PATH          a datagram socket of that path; @NAME is an abstract one
//   here:NAME          the same between tasks of one process: one description in two places does not meet itself
//   file:PATH          a recording: the writer makes it, the reader plays it from its `on`
//
//   t,u,v,size                     first line of a recording
//   0.033333,641.2003,480.1177,26.66680
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "library/vision/pinhole.h"

namespace chimera::library {

/// One line without its end, at most 94 bytes; its length. 0: it would not fit, because a number is beyond what any
/// picture has. Context: any.
std::size_t feature_text(const Feature& feature, char (&text)[96]);
/// False when `text` is not four finite numbers with commas between. Context: any.
bool read_feature(const char* text, Feature& feature);

/// Features on their way from one thread to another; a full ring drops the newest. One writer, one reader.
class FeatureRing {
 public:
  /// False when it is full. Context: cycle; wait-free.
  bool put(const Feature& feature) noexcept {
    const std::uint64_t at = put_.load(std::memory_order_relaxed);
    // SYNC: pairs with the release in take(): that place is free.
    if (at - taken_.load(std::memory_order_acquire) >= kPlaces) return false;
    places_[at % kPlaces] = feature;
    // SYNC: pairs with the acquire in take(): the feature is whole before it is counted.
    put_.store(at + 1, std::memory_order_release);
    return true;
  }
  /// False when it is empty. Context: cycle; wait-free.
  bool take(Feature& feature) noexcept {
    const std::uint64_t at = taken_.load(std::memory_order_relaxed);
    // SYNC: pairs with the release in put().
    if (at == put_.load(std::memory_order_acquire)) return false;
    feature = places_[at % kPlaces];
    // SYNC: pairs with the acquire in put(): this place is free.
    taken_.store(at + 1, std::memory_order_release);
    return true;
  }

 private:
  static constexpr std::uint64_t kPlaces = 64;
  std::array<Feature, kPlaces> places_{};
  std::atomic<std::uint64_t> put_{0}, taken_{0};  // the release of put() and of take() pairs with the other's acquire
};

/// The end that writes: send() in cycle, flush() in background.
class FeatureWriter {
 public:
  FeatureWriter() = default;
  ~FeatureWriter() { close(); }
  FeatureWriter(const FeatureWriter&) = delete;
  FeatureWriter& operator=(const FeatureWriter&) = delete;

  /// Refuses a text that names no link, and what the system refuses. Context: setup; may block.
  Result<void> open(const std::string& link);
  /// False when it found no room. Context: cycle; wait-free.
  bool send(const Feature& feature) noexcept { return ring_.put(feature); }
  /// Writes what waits. A datagram that nobody takes is lost, as datagrams are. Context: background; may block.
  void flush();
  void close();

 private:
  int file_ = -1;
  bool records_ = false;
  std::vector<std::byte> to_;  // where datagrams go
  FeatureRing ring_;
};

/// The end that reads: drain() in background, take() in cycle.
class FeatureReader {
 public:
  FeatureReader() = default;
  ~FeatureReader() { close(); }
  FeatureReader(const FeatureReader&) = delete;
  FeatureReader& operator=(const FeatureReader&) = delete;

  /// Refuses a text that names no link, a recording with a bad line (and says which), and what the system refuses.
  /// Context: setup; may block.
  Result<void> open(const std::string& link);
  /// A recording starts again. Context: cycle; wait-free.
  void rewind() noexcept { next_ = 0; }
  /// The next feature, of a recording when `elapsed` seconds since rewind() have reached its time. False when there is
  /// none. Context: cycle; wait-free.
  bool take(double elapsed, Feature& feature) noexcept;
  /// Reads what has arrived; lines that are no features are counted and left. Context: background; may block.
  void drain();
  void close();
  /// Messages that were no features. Context: any; wait-free.
  std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }

 private:
  Result<void> play(const std::string& path);

  int file_ = -1;
  std::string unlink_;
  std::vector<Feature> recording_;
  std::size_t next_ = 0;
  FeatureRing ring_;
  std::atomic<std::uint64_t> refused_{0};  // relaxed: a figure that pairs with nothing
};

}  // namespace chimera::library
