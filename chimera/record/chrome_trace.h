// SPDX-License-Identifier: Apache-2.0
// Tap records as a Chrome trace, which ui.perfetto.dev opens (docs/formats/trace.md).
#pragma once

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/runtime/tap_record.h"

namespace chimera {

/// A task as the trace shows it: `rtpu` is the index of the process it belongs to.
struct TraceTask {
  std::string name;
  std::uint32_t rtpu = 0;
};

/// Writes while it is fed: memory does not grow with the run. Context: setup; may block.
class ChromeTrace {
 public:
  /// Begins the document on `out`, which stays the caller's and open. `origin` is time 0 of the trace.
  ChromeTrace(std::FILE* out, std::span<const std::string> rtpus, std::span<const TraceTask> tasks,
              Nanoseconds origin);
  ChromeTrace(const ChromeTrace&) = delete;
  ChromeTrace& operator=(const ChromeTrace&) = delete;

  /// Appends the records. One of a task that was not named is shown under the number of the task.
  void write(std::span<const TapRecord> records);

  /// Ends the document, which is valid JSON only then. `dropped`: records the tap lost, kept in the document.
  /// False when anything could not be written. Call once.
  [[nodiscard]] bool close(std::uint64_t dropped);

 private:
  void write_record(const TapRecord& record);
  void event(const std::string& body);

  std::FILE* out_;
  std::vector<TraceTask> tasks_;
  Nanoseconds origin_;
  bool is_first_ = true;
  bool failed_ = false;
};

}  // namespace chimera
