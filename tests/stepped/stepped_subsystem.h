// SPDX-License-Identifier: Apache-2.0
// For tests: a subsystem in one process on one stepped clock. The manager (ManagerLoop, ManagerBackend) and the rtpus
// (RtpuControl, PeerLinks, SwitchLinks, Executive) are the real ones; the test is the keeper and the clients.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "chimera/load/shared_object.h"
#include "chimera/manager/manager_backend.h"
#include "chimera/manager/testing/test_bundle.h"
#include "chimera/platform/descriptor.h"
#include "chimera/rtpu/testing/test_rtpus.h"
#include "chimera/runtime/task_word.h"

namespace chimera::manager {

/// `text` with the first `what` replaced; `what` must occur.
inline std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, text.npos) << what;
  return at == text.npos ? text : text.replace(at, what.size(), with);
}

/// The manager reads the clock that this object holds, until the object is destroyed.
class SteppedClock {
 public:
  explicit SteppedClock(Nanoseconds start) : clock_(start) { use_clock(&clock_); }
  ~SteppedClock() { use_clock(nullptr); }
  SteppedClock(const SteppedClock&) = delete;
  void advance(Nanoseconds time) noexcept { clock_.advance(time); }

 private:
  VirtualClock clock_;
};

/// The answer to a call, once it is there.
using PendingAnswer = std::shared_ptr<std::optional<control::RpcResponse>>;

class SteppedSubsystem {
 public:
  /// The description is verified with the components of the build tree. Its rtpus are executives.
  explicit SteppedSubsystem(const std::string& description) : bundle_(with_library(description)) {
    EXPECT_NE(::mkdtemp(state_), nullptr);
    ::setenv("XDG_STATE_HOME", state_, 1);
    const Verdict verdict = verify(bundle_);
    EXPECT_TRUE(verdict.configuration) << verdict.report.text();
    configuration_ = verdict.configuration;
    for (const TaskSpec& task : spec().tasks) components_.push_back(component_of(task));
    image_ = *FrozenBytes::create("image", encode(spec(), std::vector<ComponentPlace>(spec().tasks.size()), {}));
    const std::string packed = encode(bundle_);
    frozen_bundle_ = *FrozenBytes::create("bundle", std::as_bytes(std::span(packed)));
    decision_ = *SharedPages::create("decision", sizeof(DecisionPage));
    new (decision_.bytes().data()) DecisionPage;
    keeper_ = *MemoryRegion::create("keeper", sizeof(KeeperPage));
    new (keeper_.writable().data()) KeeperPage;
    page().origin = now();
    page().n_rtpus = n_rtpus();
    rtpus_.resize(n_rtpus());
    for (std::uint32_t r = 0; r < n_rtpus(); ++r) start_rtpu(r);
    start_manager();
  }
  SteppedSubsystem(const SteppedSubsystem&) = delete;
  ~SteppedSubsystem() {
    kill_manager();
    rtpus_.clear();
    std::error_code error;
    std::filesystem::remove_all(state_, error);
  }

  /// Lets `time` pass in steps of 100 us; in each step every rtpu, then the manager, then the keeper works.
  void run(Nanoseconds time) {
    for (const Nanoseconds end = now() + time; now() < end;) step();
  }
  /// Runs until `holds`, which is asked every millisecond, at most `limit`. False if the limit is reached.
  bool until(const std::function<bool()>& holds, Nanoseconds limit = seconds(10)) {
    for (const Nanoseconds end = now() + limit; !holds(); run(milliseconds(1)))
      if (now() >= end) return false;
    return true;
  }
  bool until_on(std::string_view name) {
    return until([&] { return state(name) == State::kOn; });
  }
  /// Until everything of the start set is ON and the manager has said so.
  bool until_started() {
    return until([&] { return manager_ && manager().state().own.block().memory().started_at != 0; });
  }

