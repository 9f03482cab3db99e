// SPDX-License-Identifier: Apache-2.0
// Makes a component for each task of a board. Its methods find the task by the context of the call.
#include "chimera/rtpu/board_tasks.h"

#include <algorithm>
#include <cstring>
#include <new>

#include "chimera/base/assert.h"
#include "chimera/platform/clock.h"
#include "chimera/runtime/job/job_step.h"
#include "chimera/runtime/life/task_host.h"

namespace chimera {
namespace {

constexpr Nanoseconds kWaitForBoard = milliseconds(5);
constexpr std::uint32_t kFramesForText = 8;  // each frame carries the fault of one task in ERROR

BoardTasks* the_board = nullptr;

/// In the state of a stand-in, in front of its ports.
struct StandInState {
  std::uint32_t frames = 0;     // of the last frame that sync looked at
  std::uint16_t sequence = 0;   // of the last publication that was copied
  std::uint32_t in_error = 0;   // frames that said ERROR, without a text
  bool was_on = false, has_told = false;
};

struct StandInCall {
  StandInCall(void* state, const chimera_call* made)
      : mine(*static_cast<StandInState*>(state)), call(*made), task(*static_cast<const TaskHost*>(made->context)->task),
        line(the_board->line()), index(line.index_of(task.id)) {}

  std::int32_t fail(std::string_view text, std::int32_t code = 0) const {
    chimera_fault& fault = *call.fault;
    fault.code = code;
    const std::size_t n = std::min<std::size_t>(text.size(), CHIMERA_FAULT_TEXT - 1);
    std::memcpy(fault.text, text.data(), n);
    fault.text[n] = '\0';
    return CHIMERA_FAULT;
  }

  /// Passes on what the task reads of other rtpus.
  void send_inputs() const {
    const std::span<const board_link::Import> imports = line.layout().imports();
    std::size_t in = 0;
    for (const PortSpec& port : task.spec->ports) {
      if (port.kind != CHIMERA_IN_VAR) continue;
      const chimera_port& from = *task.inputs[in++].port;
      const auto found = std::ranges::find(imports, port.variable, &board_link::Import::variable);
      if (found == imports.end() || from.slot == nullptr) continue;
      line.set_import(static_cast<std::size_t>(found - imports.begin()), from.value,
                      (from.slot->valid >> from.bit & 1u) != 0, Nanoseconds{from.slot->published_ns});
    }
    line.set_flag(call.illegal != 0);
  }

