// SPDX-License-Identifier: Apache-2.0
// A test bench for one component: sets its inputs, calls its methods with stepped time, shows its outputs. Only for
// tests of components; it has no states, deadlines or other tasks.
//
//   Rig rig("tderiv");                    // a component linked into this test, C++ or C
//   rig.set("x", 1.0);
//   EXPECT_TRUE(rig.init()); EXPECT_TRUE(rig.on());
//   rig.set("x", 1.5);
//   EXPECT_TRUE(rig.cycle(milliseconds(100)));
//   EXPECT_DOUBLE_EQ(rig.get<double>("dx"), 5.0);
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "chimera/base/fixed.h"
#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/rig_ports.h"
#include "chimera/task/rig_safe_frames.h"
#include "chimera/task/signal.h"
#include "chimera/task/text.h"

namespace chimera {

/// The result of a method: true for CHIMERA_OK.
struct RigAnswer {
  std::int32_t status = CHIMERA_OK;
  std::int32_t code = 0;
  std::string text;

  explicit operator bool() const noexcept { return status == CHIMERA_OK; }
};

/// One component under test. RigPorts sets and reads its ports; RigSafeFrames shows its safe frames. Context: setup.
class Rig : public RigPorts, public RigSafeFrames {
 public:
  /// Finds the component of that name in this program and constructs it; throws if its constructor fails.
  explicit Rig(const char* component) : RigPorts(component, &call_.now_ns) {
    call_.host = &kHost;
    call_.context = this;
    call_.deadline_ns = kNever.count;
  }

  RigAnswer init() { return run(Method::kInit); }
  RigAnswer reinit() { return run(Method::kReinit); }
  RigAnswer on() { return run(Method::kOn); }
  /// Steps time by `dt`, then calls sync(): CHIMERA_NO_EVENT if it found none.
  RigAnswer sync(Nanoseconds dt = milliseconds(1)) {
    call_.now_ns += dt.count;
    return run(Method::kSync);
  }
  /// Steps time by `dt`, then calls cycle().
  RigAnswer cycle(Nanoseconds dt = milliseconds(1)) {
    call_.now_ns += dt.count;
    call_.dt_ns = dt.count;
    RigAnswer answer = run(Method::kCycle);
    if (answer) ++call_.cycle;
    see_all();
    return answer;
  }
  /// Only calls cycle() `n` times in steps of `dt`, for measurements; returns the last status.
  std::int32_t repeat(std::uint64_t n, Nanoseconds dt) {
    chimera_fault fault{};
    call_.fault = &fault;
    call_.dt_ns = dt.count;
    std::int32_t status = CHIMERA_OK;
    const chimera_method function = component().methods[CHIMERA_CYCLE];
    for (; n > 0; --n) {
      call_.now_ns += dt.count;
      status = function(state(), &call_);
    }
    call_.fault = nullptr;
    return status;
  }
  RigAnswer off() { return run(Method::kOff); }
  RigAnswer kill() { return run(Method::kKill); }
  RigAnswer error() { return run(Method::kError); }
  RigAnswer clear() { return run(Method::kClear); }
  /// Calls background(), as a thread without real-time rights would; true if the component has none.
  RigAnswer background() {
    if (component().background == nullptr) return {};
    chimera_fault fault{};
    const std::int32_t status = component().background(state(), &fault);
    return {status, fault.code, fault.text};
  }

  /// The descriptor of its events; below 0: none.
  int event_source() {
    return component().event_source == nullptr ? -1 : static_cast<int>(component().event_source(state()));
  }

  /// Sets the answers of Cycle::expired(), illegal() and dropped() from now on.
  void expire(bool is_expired) { expired_ = is_expired; }
  void illegal(bool is_illegal) { call_.illegal = is_illegal ? 1 : 0; }
  void dropped(std::uint32_t count) { call_.dropped = count; }
  /// Execution time used through Cycle::spend() so far.
  Nanoseconds spent() const { return spent_; }
  /// The signals sent so far, as "off pid"; to itself "off". Requests appear as "request figure_9".
  const std::vector<std::string>& signals() const { return signals_; }
  /// The first 16 notes.
  std::vector<std::string> notes() const {
    std::vector<std::string> texts;
    for (const FixedString<CHIMERA_FAULT_TEXT>& note : notes_) texts.emplace_back(note.view());
    return texts;
  }

 private:
  RigAnswer run(Method method) {
    const chimera_method function = component().methods[static_cast<std::uint32_t>(method)];
    chimera_fault fault{};
    call_.fault = &fault;
    const std::int32_t status = function == nullptr ? CHIMERA_OK : function(state(), &call_);
    call_.fault = nullptr;
    if (method == Method::kInit || method == Method::kReinit) fix_extents();
    if ((method == Method::kOff || method == Method::kKill) && status == CHIMERA_OK) take_back();
    return {status, fault.code, fault.text};
  }

  static std::int32_t host_expired(void* rig) { return static_cast<Rig*>(rig)->expired_ ? 1 : 0; }
  static std::int32_t host_signal(void* rig, std::uint32_t signal, const char* task) {
    std::string text = signal_name(static_cast<Signal>(signal));
    if (task != nullptr) text = text + " " + task;
    static_cast<Rig*>(rig)->signals_.push_back(text);
    return CHIMERA_OK;
  }
  static void host_spend(void* rig, std::int64_t ns) { static_cast<Rig*>(rig)->spent_ += Nanoseconds{ns}; }
  static void host_note(void* rig, const char* text) { (void)static_cast<Rig*>(rig)->notes_.try_push({text}); }
  static chimera_text host_variable(void* rig, const chimera_port* port) {
    return text_of(static_cast<Rig*>(rig)->joined(port).variable);
  }
  static chimera_text host_unit(void* rig, const chimera_port* port) {
    return text_of(static_cast<Rig*>(rig)->joined(port).unit);
  }
  static std::int32_t host_request(void* rig, const char* configuration) {
    static_cast<Rig*>(rig)->signals_.push_back(std::string("request ") + configuration);
    return CHIMERA_OK;
  }
  static chimera_text text_of(const std::string& text) {
    return {text.data(), static_cast<std::uint32_t>(text.size())};
  }
  static constexpr chimera_host kHost{&host_expired, &host_signal,  &host_spend,           &host_note,
                                      &host_variable, &host_unit,    &host_request,         &host_safe_frame<Rig>,
                                      &host_safe_bytes<Rig>, &host_configuration<Rig>, &host_incarnation<Rig>};

  chimera_call call_{};
  std::vector<std::string> signals_;
  FixedVector<FixedString<CHIMERA_FAULT_TEXT>, 16> notes_;  // fixed size, so that a cycle with a note allocates nothing
  Nanoseconds spent_;
  bool expired_ = false;
};

}  // namespace chimera
