// SPDX-License-Identifier: Apache-2.0
// While tasks are ON the framework asks the heap for nothing: counted over ten thousand cycles of each executor in
// virtual time and of two rtpus there, and over the preemptive one's threads; the counter is shown to see an
// allocation. (That it cannot is another test: tools/check_cycle_path.py, which does not follow the vectors of
// preemptive contexts that reserve their room.)
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "chimera/base/testing/await.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/rtpus_run.h"
#include "tests/conformance/runner.h"

namespace {

std::atomic<std::size_t> n_allocations = 0;  // of this program; tests run one after another

}  // namespace

// Every form of new that the library's own default ends in.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++n_allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  std::abort();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return operator new(size); }
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++n_allocations;
  const auto a = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(a, (size + a - 1) / a * a)) return memory;
  std::abort();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return operator new(size, alignment);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace chimera::toy {
namespace {

bool allocates = false;  // the planted fault: the component itself does

// A component without a log: reads, computes, publishes, and sometimes fails or sends `off` to another task.
struct Quiet {
  chimera_port out;
  chimera_port in;
  std::uint64_t cycles;
};

std::int32_t quiet_cycle(void* memory, const chimera_call* call) {
  Quiet& quiet = *static_cast<Quiet*>(memory);
  double in = 0;
  std::memcpy(&in, quiet.in.value, sizeof in);
  in += 1;
  std::memcpy(quiet.out.value, &in, sizeof in);
  call->host->spend(call->context, 20'000);
  if (allocates) delete new int(1);
  if (++quiet.cycles % 100 == 50) {
    std::strcpy(call->fault->text, "every hundredth");
    return CHIMERA_FAULT;
  }
  if (quiet.cycles % 400 == 30) call->host->spend(call->context, 3'000'000);  // late: releases are dropped
  return CHIMERA_OK;
}

std::int32_t recovers(void*, const chimera_call*) { return CHIMERA_OK; }

struct Counted {
  std::size_t allocations = 0;
  std::uint64_t cycles = 0;
  std::uint64_t faults = 0, dropped = 0;
};

constexpr std::uint32_t kTasks = 5;

using Components = std::span<const chimera_component* const>;

void add(const TaskSet& set, Counted& counted) {
  for (const Task& task : set.tasks()) {
    counted.cycles += task.profile.cycles;
    counted.faults += task.faults.count;
    counted.dropped += task.profile.dropped;
  }
}

// Runs five tasks that read one another in a ring, on `n_rtpus` rtpus, with signals, faults and late jobs.
template <class Run>
Counted count(std::uint32_t n_rtpus, Run run) {
  const std::array<chimera_port_decl, 2> decls = {port("out", CHIMERA_OUT_VAR, CHIMERA_FLOAT64, offsetof(Quiet, out)),
                                                  port("in", CHIMERA_IN_VAR, CHIMERA_FLOAT64, offsetof(Quiet, in))};
  chimera_component component = toy::component(false);
  component.ports = decls.data();
  component.n_ports = 2;
  component.state_size = sizeof(Quiet);
  std::fill(std::begin(component.methods), std::end(component.methods), nullptr);
  component.methods[CHIMERA_CYCLE] = quiet_cycle;
  component.methods[CHIMERA_ERROR] = recovers;
  const char* names[kTasks] = {"a", "b", "c", "d", "e"};
  const double zero = 0;
  chimera::NamedLinks links;
  std::array<std::array<PortSpec, 2>, kTasks> ports;
  std::array<TaskSpec, kTasks> tasks;
  std::array<const chimera_component*, kTasks> components;
  std::array<TaskId, kTasks> ids;
  for (std::uint32_t i = 0; i < kTasks; ++i) {
    for (std::uint32_t p = 0; p < 2; ++p) {
      ports[i][p].declared = p, ports[i][p].kind = decls[p].kind;
      ports[i][p].element_bytes = 8;
      ports[i][p].variable = links.variable(names[(i + (p == 0 ? 0 : kTasks - 1)) % kTasks]);
    }
    ports[i][0].value = std::as_bytes(std::span(&zero, 1));
    tasks[i].name = names[i];
    tasks[i].component = "quiet";
    tasks[i].period = tasks[i].deadline = milliseconds(1);
    tasks[i].ports = ports[i];
    tasks[i].rtpu = RtpuId(i % n_rtpus);
    components[i] = &component;
    ids[i] = TaskId(i);
  }
  const RtpuSpec rtpus[] = {{"loop", 0, Policy::kEdf}, {"preemptive", 1, Policy::kEdf, true}};
  ApplicationSpec spec;
  spec.name = "quiet";
  spec.rtpus = {rtpus, n_rtpus};
  spec.tasks = tasks;
  spec.init_order = spec.start = ids;
  const NamedSet sets[] = {{"all", ids}, {"none", {}}};
  spec.sets = sets;
  links.finish(spec);
  const std::array<ScriptAct, 6> acts = {
      ScriptAct{milliseconds(50), ScriptAct::Kind::kRaiseFlag, Signal::kOn, TaskId()},
      ScriptAct{milliseconds(70), ScriptAct::Kind::kLowerFlag, Signal::kOn, TaskId()},
      ScriptAct{milliseconds(90), ScriptAct::Kind::kSignal, Signal::kReinit, TaskId(0u)},
      ScriptAct{milliseconds(100), ScriptAct::Kind::kSignal, Signal::kOff, TaskId(4u)},
      ScriptAct{milliseconds(110), ScriptAct::Kind::kSignal, Signal::kOn, TaskId(4u)},
      ScriptAct{milliseconds(120), ScriptAct::Kind::kSignal, Signal::kOn, TaskId(4u)}};  // refused
  return run(spec, Components(components), std::span<const ScriptAct>(acts));
}

template <class Run>
Counted count_in_one(const ContextPlace& place, Run run) {
  return count(1, [&](const ApplicationSpec& spec, Components components, std::span<const ScriptAct> acts) {
    auto set = HeapTaskSet::create(spec, components, place);
    EXPECT_TRUE(set);
    Counted counted;
    counted.allocations = run(**set, acts);
    add(**set, counted);
    return counted;
  });
}

Counted count_on_two_rtpus() {
  return count(2, [](const ApplicationSpec& spec, Components components, std::span<const ScriptAct> acts) {
    auto peers = *VirtualPeers::create(spec);
    std::unique_ptr<HeapTaskSet> sets[2];
    for (std::uint32_t r = 0; r < 2; ++r) {
      ContextPlace place;
      place.rtpu = RtpuId(r);
      place.others = peers.get();
      sets[r] = *HeapTaskSet::create(spec, components, place);
      peers->join(RtpuId(r), *sets[r]);
    }
    RtpusRun run(*peers, acts);
    EXPECT_TRUE(run.start());
    Counted counted;
    const std::size_t before = n_allocations;
    run.run(milliseconds(2250));
    counted.allocations = n_allocations - before;
    for (const auto& set : sets) add(*set, counted);
    return counted;
  });
}

// Switches to a set in which no task is ON, and back.
std::vector<ScriptAct> with_switches(std::span<const ScriptAct> acts) {
  std::vector<ScriptAct> all(acts.begin(), acts.end());
  for (const std::uint32_t to : {1u, 0u}) {
    all.push_back({milliseconds(200 - 50 * to), ScriptAct::Kind::kSwitch, Signal::kOn, TaskId()});
    all.back().set = to;
  }
  return all;
}

Counted count(Kind kind) {
  return count_in_one({}, [kind](TaskSet& set, std::span<const ScriptAct> acts) {
    const std::vector<ScriptAct> script = with_switches(acts);
    Runner runner(set, kind, Policy::kEdf, script);
    EXPECT_TRUE(runner.start());
    const std::size_t before = n_allocations;
    runner.run(milliseconds(2250));
    const std::size_t allocations = n_allocations - before;
    for (const SwitchReceipt& receipt : runner.receipts()) EXPECT_EQ(receipt.end, SwitchEnd::kDone);
    return allocations;
  });
}

// By threads, without real-time levels: the same program, its section found taken now and then.
Counted count_by_threads() {
  ContextPlace place;
  place.preemptive = true;
  return count_in_one(place, [](TaskSet& set, std::span<const ScriptAct> acts) {
    const std::vector<ScriptAct> script = with_switches(acts);
    Listened listened;
    RunOptions options;
    options.policy = Policy::kEdf;
    options.script = Script(script);
    options.tap = listened.tap();
    PreemptiveExecutor executor(set, options, {});
    EXPECT_TRUE(executor.start());
    const std::size_t before = n_allocations;
    const auto cycles = [&set] {
      Counted sum;
      add(set, sum);
      return sum.cycles;
    };
    for (Nanoseconds until = milliseconds(600); until < kHangLimit && cycles() < 300; until += milliseconds(200))
      executor.run(until);
    const std::size_t allocations = n_allocations - before;
    const auto receipts = executor.releases().receipts().all();
    EXPECT_EQ(receipts.size(), 2u);
    for (const SwitchReceipt& receipt : receipts) {  // both are asked for at one edge where that was late
      const bool is_beside = &receipt != &receipts[0] && receipt.why == NoSwitch::kUnderWay;
      EXPECT_TRUE(receipt.end != SwitchEnd::kRefused || is_beside)
          << static_cast<int>(receipt.why) << ", task " << receipt.task.index;
    }
    return allocations;
  });
}

class NoHeap : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(All, NoHeap, ::testing::Values(Kind::kExecutiveOnTwin, Kind::kVirtual, Kind::kPreemptive),
                         [](const auto& one) { return kind_name(one.param); });

TEST_P(NoHeap, TenThousandCyclesWithFaultsDropsAndActsAllocateNothing) {
  allocates = false;
  const Counted counted = count(GetParam());
  EXPECT_EQ(counted.allocations, 0u);
  EXPECT_GE(counted.cycles, 10'000u);
  EXPECT_GT(counted.faults, 50u);
  EXPECT_GT(counted.dropped, 10u);
}

TEST(NoHeapOnRtpus, CyclesWithFaultsDropsAndActsAllocateNothing) {
  allocates = false;
  const Counted counted = count_on_two_rtpus();
  EXPECT_EQ(counted.allocations, 0u);
  EXPECT_GE(counted.cycles, 10'000u);
  EXPECT_GT(counted.faults, 50u);
  EXPECT_GT(counted.dropped, 10u);
  allocates = true;
  const Counted planted = count_on_two_rtpus();
  EXPECT_GE(planted.allocations, planted.cycles);
  allocates = false;
}

TEST(NoHeapByThreads, CyclesWithFaultsDropsAndActsAllocateNothing) {
  allocates = false;
  const Counted counted = count_by_threads();
  EXPECT_EQ(counted.allocations, 0u);
  EXPECT_GE(counted.cycles, 300u);
  EXPECT_GT(counted.faults, 0u);
  allocates = true;
  const Counted planted = count_by_threads();
  EXPECT_GE(planted.allocations, planted.cycles);
  allocates = false;
}

TEST_P(NoHeap, AComponentThatAllocatesIsSeen) {
  allocates = true;
  const Counted counted = count(GetParam());
  EXPECT_GE(counted.allocations, counted.cycles);
  allocates = false;
}

}  // namespace
}  // namespace chimera::toy
