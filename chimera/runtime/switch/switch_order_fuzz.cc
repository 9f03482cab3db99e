// SPDX-License-Identifier: Apache-2.0
// Any words on the decision page: the order is refused, or it fits the application and a plan is made from it that,
// carried out, makes the ON set that it names. No move on the page leads from one plan into another.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "chimera/base/testing/property.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/plan/switch_plan.h"

namespace {

using namespace chimera;

constexpr std::size_t kTasks = 70, kSets = 3;  // task bits in two words, one of them in part
constexpr Nanoseconds kOrigin = seconds(5), kNow = seconds(6);

/// Takes what it needs from the front; zeros when there is nothing left.
class Bytes {
 public:
  Bytes(const std::uint8_t* bytes, std::size_t size) : left_(bytes, size) {}
  std::uint64_t take(std::size_t n) {
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < n && !left_.empty(); ++i, left_ = left_.subspan(1))
      word |= std::uint64_t{left_[0]} << 8 * i;
    return word;
  }
  bool has_more() const { return !left_.empty(); }

 private:
  std::span<const std::uint8_t> left_;
};

/// Two rtpus; variable v is made by tasks v and v + 35, which are never ON together.
struct Application {
  Application() {
    for (std::size_t t = 0; t < kTasks; ++t) {
      tasks[t].rtpu = RtpuId(t % 2);
      tasks[t].period = milliseconds(1 + static_cast<std::int64_t>(t));
      order[t] = TaskId(t);
    }
    for (std::size_t v = 0; v < variables.size(); ++v) {
      producers[v] = {PortOf{TaskId(v), 0}, PortOf{TaskId(v + variables.size()), 0}};
      variables[v].producers = producers[v];
    }
    const std::span<const TaskId> all = order;
    sets = {NamedSet{"first", all.first(35)}, NamedSet{"second", all.last(35)}, NamedSet{"none", all.first(0)}};
    spec.tasks = tasks;
    spec.variables = variables;
    spec.sets = sets;
    spec.on_order = order;
    planner.prepare(spec, heap);
  }
  std::array<TaskSpec, kTasks> tasks{};
  std::array<TaskId, kTasks> order;
  std::array<std::array<PortOf, 2>, kTasks / 2> producers;
  std::array<Variable, kTasks / 2> variables{};
  std::array<NamedSet, kSets> sets;
  ApplicationSpec spec;
  HeapMemory heap;
  SwitchPlanner planner;
};

void carry_out(Application& app, const SwitchOrder& order, Bytes& bytes) {
  std::vector<TaskStatus> statuses(kTasks);
  for (std::size_t t = 0; t < kTasks; ++t)
    statuses[t].state = order.on.has(TaskId(t)) ? State::kOn : static_cast<State>(bytes.take(1) % kStates);
  SwitchPlan plan;
  const PlanAnswer answer = app.planner.plan(order.target, statuses, plan);
  require(order.after == kNoSet || order.after < kSets, "an order that is taken names a set, or none");
  if (!answer) return;
  for (const auto ids : {plan.arriving, plan.leaving, plan.staying})
    for (const TaskId id : ids) require(id.index < kTasks, "every task of a plan is there");
  for (const Handover& each : plan.handovers)
    require(each.variable.index < app.variables.size() && each.to.task.index < kTasks, "so is every variable");
  for (std::uint16_t run = 0; run < 2 * kTasks; ++run) {
    const SwitchRun part = find_run(plan, app.tasks, run);
    require(part.begin <= part.end && part.end <= plan.arriving.size(), "a run lies in the plan");
  }
  const Nanoseconds lead = lead_of(plan, app.tasks, order.lead);
  require(kNow + lead > kNow && order.until + lead >= order.until, "times can be added");
  for (const TaskId id : plan.leaving) statuses[id.index].state = State::kOff;
  for (const TaskId id : plan.arriving) statuses[id.index].state = State::kOn;
  for (std::size_t t = 0; t < kTasks; ++t)
    require((statuses[t].state == State::kOn) == order.target.has(TaskId(t)), "carried out, it makes what was asked");
}

/// One of the moves of a context that believes in plan `number`.
void move(SwitchAgreement& agreement, Bytes& bytes) {
  const PlanWord before = agreement.plan();
  const auto number = static_cast<std::uint16_t>(bytes.take(2));
  switch (bytes.take(1) % 4) {
    case 0: agreement.hand_on(number, static_cast<std::uint16_t>(bytes.take(2))); break;
    case 1: {
      const Nanoseconds at = agreement.round_up(kNow + Nanoseconds{static_cast<std::int64_t>(bytes.take(7))});
      if (at != kNever) agreement.propose(number, at);
      break;
    }
    case 2: agreement.agree(number, static_cast<std::uint32_t>(bytes.take(1) % kMaxContexts)); break;
    default: agreement.abort(number); break;
  }
  const PlanWord after = agreement.plan();
  require(after.number == before.number, "a move stays within its plan");
  const bool is_over = before.phase == SwitchPhase::kCommitted || before.phase == SwitchPhase::kAborted;
  require(!is_over || after.word() == before.word(), "what is over is not changed");
}

void check(Bytes bytes) {
  static Application app;
  SwitchPage page;
  SwitchAgreement agreement(page, kOrigin);
  SwitchOrder hostile;  // with a sum that is right
  hostile.number = static_cast<std::uint16_t>(bytes.take(2));
  hostile.members = static_cast<std::uint16_t>(bytes.take(2));
  hostile.after = static_cast<std::uint32_t>(bytes.take(4));
  hostile.until = {static_cast<std::int64_t>(bytes.take(8))};
  hostile.lead = {static_cast<std::int64_t>(bytes.take(8))};
  for (std::uint64_t& word : hostile.on.words) word = bytes.take(8);
  for (std::uint64_t& word : hostile.target.words) word = bytes.take(8);
  agreement.announce(hostile);
  for (std::uint64_t stray = bytes.take(1) % 4; stray > 0; --stray)
    page.order[bytes.take(1) % std::size(page.order)].fetch_xor(bytes.take(8));
  if (bytes.take(1) % 4 == 0) page.plan.store(bytes.take(8));
  if (bytes.take(1) % 4 == 0) page.turn.store(bytes.take(8));
  if (const auto order = agreement.order(agreement.plan(), kSets, kTasks)) {
#ifdef CHIMERA_PLANTED_DEFECT
    require(order->after != 1, "planted");
#endif
    require(order->number == agreement.plan().number && order->members != 0, "it is of the plan that is announced");
    carry_out(app, *order, bytes);
  }
  while (bytes.has_more()) move(agreement, bytes);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  check(Bytes(bytes, size));
  return 0;
}
