// SPDX-License-Identifier: Apache-2.0
// For tests: the keeper's end of the channel, played by the test, and rtpus played by threads.
#pragma once

#include <fcntl.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "chimera/base/testing/await.h"
#include "chimera/manager/manager_loop.h"
#include "chimera/manager/testing/fake_rtpu.h"
#include "chimera/manager/testing/test_bundle.h"

namespace chimera::manager {

inline PortDescriptor test_port(const std::string& name, std::uint32_t kind, const std::string& unit = "1",
                                const std::string& shape = "") {
  PortDescriptor port;
  port.name = name;
  port.kind = kind;
  port.unit = unit;
  port.shape = shape;
  return port;
}

inline Descriptor test_component(const std::string& name, std::vector<PortDescriptor> ports) {
  Descriptor d;
  d.name = name;
  d.doc = "For tests.";
  d.default_rate_hz = 1000;
  d.state_size = 64;
  d.methods[CHIMERA_CYCLE] = true;
  d.ports = std::move(ports);
  EXPECT_TRUE(complete(d)) << complete(d).error().message.c_str();
  return d;
}

/// Slow, so that no value is stale on a busy machine. Two rtpus: sensor and filter on `servo`, law on `spare`; the
/// operator sets kp. x of the sensor has two elements.
inline constexpr const char* kFakeText = R"(subsystem: fake
rtpus: {servo: {cpu: 0, policy: edf}, spare: {cpu: 1, policy: muf}}
tasks:
  sensor: {rtpu: servo, rate: 10 Hz}
  filter: {rtpu: servo, rate: 10 Hz}
  law:    {rtpu: spare, rate: 10 Hz}
operator: {kp: [1 N.m/rad, 2 N.m/rad]}
configurations: {run: [sensor, filter, law], rest: [sensor]}
start: run
)";

/// kFakeText with a task behind a server in `servo`.
inline constexpr const char* kServedText = R"(subsystem: fake
rtpus: {servo: {cpu: 0, policy: edf, executor: preemptive}, spare: {cpu: 1, policy: muf}}
tasks:
  sensor: {rtpu: servo, rate: 10 Hz}
  lamp:   {rtpu: servo, server: {kind: deferrable, capacity: 2 ms, period: 10 ms}}
configurations: {run: [sensor, lamp]}
start: run
)";

/// Hardware of each kind: arm reports that it is safe, winch cannot report it, log never moves.
inline constexpr const char* kHardwareText = R"(subsystem: fake
rtpus: {servo: {cpu: 0, policy: edf}, spare: {cpu: 1, policy: muf}}
tasks:
  arm:   {rtpu: servo, rate: 10 Hz, resources: {device: a}}
  winch: {rtpu: spare, rate: 10 Hz, resources: {device: b}}
  log:   {rtpu: spare, rate: 10 Hz, resources: {file: c}}
configurations: {run: [arm, log], all: [arm, winch, log], none: [log]}
start: run
)";

/// A resource, or an out-var of bool, that is declared `safe_state` or not.
inline PortDescriptor device_port(const std::string& name, std::uint32_t kind, bool safe_state) {
  PortDescriptor port = test_port(name, kind);
  port.type = kind == CHIMERA_RESOURCE ? CHIMERA_STRING : CHIMERA_BOOL;
  port.element_size = kind == CHIMERA_RESOURCE ? 256 : 1;
  port.safe_state = safe_state;
  return port;
}

inline Bundle fake_bundle(const std::string& text = kFakeText) {
  Descriptor lamp = test_component("lamp", {test_port("lit", CHIMERA_OUT_VAR)});
  lamp.methods[CHIMERA_SYNC] = true;
  PortDescriptor kp = test_port("kp", CHIMERA_IN_VAR, "N.m/rad", "[2]"), angle = test_port("y", CHIMERA_IN_VAR, "rad");
  kp.has_range = true;
  kp.max = 5000;
  angle.frame = "base";
  Library library = Library::of(
      {test_component("sensor", {test_port("x", CHIMERA_OUT_VAR, "rad", "[2]")}),
       test_component("filter", {test_port("x", CHIMERA_IN_VAR, "rad", "[2]"), test_port("y", CHIMERA_OUT_VAR, "rad")}),
       test_component("law", {angle, kp, test_port("tau", CHIMERA_OUT_VAR, "N.m")}),
       lamp,
       test_component("arm", {test_port("q", CHIMERA_OUT_VAR, "rad"), device_port("held", CHIMERA_OUT_VAR, true),
                              device_port("device", CHIMERA_RESOURCE, false)}),
       test_component("winch", {test_port("rope", CHIMERA_OUT_VAR, "m"), device_port("full", CHIMERA_OUT_VAR, false),
                                device_port("device", CHIMERA_RESOURCE, false)}),
       test_component("log", {test_port("rows", CHIMERA_OUT_VAR), device_port("file", CHIMERA_RESOURCE, true)})},
      our_units());
  return {"0.1.0", text.empty() ? "" : "fake.yaml", text, {}, {}, {}, std::move(library)};
}

