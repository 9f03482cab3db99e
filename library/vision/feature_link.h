// SPDX-License-Identifier: Apache-2.0
// Carries features of pictures from the vision subsystem: datagrams of one line of text, or a recording of such lines.
//
//   udp:ADDRESS:PORT   IPv4 in numbers; the reader binds it, the writer sends there
//   unix:PATH          a datagram socket of that path; @NAME is an abstract one
//   here:NAME          between tasks of one process: two runs of one description do not share it
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

/// Writes one line without its end, at most 94 bytes, and returns its length; 0 if a number is too large for a picture.
/// Context: any.
std::size_t feature_text(const Feature& feature, char (&text)[96]);
/// Returns false if `text` is not four finite numbers with commas between them. Context: any.
bool read_feature(const char* text, Feature& feature);

/// Passes features from one thread to another. A full ring drops the newest. One writer, one reader.
class FeatureRing {
 public:
  /// Returns false if the ring is full. Context: cycle; wait-free.
  bool put(const Feature& feature) noexcept {
    const std::uint64_t at = put_.load(std::memory_order_relaxed);
    // SYNC: pairs with the release in take(): the place is free.
    if (at - taken_.load(std::memory_order_acquire) >= kPlaces) return false;
    places_[at % kPlaces] = feature;
    // SYNC: pairs with the acquire in take(): the feature is complete before it is counted.
    put_.store(at + 1, std::memory_order_release);
    return true;
  }
  /// Returns false if the ring is empty. Context: cycle; wait-free.
  bool take(Feature& feature) noexcept {
    const std::uint64_t at = taken_.load(std::memory_order_relaxed);
    // SYNC: pairs with the release in put().
    if (at == put_.load(std::memory_order_acquire)) return false;
    feature = places_[at % kPlaces];
    // SYNC: pairs with the acquire in put(): the place is free.
    taken_.store(at + 1, std::memory_order_release);
    return true;
  }

 private:
  static constexpr std::uint64_t kPlaces = 64;
  std::array<Feature, kPlaces> places_{};
  std::atomic<std::uint64_t> put_{0}, taken_{0};  // each release pairs with the acquire of the other method
};

/// The writing end: send() in cycle, flush() in background.
class FeatureWriter {
 public:
  FeatureWriter() = default;
  ~FeatureWriter() { close(); }
  FeatureWriter(const FeatureWriter&) = delete;
  FeatureWriter& operator=(const FeatureWriter&) = delete;

  /// Refuses a text that names no link, and passes on a refusal of the system. Context: setup; may block.
  Result<void> open(const std::string& link);
  /// Returns false if the ring is full. Context: cycle; wait-free.
  bool send(const Feature& feature) noexcept { return ring_.put(feature); }
  /// Writes all waiting features. A datagram without a receiver is lost. Context: background; may block.
  void flush();
  void close();
  /// Names the file if a recording goes to another one than the link names; else empty. Context: setup.
  const std::string& note() const noexcept { return note_; }

 private:
  int file_ = -1;
  bool records_ = false;
  std::string note_;
  std::vector<std::byte> to_;  // address of the reader
  FeatureRing ring_;
};

/// The reading end: drain() in background, take() in cycle.
class FeatureReader {
 public:
  FeatureReader() = default;
  ~FeatureReader() { close(); }
  FeatureReader(const FeatureReader&) = delete;
  FeatureReader& operator=(const FeatureReader&) = delete;

  /// Refuses a text that names no link and a recording with a bad line (with its number), and passes on a refusal of
  /// the system. Context: setup; may block.
  Result<void> open(const std::string& link);
  /// Restarts a recording. Context: cycle; wait-free.
  void rewind() noexcept { next_ = 0; }
  /// Takes the next feature; of a recording only if `elapsed` seconds since rewind() have reached its time. Returns
  /// false if there is none. Context: cycle; wait-free.
  bool take(double elapsed, Feature& feature) noexcept;
  /// Reads all datagrams that have arrived. Counts and drops lines that are no features. Context: background; may
  /// block.
  void drain();
  void close();
  /// Number of messages that were no features. Context: any; wait-free.
  std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }

 private:
  Result<void> play(const std::string& path);

  int file_ = -1;
  std::string unlink_;
  std::vector<Feature> recording_;
  std::size_t next_ = 0;
  FeatureRing ring_;
  std::atomic<std::uint64_t> refused_{0};  // relaxed: orders no other data
};

}  // namespace chimera::library