  /// Asks as a client with the right to configure would; the answer comes while time passes.
  PendingAnswer ask(const std::string& method, const Json& parameters = Json::object()) {
    auto answer = std::make_shared<std::optional<control::RpcResponse>>();
    const control::MethodRule* rule = control::find_method(method);
    EXPECT_NE(rule, nullptr) << method;
    const control::RpcResponse judged = control::check_parameters(*rule, parameters);
    if (!judged.is_good()) *answer = judged;
    else backend_->call(*rule, parameters, {control::Role::kConfigure, 1, 0},
                        [answer](const control::RpcResponse& got) { *answer = got; });
    return answer;
  }
  /// Asks and runs until the answer is there.
  control::RpcResponse call(const std::string& method,
                            const Json& parameters = Json::object()) {
    const PendingAnswer answer = ask(method, parameters);
    EXPECT_TRUE(until([&] { return answer->has_value(); }, seconds(30))) << method << " was not answered";
    return answer->value_or(control::RpcResponse::error(control::kNoAnswer, "no answer"));
  }
  /// The result of a call that must not be refused.
  Json result(const std::string& method, const Json& parameters = Json::object()) {
    const control::RpcResponse answer = call(method, parameters);
    EXPECT_TRUE(answer.is_good()) << method << ": " << answer.message;
    return result_of(answer);
  }
  static Json result_of(const control::RpcResponse& answer) {
    std::string text = answer.text ? *answer.text : "";
    if (answer.pieces)
      while (answer.pieces->append_to(text)) {
      }
    if (!text.empty()) return Json::parse(text);
    return answer.result ? *answer.result : Json();
  }

  /// The process of the rtpu dies by that signal. The manager has it started again.
  void die(std::string_view rtpu, int signal = SIGKILL) { die(index(rtpu), signal); }
  /// Ends the process of the rtpu alone, as a plain SIGTERM does (Rtpu::end): it turns its tasks OFF, and 1 ms later it
  /// is dead.
  void terminate(std::string_view rtpu) {
    rtpus_[index(rtpu)]->edge->rtpu_end().tell(true);
    Doorbell(decision_page().bells[index(rtpu)].word).ring();
  }
  /// While it hangs, no `init` or `kill` of the rtpu returns; not beyond a restart.
  void hang_service(std::string_view rtpu, bool hangs = true) {
    if (hangs) hung_.insert(index(rtpu));
    else hung_.erase(index(rtpu));
  }
  /// From here on the cycling thread of the rtpu does nothing; its main thread goes on, until it is restarted.
  void end_loop(std::string_view rtpu) { without_loop_.insert(index(rtpu)); }
  /// While it is stopped, as by SIGSTOP, the rtpu does nothing.
  void stop(std::string_view rtpu, bool is_stopped) {
    if (is_stopped) stopped_.insert(index(rtpu));
    else stopped_.erase(index(rtpu));
  }
  /// As by SIGKILL. start_manager() starts its successor.
  void kill_manager() {
    backend_.reset();
    manager_.reset();
    channel_ = Channel();
    if (manager_segment_.fd >= 0) page().alive[n_rtpus()] = 0;
  }
  void start_manager() {
    auto ends = Channel::pair();
    ASSERT_TRUE(ends);
    channel_ = std::move(ends->first);
    ++manager_incarnation_;
    for (std::uint32_t r = 0; r < n_rtpus(); ++r) introduce(r);
    if (manager_segment_.fd >= 0)
      tell(KeeperMessage::Kind::kPeer, n_rtpus(), manager_incarnation_ - 1, manager_segment_.fd);
    tell(KeeperMessage::Kind::kComplete, 0, 0);
    const Inherited inherited{again(ends->second.descriptor()), again(image_.descriptor()),
                              again(decision_.descriptor()),    again(keeper_.descriptor()),
                              -1,                               again(frozen_bundle_.descriptor())};
    auto made = ManagerLoop::start(inherited, manager_incarnation_, ::getpid());
    ASSERT_TRUE(made) << made.error().message.c_str();
    manager_ = *std::move(made);
    backend_ = std::make_unique<ManagerBackend>(*manager_);
    first_event_ = manager_->state().log.first();
    for (const Filing* filing : manager_->filings()) {
      const int readers[] = {filing->descriptor()};
      await_readable(readers, seconds(60));  // the thread that reads the file of before is not stepped
    }
    keep();
  }
  /// While it is stopped the keeper starts nothing.
  void stop_keeper(bool is_stopped) {
    keeper_is_stopped_ = is_stopped;
    if (!is_stopped) keep();
  }