/// All processes and memory outside the manager.
class FakeSubsystem {
 public:
  explicit FakeSubsystem(const std::string& text = kFakeText) : bundle_(fake_bundle(text)) {
    EXPECT_NE(::mkdtemp(state_), nullptr);
    ::setenv("XDG_STATE_HOME", state_, 1);
    if (!bundle_.is_idle()) {
      const Verdict verdict = verify(bundle_);
      EXPECT_TRUE(verdict.configuration) << verdict.report.text();
      configuration_ = verdict.configuration;
      spec_ = configuration_->spec();
    } else {
      spec_.name = "idle";
    }
    const std::vector<ComponentPlace> places(spec_.tasks.size());
    image_ = *FrozenBytes::create("image", encode(spec_, places, RunSettings{}));
    const std::string packed = encode(bundle_);
    frozen_bundle_ = *FrozenBytes::create("bundle", std::as_bytes(std::span(packed)));
    decision_ = *SharedPages::create("decision", sizeof(DecisionPage));
    new (decision_.bytes().data()) DecisionPage;
    keeper_ = *MemoryRegion::create("keeper", sizeof(KeeperPage));
    auto* page = new (keeper_.writable().data()) KeeperPage;
    page->origin = now();
    page->n_rtpus = n_rtpus();
    for (std::uint32_t r = 0; r < n_rtpus(); ++r) revive(r);
  }
  ~FakeSubsystem() {
    loop_.reset();
    rtpus_.clear();
    std::error_code error;  // a manager that was left behind may still file
    std::filesystem::remove_all(state_, error);
  }

  const ApplicationSpec& spec() const noexcept { return spec_; }
  /// XDG_STATE_HOME of its managers.
  std::string state() const { return state_; }
  std::uint32_t n_rtpus() const noexcept { return static_cast<std::uint32_t>(spec_.rtpus.size()); }
  FakeRtpu& rtpu(std::uint32_t index) { return *rtpus_[index]; }
  KeeperPage& page() { return *reinterpret_cast<KeeperPage*>(keeper_.writable().data()); }
  DecisionPage& decision_page() { return *reinterpret_cast<DecisionPage*>(decision_.bytes().data()); }
  ManagerLoop& loop() { return *loop_; }
  TaskId task(std::string_view name) const {
    for (std::size_t t = 0; t < spec_.tasks.size(); ++t)
      if (spec_.tasks[t].name == name) return TaskId(t);
    ADD_FAILURE() << "no task " << name;
    return TaskId(std::size_t{0});
  }

  /// Starts a manager in this process; the test steps it.
  void start_manager() {
    const Channel end = introduce_all();
    const Inherited inherited{again(end.descriptor()),       again(image_.descriptor()), again(decision_.descriptor()),
                              again(keeper_.descriptor()), -1, again(frozen_bundle_.descriptor())};
    auto made = ManagerLoop::start(inherited, manager_incarnation_, ::getpid());
    ASSERT_TRUE(made) << made.error().message.c_str();
    loop_ = *std::move(made);
    ASSERT_NE(loop_, nullptr);
    first_event_ = loop_->state().log.first();
  }
  /// Ends the manager as SIGKILL does: it sends no message.
  void kill_manager() {
    loop_.reset();
    channel_ = Channel();
  }
  /// Ends the rtpu as that signal does; the segment stays for its last words.
  void kill_rtpu(std::uint32_t index, int number) {
    rtpus_[index]->die();
    ended_[index] = KeeperMessage{.kind = KeeperMessage::Kind::kEnded,
                                  .index = index,
                                  .incarnation = rtpus_[index]->incarnation(),
                                  .code = number,
                                  .by_signal = 1,
                                  .at = now()};
    EXPECT_TRUE(!channel_.is_open() || channel_.send(bytes_of(*ended_[index])));
  }

