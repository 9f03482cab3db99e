// SPDX-License-Identifier: Apache-2.0
// What a method is given (Cycle) and what it may answer (Outcome).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/signal.h"

namespace chimera {

/// The present call, as seen by a component. Valid until the method returns; do not keep it.
class Cycle {
 public:
  explicit Cycle(const chimera_call& call) noexcept : call_(&call) {}

  /// Seconds since the release of the last completed cycle; the period after on(). Context: cycle; wait-free.
  double dt() const noexcept { return to_seconds(step()); }
  /// The same as a duration. Context: cycle; wait-free.
  Nanoseconds step() const noexcept { return {call_->dt_ns}; }
  /// The release of this job; outside cycles the time of the call. Context: any; wait-free.
  Nanoseconds now() const noexcept { return {call_->now_ns}; }
  /// The instant by which this job must be done. Context: cycle; wait-free.
  Nanoseconds deadline() const noexcept { return {call_->deadline_ns}; }
  /// Completed cycles since on(). Context: any; wait-free.
  std::uint64_t count() const noexcept { return call_->cycle; }
  /// Releases that were dropped since the last completed cycle. Context: cycle; wait-free.
  std::uint32_t dropped() const noexcept { return call_->dropped; }
  /// True when the job is past its deadline or was told to give up: answer aborted(), or partial().
  /// Context: cycle; wait-free.
  bool expired() const noexcept { return call_->host->expired(call_->context) != 0; }
  /// The illegal-configuration flag, read once for this job: inputs may mean nothing, so hold a stable state.
  /// Context: cycle; wait-free.
  bool illegal() const noexcept { return call_->illegal != 0; }
  /// Sends `signal` to the task of that name; without a name to the own task. It acts at a cycle edge, after
  /// this method. Signal::kWakeup is an event for a task behind a server: each is answered by one job.
  /// False when there is no such task (kWakeup: none behind a server) or the outbox is full. Context: cycle; wait-free.
  bool signal(Signal signal, const char* task = nullptr) const noexcept {
    return call_->host->signal(call_->context, static_cast<std::uint32_t>(signal), task) == CHIMERA_OK;
  }
  /// Uses `time` of execution time: computes in real time, is added to the modelled time in virtual time.
  /// Context: cycle; takes `time`.
  void spend(Nanoseconds time) const noexcept { call_->host->spend(call_->context, time.count); }
  /// One line for whoever runs the application, at most 159 bytes of `text`: an event, and a line of the run. Of
  /// several in one method the last counts. Context: any; wait-free.
  void note(const char* text) const noexcept { call_->host->note(call_->context, text); }
  /// Asks for a switch, as docs/howto/reconfigure.md says: to the configuration of that name, exactly its tasks ON; or
  /// "--on A --off B", those tasks ON and OFF, and who produces the same as A goes OFF. Of all requests of tasks that
  /// wait the last counts; one for what is in force, or is being switched to, has no effect. False when there is no
  /// such configuration or task, or no switch in this run: one note says so. Context: cycle; wait-free.
  bool request(const char* configuration) const noexcept {
    return call_->host->request(call_->context, configuration) == CHIMERA_OK;
  }
  /// What another process writes to the device when this one is dead: safe frame `index` (0 to 3) goes to `descriptor`,
  /// of which it keeps a copy; a `descriptor` below 0 takes it back. Output that waits in the queue of a terminal is
  /// dropped before, and the line rests for `pause`. Belongs into init, and into clear where that opens anew. False:
  /// nobody would write it, because the run is one process or virtual. Context: setup; may block.
  bool safe_frame(std::uint32_t index, int descriptor, Nanoseconds pause = {}) const noexcept {
    return call_->host->safe_frame(call_->context, index, descriptor, pause.count) == CHIMERA_OK;
  }
  /// The bytes of safe frame `index`, at most 256: from on on, and whenever they change. They stand until the next
  /// ones; none take them back, and so do an off and a kill that end well. Context: any; wait-free.
  bool safe_bytes(std::uint32_t index, const void* bytes, std::size_t size) const noexcept {
    return call_->host->safe_bytes(call_->context, index, bytes, static_cast<std::uint32_t>(size)) == CHIMERA_OK;
  }
  /// The variable or constant that `port` is joined to; empty: none. Good as long as the task. Context: any; wait-free.
  template <class Port>
  std::string_view variable(const Port& port) const noexcept {
    return view(call_->host->variable(call_->context, port.live()));
  }
  /// The unit of its values, as verified: "rad"; "1" for none, empty for a resource. Context: any; wait-free.
  template <class Port>
  std::string_view unit(const Port& port) const noexcept {
    return view(call_->host->unit(call_->context, port.live()));
  }

 private:
  static std::string_view view(chimera_text text) noexcept { return {text.at, text.size}; }

  const chimera_call* call_;
};

/// How a method ended. Made by ok(), fault(), aborted(), partial(), no_event(), not_yet().
class [[nodiscard]] Outcome {
 public:
  std::int32_t status() const noexcept { return status_; }
  std::int32_t code() const noexcept { return code_; }
  std::string_view text() const noexcept { return {text_}; }

 private:
  // Only the first byte of the text is set where there is none: a cycle that went well pays nothing for it.
  explicit Outcome(std::int32_t status) noexcept : status_(status), code_(0) { text_[0] = '\0'; }
  friend Outcome ok() noexcept;
  friend Outcome fault(std::string_view text, std::int32_t code) noexcept;
  friend Outcome aborted() noexcept;
  friend Outcome partial() noexcept;
  friend Outcome no_event() noexcept;
  friend Outcome not_yet() noexcept;

  std::int32_t status_;
  std::int32_t code_;
  char text_[CHIMERA_FAULT_TEXT];  // NOLINT: set above
};

/// Done; error(): recovered; clear(): the cause is gone; sync(): one event taken. Context: any; wait-free.
inline Outcome ok() noexcept { return Outcome(CHIMERA_OK); }

/// Failed: the task's error() is called and `text`, at most 159 bytes of it, is shown with `code`.
/// error(): not recovered; clear(): the cause is still there. Context: any; wait-free.
inline Outcome fault(std::string_view text, std::int32_t code = 0) noexcept {
  Outcome made(CHIMERA_FAULT);
  made.code_ = code;
  const std::size_t size = text.size() < CHIMERA_FAULT_TEXT ? text.size() : CHIMERA_FAULT_TEXT - 1;
  for (std::size_t i = 0; i < size; ++i) made.text_[i] = text[i];
  made.text_[size] = '\0';
  return made;
}

/// cycle() only: gave up in time; nothing of this cycle is published. Context: cycle; wait-free.
inline Outcome aborted() noexcept { return Outcome(CHIMERA_ABORTED); }

/// cycle() only: gave up in time with a result of use: what it has put out is published, past the deadline too.
/// Context: cycle; wait-free.
inline Outcome partial() noexcept { return Outcome(CHIMERA_PARTIAL); }

/// sync() only: nothing is pending, no cycle follows. Context: cycle; wait-free.
inline Outcome no_event() noexcept { return Outcome(CHIMERA_NO_EVENT); }

/// on() only: the device has been told and is on its way, such as a drive that changes its mode of operation. The task
/// stays OFF and on() is asked again, for as long as whoever turns it ON waits. Context: edge; wait-free.
inline Outcome not_yet() noexcept { return Outcome(CHIMERA_NOT_YET); }

}  // namespace chimera