  const ApplicationSpec& spec() const { return configuration_->spec(); }
  std::uint32_t n_rtpus() const { return static_cast<std::uint32_t>(spec().rtpus.size()); }
  bool has_manager() const { return manager_ != nullptr; }
  ManagerLoop& manager() { return *manager_; }
  testing::TestRtpu& rtpu(std::string_view name) { return *rtpus_[index(name)]; }
  KeeperPage& page() { return *reinterpret_cast<KeeperPage*>(keeper_.writable().data()); }
  DecisionPage& decision_page() { return *reinterpret_cast<DecisionPage*>(decision_.bytes().data()); }
  TaskId task(std::string_view name) const {
    for (std::size_t t = 0; t < spec().tasks.size(); ++t)
      if (spec().tasks[t].name == name) return TaskId(t);
    ADD_FAILURE() << "no task " << name;
    return TaskId(std::size_t{0});
  }
  const Profile& profile(std::string_view task) {
    const TaskId id = this->task(task);
    return rtpus_[spec().tasks[id.index].rtpu.index]->tasks->tasks()[id.index].profile;
  }
  /// As the manager shows it.
  State state(std::string_view name) { return manager_ ? manager_->state().state(task(name)) : State::kNotCreated; }
  /// The names of the tasks that are ON, in the order of the description, a blank after each.
  std::string on() {
    std::string names;
    for (const TaskSpec& task : spec().tasks)
      if (state(task.name) == State::kOn) names += std::string(task.name) + " ";
    return names;
  }
  /// The value of a variable of one number, as `get` answers it.
  double value(const std::string& variable) {
    const Json values = result("get", {{"variables", Json::array({variable})}})["values"];
    return values[variable]["value"].as_double();
  }
  void set(const std::string& variable, double value) { (void)result("set", {{"values", {{variable, value}}}}); }
  Json receipts() { return result("receipts")["receipts"]; }
  Json status() { return result("status"); }
  /// Is the illegal-configuration flag up?
  bool flag() { return status()["flag"]["up"].as_bool(); }
  /// The receipt of a switch that must be carried out or aborted, not refused.
  Json switch_to(const std::string& configuration) { return result("switch", {{"configuration", configuration}}); }
  /// The message of a refused call; "" if it is not refused.
  std::string refusal(const std::string& method, const Json& parameters) { return call(method, parameters).message; }
  std::string signal(const std::string& word, const std::string& task) {
    return refusal("signal", {{"signal", word}, {"tasks", Json::array({task})}});
  }
  /// "to end" of each receipt, a line each.
  std::string ends() {
    std::string text;
    for (const Json& one : receipts())
      text += one["to"].as_string() + " " + one["end"].as_string() + "\n";
    return text;
  }
  /// The texts of all events of a kind of this manager, a line each, with the name of the task first if there is one.
  std::string events(std::string_view kind) {
    std::string text;
    const ManagerState& state = manager_->state();
    for (std::uint64_t n = first_event_; n <= state.log.last(); ++n) {
      const LoggedEvent& event = state.log.at(n);
      if (event.kind != kind) continue;
      text += (event.task.is_valid() ? state.name(event.task) + ": " : "") + event.text + "\n";
    }
    return text;
  }
  std::optional<std::int32_t> end_asked;  ///< the exit code with which the manager asked the keeper to end everything

