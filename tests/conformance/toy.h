// SPDX-License-Identifier: Apache-2.0
// Components made in the test: a task follows its Toy and records every call of a method.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/testing/named_links.h"
#include "chimera/runtime/virtual/virtual_peers.h"
#include "chimera/task/handover.h"

namespace chimera::toy {

/// Arguments of one call of a method.
struct Call {
  std::string task;
  Method method = Method::kInit;
  Nanoseconds now, dt;
  std::uint32_t dropped = 0;
  bool illegal = false;
  double in = 0;
  std::int64_t inherited = -1;  // ns: age of the output at the last `on`; -1: never published
};

/// Script of a task. The task publishes its number of cycles.
struct Toy {
  std::string name;
  std::vector<Call>* calls = nullptr;
  Nanoseconds spend;                              // by cycle
  Nanoseconds spend_at_edges;                     // by each of on, off, reinit and clear
  std::array<std::deque<int>, CHIMERA_METHODS> answers;  // of the next calls; CHIMERA_OK when none is left
  std::deque<std::pair<Signal, std::string>> sends;      // one a cycle; an empty name: none
  std::function<int(const chimera_call&)> during;        // by cycle; its answer when it is not CHIMERA_OK
  int descriptor = -1;                                   // source of its events
  double value = 0;
};

/// The component's state; zeroed by the framework.
struct State {
  chimera_port me;  // in-const: the address of the Toy
  chimera_port out;
  chimera_port in;
};

inline Toy& toy_of(void* state) {
  Toy* toy = nullptr;
  std::memcpy(&toy, static_cast<State*>(state)->me.value, sizeof toy);
  return *toy;
}

template <int kMethod>
std::int32_t method(void* memory, const chimera_call* call) {
  Toy& toy = toy_of(memory);
  State& state = *static_cast<State*>(memory);
  Call seen{toy.name,      static_cast<Method>(kMethod), {call->now_ns}, {call->dt_ns},
            call->dropped, call->illegal != 0,           0,
            -1};
  if (const chimera_inherited* from = chimera_inherited_of(&state.out)) seen.inherited = from->age_ns;
  if (state.in.value != nullptr) std::memcpy(&seen.in, state.in.value, sizeof seen.in);
  if (toy.calls != nullptr) toy.calls->push_back(seen);
  constexpr bool kAtEdge =
      kMethod == CHIMERA_ON || kMethod == CHIMERA_OFF || kMethod == CHIMERA_REINIT || kMethod == CHIMERA_CLEAR;
  if (kAtEdge && toy.spend_at_edges > Nanoseconds{}) call->host->spend(call->context, toy.spend_at_edges.count);
  if (kMethod == CHIMERA_CYCLE) {
    if (toy.spend > Nanoseconds{}) call->host->spend(call->context, toy.spend.count);
    if (toy.during) {
      const int answer = toy.during(*call);
      if (answer != CHIMERA_OK) return answer;
    }
    toy.value += 1;
    if (state.out.value != nullptr) std::memcpy(state.out.value, &toy.value, sizeof toy.value);
    if (!toy.sends.empty()) {
      const auto [signal, target] = toy.sends.front();
      toy.sends.pop_front();
      if (!target.empty()) call->host->signal(call->context, static_cast<std::uint32_t>(signal), target.c_str());
    }
  }
  auto& answers = toy.answers[kMethod];
  if (answers.empty()) return CHIMERA_OK;
  const int answer = answers.front();
  answers.pop_front();
  return answer;
}

inline chimera_port_decl port(const char* name, std::uint32_t kind, std::uint32_t type, std::size_t offset) {
  chimera_port_decl p{};
  p.name = name;
  p.doc = p.shape = p.frame = p.type_name = "";
  p.unit = "1";
  p.kind = kind;
  p.type = type;
  p.element_size = 8;
  p.max_instances = 1;
  p.live_offset = static_cast<std::uint32_t>(offset);
  return p;
}

inline std::int32_t event_source(void* memory) {
  Toy* toy = nullptr;  // there may be none
  std::memcpy(&toy, static_cast<State*>(memory)->me.value, sizeof toy);
  return toy == nullptr ? -1 : toy->descriptor;
}

inline const chimera_component& component(bool aperiodic) {
  static const std::array<chimera_port_decl, 3> ports = {
      port("me", CHIMERA_IN_CONST, CHIMERA_INT64, offsetof(State, me)),
      port("out", CHIMERA_OUT_VAR, CHIMERA_FLOAT64, offsetof(State, out)),
      port("in", CHIMERA_IN_VAR, CHIMERA_FLOAT64, offsetof(State, in))};
  static const auto make = [](bool with_sync) {
    chimera_component c{};
    c.abi_version = CHIMERA_ABI_VERSION;
    c.struct_size = sizeof c;
    c.name = "toy", c.doc = c.source = "";
    c.state_size = sizeof(State);
    c.state_align = alignof(State);
    c.n_ports = 3;
    c.ports = ports.data();
    c.construct = [](void*, chimera_fault*) -> std::int32_t { return CHIMERA_OK; };
    c.destroy = [](void*) {};
    const chimera_method methods[CHIMERA_METHODS] = {
        method<CHIMERA_INIT>, method<CHIMERA_REINIT>, method<CHIMERA_ON>,   method<CHIMERA_CYCLE>, method<CHIMERA_SYNC>,
        method<CHIMERA_OFF>,  method<CHIMERA_KILL>,   method<CHIMERA_ERROR>, method<CHIMERA_CLEAR>};
    std::copy(std::begin(methods), std::end(methods), c.methods);
    c.event_source = event_source;
    if (!with_sync) c.methods[CHIMERA_SYNC] = nullptr;
    return c;
  };
  static const chimera_component periodic = make(false), polled = make(true);
  return aperiodic ? polled : periodic;
}

/// An application of toys. Add tasks, then build().
class Application {
 public:
  /// A task with deadline = period that outputs "x_NAME" and reads the output of `reads` when given.
  TaskSpec& add(const std::string& name, Nanoseconds period, Nanoseconds spend = {}, const std::string& reads = "") {
    auto& one = ones_.emplace_back(std::make_unique<One>());
    one->toy.name = name;
    one->toy.calls = &calls;
    one->toy.spend = spend;
    Toy* address = &one->toy;
    std::memcpy(one->address.data(), &address, sizeof address);
    one->out_name = "x_" + name;
    one->in_name = "x_" + reads;
    one->ports.resize(reads.empty() ? 2 : 3);
    for (std::uint32_t i = 0; i < one->ports.size(); ++i) {
      one->ports[i].declared = i;
      one->ports[i].element_bytes = 8;
    }
    one->ports[0].kind = CHIMERA_IN_CONST;
    one->ports[1].kind = CHIMERA_OUT_VAR;
    one->ports[0].type = CHIMERA_INT64;
    one->ports[0].value = one->address;
    one->ports[1].variable = links_.variable(one->out_name);
    one->ports[1].value = one->zero;
    if (!reads.empty()) one->ports[2].variable = links_.variable(one->in_name);
    one->spec.name = one->toy.name;
    one->spec.component = "toy";
    one->spec.period = one->spec.deadline = period;
    one->spec.rtpu = RtpuId(0u);
    one->spec.ports = one->ports;
    return one->spec;
  }
  bool has(const std::string& name) const {
    return std::any_of(ones_.begin(), ones_.end(), [&name](const auto& one) { return one->toy.name == name; });
  }
  Toy& toy(const std::string& name) { return ones_[id(name).index]->toy; }
  /// Before build().
  TaskSpec& spec(const std::string& name) { return ones_[id(name).index]->spec; }
  TaskId id(const std::string& name) const {
    for (std::size_t i = 0; i < ones_.size(); ++i) {
      if (ones_[i]->toy.name == name) return TaskId(i);
    }
    ADD_FAILURE() << "no task " << name;
    return TaskId(0u);
  }
  /// Instead of one: TaskSpec::rtpu says whose a task is. For build_rtpus().
  void place_on(std::vector<RtpuSpec> rtpus) { rtpus_ = std::move(rtpus); }
  /// The tasks of `off` are spawned but not turned ON.
  TaskSet& build(const std::vector<std::string>& off = {}, const ContextPlace& place = {}) {
    make_spec(off);
    sets_.resize(1);
    sets_[0] = make_set(place);
    return *sets_[0];
  }
  /// A context for each rtpu that has tasks, made in the stated order of the rtpus; none stated: in theirs.
  VirtualPeers& build_rtpus(const std::vector<std::string>& off = {}, std::vector<std::uint32_t> order = {}) {
    make_spec(off);
    peers_ = *VirtualPeers::create(spec_);
    sets_.resize(rtpus_.size());
    for (std::uint32_t r = 0; r < rtpus_.size() && order.size() < rtpus_.size(); ++r) order.push_back(r);
    for (const std::uint32_t r : order) {
      const auto is_there = [r](const TaskSpec& task) { return task.rtpu.index == r; };
      if (std::none_of(specs_.begin(), specs_.end(), is_there)) continue;
      ContextPlace place;
      place.rtpu = RtpuId(r);
      place.others = peers_.get();
      sets_[r] = make_set(place);
      peers_->join(RtpuId(r), *sets_[r]);
    }
    return *peers_;
  }
  const Task& task(const std::string& name) const { return set_of(name).tasks()[id(name).index]; }
  double published(const std::string& name) const {
    TaskSet& set = set_of(name);
    const VariableView view = set.sources().view(VariableId(Variables(set.spec()).find("x_" + name)));
    double value = 0;
    std::memcpy(&value, view.value, sizeof value);
    return value;
  }
  /// For tasks that preempt each other: every toy writes down its own calls.
  TaskSet& build_preemptive(const std::vector<std::string>& off = {}) {
    for (auto& one : ones_) {
      one->toy.calls = &one->calls;
      one->calls.reserve(20'000);
    }
    ContextPlace place;
    place.preemptive = true;
    return build(off, place);
  }
  const std::vector<Call>& own_calls(const std::string& name) const { return ones_[id(name).index]->calls; }
  /// The calls of one method of one task.
  std::vector<Call> calls_of(const std::string& name, Method method) const {
    std::vector<Call> found;
    for (const Call& call : calls) {
      if (call.task == name && call.method == method) found.push_back(call);
    }
    return found;
  }

  std::vector<Call> calls;

 private:
  void make_spec(const std::vector<std::string>& off) {
    for (std::size_t i = 0; i < ones_.size(); ++i) {
      specs_.push_back(ones_[i]->spec);
      components_.push_back(&component(ones_[i]->spec.aperiodic));
      order_.push_back(TaskId(i));
      if (std::find(off.begin(), off.end(), ones_[i]->toy.name) == off.end()) start_.push_back(TaskId(i));
    }
    spec_.name = "toys";
    spec_.rtpus = rtpus_;
    spec_.tasks = specs_;
    spec_.init_order = spec_.end_order = order_;
    spec_.start = start_;
    links_.finish(spec_);
  }
  std::unique_ptr<HeapTaskSet> make_set(const ContextPlace& place) {
    auto made = HeapTaskSet::create(spec_, components_, place);
    if (!made) {
      ADD_FAILURE() << made.error().message.c_str();
      std::abort();
    }
    return *std::move(made);
  }
  TaskSet& set_of(const std::string& name) const {
    return *sets_[sets_.size() == 1 ? 0 : specs_[id(name).index].rtpu.index];
  }

  struct One {
    Toy toy;
    std::vector<Call> calls;
    std::array<std::byte, 8> address{}, zero{};
    std::string out_name, in_name;
    std::vector<PortSpec> ports;
    TaskSpec spec;
  };
  std::vector<std::unique_ptr<One>> ones_;
  std::vector<TaskSpec> specs_;
  std::vector<const chimera_component*> components_;
  std::vector<TaskId> order_, start_;
  std::vector<RtpuSpec> rtpus_{RtpuSpec{"only", 0, Policy::kEdf}};
  chimera::NamedLinks links_;
  ApplicationSpec spec_;
  std::unique_ptr<VirtualPeers> peers_;
  std::vector<std::unique_ptr<HeapTaskSet>> sets_;  // one, or by rtpu
};

/// Each release between two jobs of the task counts as dropped in the second one: none is lost, none comes twice.
inline void expect_every_release(const std::vector<Call>& calls, Nanoseconds period) {
  const Call* last = nullptr;
  for (const Call& call : calls) {
    if (call.method != Method::kCycle) continue;
    if (last != nullptr) {
      EXPECT_EQ(call.now, last->now + period * (1 + std::int64_t{call.dropped})) << call.task;
    }
    last = &call;
  }
}

}  // namespace chimera::toy