  StandInState& mine;
  const chimera_call& call;
  Task& task;
  BoardLine& line;
  std::size_t index;
};

/// Waits for the board, however long that takes; only the end of the rtpu ends the wait.
std::int32_t init(void* state, const chimera_call* call) {
  const StandInCall me(state, call);
  me.mine = {};
  for (;;) {
    const State there = me.line.task(me.index).state;
    const bool is_made = there == State::kOff || there == State::kOn;  // a task in ERROR is cleared: it is not wanted
    if (me.line.life() == BoardLine::Life::kUp && is_made) return CHIMERA_OK;
    if (me.line.life() == BoardLine::Life::kForeign) return me.fail(me.line.trouble());
    if (!me.line.waits()) return me.fail("the rtpu ends before its board answered");
    LinuxClock clock;
    clock.wait_until(clock.now() + kWaitForBoard);
  }
}

std::int32_t on(void* state, const chimera_call* call) {
  const StandInCall me(state, call);
  me.send_inputs();
  me.line.want(me.index, true);
  const BoardTask there = me.line.task(me.index);
  if (!there.is_wanted) return CHIMERA_NOT_YET;  // it has not heard it
  if (there.state == State::kError) {
    me.line.want(me.index, false);
    return me.fail(there.has_fault ? there.fault.text : "on the board it is in ERROR", there.fault.code);
  }
  if (there.state != State::kOn) return CHIMERA_NOT_YET;
  me.mine.was_on = true;
  return CHIMERA_OK;
}

/// An event is a publication of the task on the board.
std::int32_t sync(void* state, const chimera_call* call) {
  const StandInCall me(state, call);
  read_inputs(me.task);
  me.send_inputs();
  if (me.line.life() != BoardLine::Life::kUp) {
    if (!me.mine.has_told) call->host->note(call->context, me.line.trouble().c_str());
    me.mine.has_told = true;
    return CHIMERA_NO_EVENT;
  }
  const BoardTask there = me.line.task(me.index);
  if (there.frames == me.mine.frames) return CHIMERA_NO_EVENT;
  me.mine.frames = there.frames;
  if (there.state == State::kError) {
    if (!there.has_fault && ++me.mine.in_error < kFramesForText) return CHIMERA_NO_EVENT;
    return me.fail(there.has_fault ? there.fault.text : "on the board it is in ERROR", there.fault.code);
  }
  if (there.state == State::kOn) me.mine.was_on = true;
  else if (me.mine.was_on && there.is_wanted) return me.fail("the board turned it off by itself");
  if (there.sequence == 0 || there.sequence == me.mine.sequence) return CHIMERA_NO_EVENT;
  me.mine.sequence = there.sequence;
  return CHIMERA_OK;
}

std::int32_t cycle(void* state, const chimera_call* call) {
  const StandInCall me(state, call);
  if (!me.task.outputs.empty()) me.line.read_outputs(me.index, me.task.group.staging());
  return CHIMERA_OK;
}

/// The board must say that the task is OFF: its motor may turn.
std::int32_t off(void* state, const chimera_call* call) {
  const StandInCall me(state, call);
  me.line.want(me.index, false);
  me.mine.was_on = false;
  const auto is_off = [](const BoardTask& there) { return !there.is_wanted && there.state != State::kOn; };
  if (me.line.life() == BoardLine::Life::kUp && me.line.await(me.index, me.line.patience(), is_off)) return CHIMERA_OK;
  return me.fail("the board has not said that it is OFF");
}

std::int32_t clear(void* state, const chimera_call* call) {
  const StandInCall me(state, call);
  me.line.want(me.index, false);
  const auto is_clear = [](const BoardTask& there) { return there.state == State::kOff; };
  if (!me.line.await(me.index, me.line.patience(), is_clear)) return me.fail("on the board it is not OFF");
  const std::uint16_t sequence = me.mine.sequence;
  me.mine = {};
  me.mine.sequence = sequence;
  return CHIMERA_OK;
}

std::int32_t error(void* state, const chimera_call* call) {
  const StandInCall me(state, call);
  me.line.want(me.index, me.line.task(me.index).state == State::kError);  // it stays in ERROR until clear
  return CHIMERA_FAULT;
}

std::int32_t construct(void* state, chimera_fault*) {
  ::new (state) StandInState();
  return CHIMERA_OK;
}
void destroy(void*) {}

}  // namespace

BoardTasks::BoardTasks(const ApplicationSpec& spec, RtpuId rtpu)
    : spec_(spec), tasks_(spec.tasks.begin(), spec.tasks.end()), by_task_(spec.tasks.size()), line_(spec, rtpu) {
  CHIMERA_ASSERT(the_board == nullptr);
  the_board = this;
  for (std::size_t t = 0; t < tasks_.size(); ++t)
    if (tasks_[t].rtpu == rtpu) add(spec.tasks[t], t);
  spec_.tasks = tasks_;
}

BoardTasks::~BoardTasks() {
  line_.stop();
  the_board = nullptr;
}

void BoardTasks::add(const TaskSpec& task, std::size_t index) {
  StandIn& made = stand_ins_.emplace_back();
  made.specs.assign(task.ports.begin(), task.ports.end());
  made.names.resize(task.ports.size());
  constexpr std::size_t kAlign = alignof(chimera_port);
  std::size_t offset = (sizeof(StandInState) + kAlign - 1) / kAlign * kAlign;
  for (std::size_t p = 0; p < made.specs.size(); ++p) {
    PortSpec& port = made.specs[p];
    port.declared = static_cast<std::uint32_t>(p);
    port.instance = 0;
    port.safety = false;  // the board judged it
    made.names[p] = spec_.link_name(port);
    chimera_port_decl declared{};
    declared.name = made.names[p].c_str();
    declared.doc = declared.unit = declared.shape = declared.frame = declared.type_name = "";
    declared.kind = port.kind;
    declared.type = port.type;
    declared.element_size = port.element_bytes;
    declared.max_instances = 1;
    declared.live_offset = static_cast<std::uint32_t>(offset);
    offset += sizeof(chimera_port);
    made.ports.push_back(declared);
  }
  made.component.abi_version = CHIMERA_ABI_VERSION;
  made.component.struct_size = sizeof(chimera_component);
  made.component.name = "board";
  made.component.doc = made.component.source = "";
  made.component.state_size = static_cast<std::uint32_t>(offset);
  made.component.state_align = alignof(chimera_port);
  made.component.n_ports = static_cast<std::uint32_t>(made.ports.size());
  made.component.ports = made.ports.data();
  made.component.construct = &construct;
  made.component.destroy = &destroy;
  made.component.host_size = sizeof(chimera_host);
  chimera_method* const methods = made.component.methods;
  methods[CHIMERA_INIT] = &init, methods[CHIMERA_ON] = &on, methods[CHIMERA_SYNC] = &sync;
  methods[CHIMERA_CYCLE] = &cycle, methods[CHIMERA_OFF] = &off, methods[CHIMERA_CLEAR] = &clear;
  methods[CHIMERA_ERROR] = &error;
  TaskSpec& mine = tasks_[index];
  mine.ports = made.specs;
  mine.budget = mine.min_time = {};
  mine.on_miss = mine.on_overrun = OnMiss::kContinue;
  mine.max_consecutive = 0;
  mine.tolerated_misses = mine.tolerated_of = 0;
  mine.aperiodic = true;
  mine.has_events = false;
  by_task_[index] = &made.component;
}

}  // namespace chimera