  /// One round of ManagerLoop, of the steps after it, and of the keeper.
  bool step() {
    if (!loop_->step(now() + milliseconds(1))) return false;
    if (after_step) after_step();
    keep();
    return true;
  }
  std::function<void()> after_step;
  /// Lets ManagerLoop and the keeper work until `holds`; false after kHangLimit.
  bool until(const std::function<bool()>& holds) {
    for (const Nanoseconds limit = now() + kHangLimit; now() < limit;) {
      if (!step()) return false;
      if (holds()) return true;
    }
    return false;
  }
  bool until_on(std::string_view name) {
    return until([&] { return loop_->state().state(task(name)) == State::kOn; });
  }
  /// The texts of all events of a kind of this manager, with the task's name before it.
  std::string told(const std::string& kind) {
    std::string text;
    const ManagerState& state = loop_->state();
    for (std::uint64_t n = first_event_; n <= state.log.last(); ++n) {
      const LoggedEvent& event = state.log.at(n);
      if (event.kind == kind)
        text += (event.task.is_valid() ? state.name(event.task) + ": " : "") + event.text + "\n";
    }
    return text;
  }
  /// Handles messages as the keeper does.
  void keep() {
    KeeperMessage message;
    int passed = -1;
    while (channel_.receive(bytes_of(message), passed) == Channel::Got::kMessage) {
      if (message.kind == KeeperMessage::Kind::kSegment) {
        if (manager_segment_ >= 0) ::close(manager_segment_);
        manager_segment_ = passed;
        segment_incarnation_ = manager_incarnation_;
        for (auto& [r, rtpu] : rtpus_)
          if (!ended_[r]) rtpu->meet(again(passed), manager_incarnation_);
      } else if (message.kind == KeeperMessage::Kind::kStart && ended_[message.index]) {
        revive(message.index);
        introduce(message.index);
      } else if (message.kind == KeeperMessage::Kind::kEndChild) {
        killed = message.index;
      } else if (message.kind == KeeperMessage::Kind::kEnd) {
        end_asked = message.code;
      }
    }
  }
  std::optional<std::int32_t> end_asked;
  std::optional<std::uint32_t> killed;  ///< the rtpu that the manager asked to kill; the test kills none

 private:
  /// The channel of a new manager, with the whole inventory in it.
  Channel introduce_all() {
    auto ends = Channel::pair();
    EXPECT_TRUE(ends);
    channel_ = std::move(ends->first);
    ++manager_incarnation_;
    for (std::uint32_t r = 0; r < n_rtpus(); ++r) introduce(r);
    if (manager_segment_ >= 0) send(KeeperMessage::Kind::kPeer, n_rtpus(), segment_incarnation_, manager_segment_);
    send(KeeperMessage::Kind::kComplete, 0, 0);
    return std::move(ends->second);
  }
  static int again(int descriptor) { return ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0); }
  void send(KeeperMessage::Kind kind, std::uint32_t index, std::uint32_t incarnation, int passed = -1) {
    const KeeperMessage message{.kind = kind, .index = index, .incarnation = incarnation, .pid = 1000, .at = now()};
    EXPECT_TRUE(channel_.send(bytes_of(message), passed));
  }
  void introduce(std::uint32_t r) {
    if (!ended_[r]) send(KeeperMessage::Kind::kStarted, r, rtpus_[r]->incarnation());
    send(KeeperMessage::Kind::kPeer, r, rtpus_[r]->incarnation(), rtpus_[r]->descriptor());
    EXPECT_TRUE(!ended_[r] || channel_.send(bytes_of(*ended_[r])));
  }
  void revive(std::uint32_t r) {
    ended_[r].reset();
    const std::uint32_t incarnation = rtpus_[r] == nullptr ? 1 : rtpus_[r]->incarnation() + 1;
    rtpus_[r] = std::make_unique<FakeRtpu>(spec_, r, incarnation, decision_page());
    if (manager_segment_ >= 0) rtpus_[r]->meet(again(manager_segment_), segment_incarnation_);
  }
  char state_[40] = "/tmp/chimera_state_XXXXXX";
  Bundle bundle_;
  std::optional<Configuration> configuration_;
  ApplicationSpec spec_;
  FrozenBytes image_, frozen_bundle_;
  SharedPages decision_;
  MemoryRegion keeper_;
  Channel channel_;
  int manager_segment_ = -1;
  std::uint32_t manager_incarnation_ = 0, segment_incarnation_ = 0;
  std::map<std::uint32_t, std::unique_ptr<FakeRtpu>> rtpus_;
  std::map<std::uint32_t, std::optional<KeeperMessage>> ended_;
  std::unique_ptr<ManagerLoop> loop_;
  std::uint64_t first_event_ = 1;  // of this manager; those before may be read from the disk at any time
};

}  // namespace chimera::manager