 private:
  /// With the components that the description names: a manager reads the whole bundle at each start.
  static Bundle with_library(const std::string& description) {
    static const Library all = test_library();
    std::vector<LibraryEntry> named;
    for (const LibraryEntry& entry : all.entries())
      if (description.find("component: " + entry.descriptor.name) != description.npos) named.push_back(entry);
    return {"0.1.0", "test.yaml", description, {}, {}, {}, Library::of_entries(std::move(named), all.units())};
  }
  /// Objects stay open for all tests of the process: what a component keeps in static variables is shared.
  const chimera_component* component_of(const TaskSpec& task) {
    static std::map<std::string, const chimera_component*> opened;
    const std::string name(task.component);
    if (const auto found = opened.find(name); found != opened.end()) return found->second;
    const auto object = SharedObject::open(bundle_.library.find(name)->object_file);
    EXPECT_TRUE(object) << object.error().message.c_str();
    return opened[name] = *object->component(name);
  }
  static int again(int descriptor) { return ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0); }
  std::uint32_t index(std::string_view rtpu) const {
    for (std::uint32_t r = 0; r < n_rtpus(); ++r)
      if (spec().rtpus[r].name == rtpu) return r;
    ADD_FAILURE() << "no rtpu " << rtpu;
    return 0;
  }

  void step() {
    clock_.advance(microseconds(100));
    for (std::uint32_t r = 0; r < n_rtpus(); ++r)
      if (page().alive[r] != 0 && !stopped_.contains(r)) step(r);
    if (!keeper_is_stopped_) page().beats.fetch_add(1);
    if (manager_ == nullptr) return;
    if (!manager_->step(now())) return kill_manager();
    Filing& receipts = manager_->receipts().filing();
    if (!receipts.unfiled().empty()) receipts.flush(milliseconds(800));  // the thread that files is not stepped
    if (!keeper_is_stopped_) keep();
  }
  void step(std::uint32_t r) {
    testing::TestRtpu& rtpu = *rtpus_[r];
    rtpu.segment.block.head().attended.fetch_add(1);
    if (without_loop_.contains(r)) return;
    if (!hung_.contains(r)) rtpu.serve();
    else if (!rtpu.service.asked.empty())
      rtpu.segment.block.head().serving = TaskWord(rtpu.service.asked[0], Method::kInit).word();
    while (rtpu.executive->run(now() - page().origin) == RunEnd::kTaskStopped) {
      Releases& releases = rtpu.executive->releases();
      rtpu.edge->stop_all(releases.signals(), releases.settlement().stopped_by(), now());
      releases.settlement().forget_stop();
    }
    if (rtpu.edge->rtpu_end().is_over() && ++steps_of_end_[r] >= 10) die(r, SIGTERM);
  }

  void start_rtpu(std::uint32_t r) {
    const std::uint32_t incarnation = ++incarnations_[r];
    testing::TestRtpu::decision_now = now();
    ended_.erase(r);
    steps_of_end_.erase(r);
    for (std::set<std::uint32_t>* one : {&stopped_, &hung_, &without_loop_}) one->erase(r);
    rtpus_[r] = std::make_unique<testing::TestRtpu>(spec(), components_, r, incarnation, decision_page(), page());
    BlockHead& head = rtpus_[r]->segment.block.head();
    std::strcpy(head.grant, "as an ordinary process");
    head.phase = PeerPhase::kServing;
    for (std::uint32_t other = 0; other < n_rtpus(); ++other) {
      if (other == r || rtpus_[other] == nullptr || ended_.contains(other)) continue;
      show(r, other);
      show(other, r);
    }
    if (manager_segment_.fd >= 0) show_manager(r);
  }
  void show(std::uint32_t to, std::uint32_t of) {
    const testing::OwnSegment& segment = rtpus_[of]->segment;
    EXPECT_TRUE(rtpus_[to]->peers->offer(of, incarnations_[of], segment.region.descriptor()));
    Doorbell(decision_page().bells[to].word).ring();
  }
  void show_manager(std::uint32_t to) {
    EXPECT_TRUE(rtpus_[to]->peers->offer(n_rtpus(), manager_incarnation_, manager_segment_.fd));
    Doorbell(decision_page().bells[to].word).ring();
  }
  void die(std::uint32_t r, int signal) {
    rtpus_[r]->end_process();
    page().alive[r] = 0;
    decision_page().changes.fetch_add(1);
    for (std::uint32_t other = 0; other < n_rtpus(); ++other) Doorbell(decision_page().bells[other].word).ring();
    ended_[r] = KeeperMessage{.kind = KeeperMessage::Kind::kEnded,
                              .index = r,
                              .incarnation = incarnations_[r],
                              .code = signal,
                              .by_signal = 1,
                              .at = now()};
    EXPECT_TRUE(!channel_.is_open() || channel_.send(bytes_of(ended_[r])));
  }
  void tell(KeeperMessage::Kind kind, std::uint32_t index, std::uint32_t incarnation, int passed = -1) {
    const KeeperMessage message{
        .kind = kind, .index = index, .incarnation = incarnation, .pid = ::getpid(), .at = now()};
    EXPECT_TRUE(channel_.send(bytes_of(message), passed));
  }
  void introduce(std::uint32_t r) {
    const testing::OwnSegment& segment = rtpus_[r]->segment;
    const std::uint32_t incarnation = incarnations_[r];
    if (!ended_.contains(r)) tell(KeeperMessage::Kind::kStarted, r, incarnation);
    tell(KeeperMessage::Kind::kPeer, r, incarnation, segment.region.descriptor());
    EXPECT_TRUE(!ended_.contains(r) || channel_.send(bytes_of(ended_[r])));
  }
  /// Carries out what the manager asked the keeper for.
  void keep() {
    KeeperMessage message;
    int passed = -1;
    while (channel_.receive(bytes_of(message), passed) == Channel::Got::kMessage) {
      if (message.kind == KeeperMessage::Kind::kSegment) {
        manager_segment_ = OwnedDescriptor(passed);
        page().alive[n_rtpus()] = manager_incarnation_;
        for (std::uint32_t r = 0; r < n_rtpus(); ++r)
          if (!ended_.contains(r)) show_manager(r);
      } else if (message.kind == KeeperMessage::Kind::kStart && ended_.contains(message.index)) {
        start_rtpu(message.index);
        introduce(message.index);
      } else if (message.kind == KeeperMessage::Kind::kEndChild && !ended_.contains(message.index)) {
        die(message.index, SIGKILL);
      } else if (message.kind == KeeperMessage::Kind::kEnd) {
        end_asked = message.code;
      }
    }
  }

  SteppedClock clock_{seconds(1000)};
  char state_[40] = "/tmp/chimera_stepped_XXXXXX";
  Bundle bundle_;
  std::optional<Configuration> configuration_;
  std::vector<const chimera_component*> components_;
  FrozenBytes image_, frozen_bundle_;
  SharedPages decision_;
  MemoryRegion keeper_;
  std::vector<std::unique_ptr<testing::TestRtpu>> rtpus_;
  std::map<std::uint32_t, std::uint32_t> incarnations_;  // by rtpu; its own memory may be overwritten
  std::map<std::uint32_t, KeeperMessage> ended_;  // by rtpu: the message about its death, until it is started again
  std::map<std::uint32_t, int> steps_of_end_;     // by rtpu: since it has ended its tasks
  std::set<std::uint32_t> stopped_, hung_, without_loop_;
  Channel channel_;
  OwnedDescriptor manager_segment_{-1};
  std::uint32_t manager_incarnation_ = 0;
  std::uint64_t first_event_ = 1;  // of this manager
  bool keeper_is_stopped_ = false;
  std::unique_ptr<ManagerLoop> manager_;
  std::unique_ptr<ManagerBackend> backend_;
};

}  // namespace chimera::manager
