// SPDX-License-Identifier: Apache-2.0
// The argument of a method (Cycle) and its result (Outcome).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/signal.h"

namespace chimera {

/// The present call, as a component sees it. Valid until the method returns; do not keep it.
class Cycle {
 public:
  explicit Cycle(const chimera_call& call) noexcept : call_(&call) {}

  /// Seconds since the release of the last completed cycle; the period after on(). Context: cycle; wait-free.
  double dt() const noexcept { return to_seconds(step()); }
  /// The time since the release of the last completed cycle; the period after on(). Context: cycle; wait-free.
  Nanoseconds step() const noexcept { return {call_->dt_ns}; }
  /// The release of this job; outside cycles the time of the call. Context: any; wait-free.
  Nanoseconds now() const noexcept { return {call_->now_ns}; }
  /// The instant by which this job must be done. Context: cycle; wait-free.
  Nanoseconds deadline() const noexcept { return {call_->deadline_ns}; }
  /// Completed cycles since on(). Context: any; wait-free.
  std::uint64_t count() const noexcept { return call_->cycle; }
  /// Releases that were dropped since the last completed cycle. Context: cycle; wait-free.
  std::uint32_t dropped() const noexcept { return call_->dropped; }
  /// True if the job is past its deadline or must give up: return aborted() or partial(). Context: cycle; wait-free.
  bool expired() const noexcept { return call_->host->expired(call_->context) != 0; }
  /// The illegal-configuration flag, read once for this job. If it is up, inputs may be meaningless: hold a stable
  /// state. Context: cycle; wait-free.
  bool illegal() const noexcept { return call_->illegal != 0; }
  /// Sends `signal` to the task of that name; without a name, to the own task. The signal acts at a cycle boundary,
  /// after this method. Signal::kWakeup is an event for a task with a doorbell; one job answers each. False if the
  /// task does not exist, if it has no doorbell (kWakeup), or if the outbox is full. Context: cycle; wait-free.
  bool signal(Signal signal, const char* task = nullptr) const noexcept {
    return call_->host->signal(call_->context, static_cast<std::uint32_t>(signal), task) == CHIMERA_OK;
  }
  /// Uses `time` of execution time: computes in real time; in virtual time, adds it to the modelled time. Context:
  /// cycle; takes `time`.
  void spend(Nanoseconds time) const noexcept { call_->host->spend(call_->context, time.count); }
  /// Shows the user one line, at most 159 bytes of `text`, as an event and in the output of the run. If a method leaves
  /// several, the last one counts. Context: any; wait-free.
  void note(const char* text) const noexcept { call_->host->note(call_->context, text); }
  /// Requests a switch (docs/howto/reconfigure.md). `configuration` names a configuration, so that exactly its tasks
  /// are ON; or it is "--on A --off B": A goes ON, B goes OFF, and tasks that produce the same variables as A go OFF.
  /// The last waiting request of all tasks counts. A request for the present or the coming configuration has no
  /// effect. False if the name is unknown, or if the run cannot switch; one note gives the reason. Context: cycle;
  /// wait-free.
  bool request(const char* configuration) const noexcept {
    return call_->host->request(call_->context, configuration) == CHIMERA_OK;
  }
  /// Registers safe frame `index` (0 to 3): another process writes it to a copy of `descriptor` if this process dies. A
  /// `descriptor` below 0 removes the frame. Before the write, waiting output in the queue of a terminal is dropped,
  /// and the line rests for `pause`. Call it in init, and in clear if clear opens the device again. False if no process
  /// would write it, because the run is one process or virtual. Context: setup; may block.
  bool safe_frame(std::uint32_t index, int descriptor, Nanoseconds pause = {}) const noexcept {
    return call_->host->safe_frame(call_->context, index, descriptor, pause.count) == CHIMERA_OK;
  }
  /// Sets the bytes of safe frame `index`, at most 256. Call it from on onwards, and whenever the bytes change. They
  /// stay until the next call. Zero bytes remove the frame; a successful off or kill also removes it. Context: any;
  /// wait-free.
  bool safe_bytes(std::uint32_t index, const void* bytes, std::size_t size) const noexcept {
    return call_->host->safe_bytes(call_->context, index, bytes, static_cast<std::uint32_t>(size)) == CHIMERA_OK;
  }
  /// The name of the configuration in force; empty if none is: a task is OFF or in ERROR, or stands in for no other.
  /// A slow switch changes it at its end. Valid as long as the task. Context: cycle; wait-free.
  std::string_view configuration() const noexcept { return view(call_->host->configuration(call_->context)); }
  /// Starts of the process that runs the task: 1, and one more after each of its deaths. In virtual time and in one
  /// process it is 1. Context: any; wait-free.
  std::uint32_t incarnation() const noexcept { return call_->host->incarnation(call_->context); }
  /// The variable or constant that `port` is linked to; empty: none. Valid as long as the task. Context: any;
  /// wait-free.
  template <class Port>
  std::string_view variable(const Port& port) const noexcept {
    return view(call_->host->variable(call_->context, port.live()));
  }
  /// The verified unit of the values: "rad"; "1" for none, empty for a resource. Context: any; wait-free.
  template <class Port>
  std::string_view unit(const Port& port) const noexcept {
    return view(call_->host->unit(call_->context, port.live()));
  }

 private:
  static std::string_view view(chimera_text text) noexcept { return {text.at, text.size}; }

  const chimera_call* call_;
};

/// The result of a method. ok(), fault(), aborted(), partial(), no_event() and not_yet() make it.
class [[nodiscard]] Outcome {
 public:
  std::int32_t status() const noexcept { return status_; }
  std::int32_t code() const noexcept { return code_; }
  std::string_view text() const noexcept { return {text_}; }

 private:
  // Sets only the first byte of the text, so that a successful cycle does not pay for the text.
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

/// Success; error(): recovered; clear(): the cause is gone; sync(): one event taken. Context: any; wait-free.
inline Outcome ok() noexcept { return Outcome(CHIMERA_OK); }

/// Failure: the framework calls error() of the task and shows at most 159 bytes of `text` with `code`. error(): not
/// recovered; clear(): the cause is still there. Context: any; wait-free.
inline Outcome fault(std::string_view text, std::int32_t code = 0) noexcept {
  Outcome made(CHIMERA_FAULT);
  made.code_ = code;
  const std::size_t size = text.size() < CHIMERA_FAULT_TEXT ? text.size() : CHIMERA_FAULT_TEXT - 1;
  for (std::size_t i = 0; i < size; ++i) made.text_[i] = text[i];
  made.text_[size] = '\0';
  return made;
}

/// cycle() only: gave up before the deadline, and publishes nothing. Context: cycle; wait-free.
inline Outcome aborted() noexcept { return Outcome(CHIMERA_ABORTED); }

/// cycle() only: gave up in time with a useful result. Its outputs are published, even past the deadline. Context:
/// cycle; wait-free.
inline Outcome partial() noexcept { return Outcome(CHIMERA_PARTIAL); }

/// sync() only: no event is pending, and no cycle follows. Context: cycle; wait-free.
inline Outcome no_event() noexcept { return Outcome(CHIMERA_NO_EVENT); }

/// on() only: the device received its command and is on its way, such as a drive that changes its mode. The task stays
/// OFF. The framework calls on() again as long as the request to turn the task ON waits. Context: cycle boundary;
/// wait-free.
inline Outcome not_yet() noexcept { return Outcome(CHIMERA_NOT_YET); }

}  // namespace chimera
