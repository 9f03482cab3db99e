// SPDX-License-Identifier: Apache-2.0
#include "tests/subsystem/driver.h"

#include <algorithm>

#include "tests/subsystem/face.h"
#include "tests/subsystem/judge.h"
#include "tests/subsystem/keeper.h"
#include "tests/subsystem/process.h"

namespace chimera::simulated {

using namespace subsystem;

namespace {

constexpr const char* kEventNames[] = {"> begun", "> inventory complete", "> rtpu up", "> rtpu down", "> task seen",
                                       "> reported", "> requested", "> commanded", "> tick"};
constexpr const char* kActionNames[] = {"< send", "< start", "< goal", "< handled", "< restart", "< started",
                                        "< answer", "< tell"};
static_assert(std::size(kEventNames) == std::variant_size_v<Event>);
static_assert(std::size(kActionNames) == std::variant_size_v<Action>);

}  // namespace

ManagerLoop::ManagerLoop(ManagerState& world) : world_(world), told_(world.n_tasks()), taken_(Plan::kRtpus) {}

// ---- life and death ----

void ManagerLoop::start() {
  world_.note("manager starts", ++life_);
  const bool is_blind = world_.defect == Defect::kJudgesNothing;
  subsystem_ = std::make_unique<Subsystem>(is_blind ? world_.plan.blind : world_.plan.spec);
  is_complete_ = poll_is_due_ = false;
  is_doomed_ = !world_.is_calm && world_.chance.percent(10);
  messages_.clear();
  believed_.clear();
  asked_.clear();
  tick_ = kNever;
  is_served_.assign(Plan::kRtpus, false);
  tells_of_mute_ = world_.chance.percent(50);
  told_.assign(told_.size(), std::nullopt);
  Begun begun = world_.keeper->memory;
  for (std::size_t r = 0; r < Plan::kRtpus; ++r) {
    Process& process = *world_.processes[r];
    taken_[r] = process.notes().size();
    if (world_.keeper->is_alive(RtpuId(r))) process.meet(life_);
    else messages_.push_back({Message::Kind::kEnded, RtpuId(r), process.incarnation()});
    if (world_.defect == Defect::kIgnoresAbsentDeaths && !world_.keeper->is_alive(RtpuId(r)))
      begun.handled[r] = process.incarnation();
  }
  if (!feed(begun)) return;
  world_.agenda.after(world_.chance.between(microseconds(100), milliseconds(20)), [this, life = life_] {
    if (!is_alive() || life != life_) return;
    messages_.push_back({Message::Kind::kComplete, RtpuId{}, 0});
    poke();
  });
}

void ManagerLoop::die(const char* point) {
  if (!is_alive()) return;
  world_.note("manager dies", life_);
  world_.tally.count(point);
  if (!is_complete_) world_.tally.count("manager death in the inventory");
  if (world_.judge->is_turning()) world_.tally.count("manager death in a transaction");
  for (const auto& process : world_.processes)
    if (!process->is_alive()) world_.tally.count("manager and rtpu dead together");
  ++world_.deaths;
  world_.judge->manager_dies();
  subsystem_.reset();
  world_.keeper->manager_dies();
}

// ---- events ----

void ManagerLoop::poke() {
  if (!is_alive() || poll_is_due_) return;
  poll_is_due_ = true;
  world_.agenda.after(world_.chance.between(microseconds(20), milliseconds(1)), [this, life = life_] {
    if (is_alive() && life == life_) poll();
  });
}

void ManagerLoop::serves(RtpuId rtpu, std::uint32_t incarnation, std::uint32_t manager) {
  if (!is_alive() || manager != life_) return;
  messages_.push_back({Message::Kind::kServes, rtpu, incarnation});
  poke();
}

void ManagerLoop::ended(RtpuId rtpu, std::uint32_t incarnation) {
  if (!is_alive()) return;
  messages_.push_back({Message::Kind::kEnded, rtpu, incarnation});
  poke();
}

void ManagerLoop::poll() {
  poll_is_due_ = false;
  while (!messages_.empty()) {
    const Message message = messages_.front();
    messages_.pop_front();
    if (!take(message)) return;
  }
  for (std::size_t r = 0; r < Plan::kRtpus; ++r)
    if (is_readable(RtpuId(r)) && (!tell_words(RtpuId(r)) || !take_notes(RtpuId(r)))) return;
  if (!take_commands()) return;
  if (subsystem_->next_due() <= world_.now() && world_.defect != Defect::kHasNoClock) feed(Tick{});
}

// False, here and below: it died over it.
bool ManagerLoop::take(const Message& message) {
  switch (message.kind) {
    case Message::Kind::kServes:
      taken_[message.rtpu.index] =
          std::min(taken_[message.rtpu.index], world_.processes[message.rtpu.index]->notes().size());
      is_served_[message.rtpu.index] = true;
      return tell_words(message.rtpu) && feed(RtpuUp{message.rtpu, message.incarnation});
    case Message::Kind::kEnded: return take_ended(message);
    case Message::Kind::kComplete:
      for (std::size_t r = 0; r < Plan::kRtpus; ++r)
        if (is_readable(RtpuId(r)) && !tell_words(RtpuId(r))) return false;
      is_complete_ = true;
      return feed(InventoryComplete{});
  }
  return true;
}

bool ManagerLoop::take_ended(const Message& message) {
  if (world_.chance.percent(50) && !take_notes(message.rtpu)) return false;
  if (!tell_words(message.rtpu)) return false;
  for (std::size_t t = 0; t < told_.size(); ++t)
    if (world_.plan.spec.tasks[t].rtpu == message.rtpu) told_[t] = TaskStatus{};
  taken_[message.rtpu.index] = 0;
  is_served_[message.rtpu.index] = false;
  return feed(RtpuDown{message.rtpu, message.incarnation, world_.processes[message.rtpu.index]->cause()});
}

bool ManagerLoop::is_readable(RtpuId rtpu) const {
  return world_.keeper->is_alive(rtpu) && (tells_of_mute_ || is_served_[rtpu.index]);
}

bool ManagerLoop::tell_words(RtpuId rtpu) {
  for (std::size_t t = 0; t < told_.size(); ++t)
    if (world_.plan.spec.tasks[t].rtpu == rtpu && !tell_word(TaskId(t))) return false;
  return true;
}

bool ManagerLoop::tell_word(TaskId task) {
  const TaskStatus word = world_.process_of(task).word(task);
  if (told_[task.index] == word) return true;
  told_[task.index] = word;
  return feed(TaskSeen{task, word});
}

bool ManagerLoop::take_notes(RtpuId rtpu) {
  const auto& notes = world_.processes[rtpu.index]->notes();
  for (std::size_t& taken = taken_[rtpu.index]; taken < notes.size();) {
    const Process::Note note = notes[taken++];
    if (const auto* reported = std::get_if<Reported>(&note)) {
      if (!tell_word(reported->task) || !feed(*reported)) return false;
    } else if (!feed(std::get<Requested>(note))) {
      return false;
    }
  }
  return true;
}

bool ManagerLoop::take_commands() {
  for (std::size_t f = 0; f < world_.faces.size(); ++f) {
    Face& face = *world_.faces[f];
    if (!face.is_waiting_at_door(life_)) continue;
    face.let_in(life_);
    asked_.push_back({++commands_, f});
    if (!feed(Commanded{commands_, face.signal(), face.tasks()})) return false;
  }
  return true;
}

bool ManagerLoop::feed(const Event& event) {
  std::vector<Action> actions;
  world_.note(kEventNames[event.index()]);
  subsystem_->step(event, world_.now(), actions);
  world_.judge->stepped(event, actions);
  const std::size_t end = cut(actions.size());
  for (std::size_t a = 0; a < end; ++a) carry_out(actions[a]);
  if (is_doomed_ && !actions.empty()) {
    const auto restarts = [](const Action& action) { return std::holds_alternative<RememberHandled>(action); };
    if (std::any_of(actions.begin(), actions.end(), restarts)) world_.tally.count("manager death in a restart");
    die(end == 0 ? "manager death at the first action"
                 : end == actions.size() ? "manager death after the last action" : "manager death between actions");
    return false;
  }
  world_.judge->step_ended();
  plan_tick();
  while (!believed_.empty()) {
    const Event believed = believed_.front();
    believed_.pop_front();
    if (!feed(believed)) return false;
  }
  return true;
}

// How many of the actions are carried out before it dies.
std::size_t ManagerLoop::cut(std::size_t n_actions) {
  return is_doomed_ && n_actions > 0 ? world_.chance.below(n_actions + 1) : n_actions;
}

void ManagerLoop::plan_tick() {
  const Nanoseconds due = subsystem_->next_due();
  if (due == kNever || due == tick_ || world_.defect == Defect::kHasNoClock) return;
  tick_ = due;
  world_.agenda.at(due, [this, life = life_, due] {
    if (!is_alive() || life != life_ || subsystem_->next_due() != due) return;
    feed(Tick{});
  });
}

// ---- actions ----

void ManagerLoop::carry_out(const Action& action) {
  Begun& memory = world_.keeper->memory;
  world_.note(kActionNames[action.index()]);
  if (const auto* it = std::get_if<Send>(&action)) {
    send(*it);
  } else if (const auto* start_it = std::get_if<StartRtpu>(&action)) {
    world_.tally.count("action start");
    world_.keeper->start(start_it->rtpu);
  } else if (const auto* goal = std::get_if<RememberGoal>(&action)) {
    world_.tally.count("action goal");
    world_.note("goal", goal->task.index, goal->goal);
    if (world_.defect != Defect::kForgetsGoals || goal->goal == 0) memory.goals[goal->task.index] = goal->goal;
    world_.judge->goal(*goal);
  } else if (const auto* handled = std::get_if<RememberHandled>(&action)) {
    world_.tally.count("action handled");
    memory.handled[handled->rtpu.index] = handled->incarnation;
  } else if (const auto* restart = std::get_if<RememberRestart>(&action)) {
    world_.tally.count("action restart");
    memory.restarts[restart->rtpu.index] = restart->instants;
  } else if (std::holds_alternative<RememberStarted>(action)) {
    world_.tally.count("action started");
    memory.started = true;
  } else if (const auto* answer_it = std::get_if<subsystem::CommandAnswer>(&action)) {
    answer(*answer_it);
  } else {
    tell(std::get<LogEvent>(action));
  }
}

void ManagerLoop::send(const Send& send) {
  world_.tally.count("action send");
  world_.signals += send.tasks.size();
  for (TaskId task : send.tasks) world_.note("send", static_cast<int>(send.signal), task.index, send.command);
  const bool is_roll_back = world_.judge->sent(send);
  const bool leaves_on = world_.defect == Defect::kLeavesOn && is_roll_back;
  const bool believes =
      world_.defect == Defect::kBelievesOffEarly && send.signal == Signal::kOff && !is_roll_back;
  if (leaves_on || believes) {
    for (TaskId task : send.tasks) {
      believed_.push_back(TaskSeen{task, {State::kOff, false, 0}});
      believed_.push_back(Reported{send.command, task, send.signal, true, Refusal::kNone, State::kOn, State::kOff, {}});
    }
  }
  if (!leaves_on)
    world_.processes[send.rtpu.index]->receive({send.command, life_, send.signal, send.tasks});
}

void ManagerLoop::answer(const subsystem::CommandAnswer& answer) {
  world_.tally.count(answer.is_accepted() ? "action answer yes" : "action answer no");
  world_.trace.note(world_.now(), "answer", {static_cast<std::int64_t>(answer.id), answer.is_accepted()},
                    answer.refusal.text());
  const auto is_it = [&](const auto& one) { return one.first == answer.id; };
  const auto asked = std::find_if(asked_.begin(), asked_.end(), is_it);
  if (asked == asked_.end()) return world_.fail("a command was answered twice, or without a face that asked");
  Face& face = *world_.faces[asked->second];
  asked_.erase(asked);
  face.answered(answer);
  world_.judge->answered(answer, face);
}

void ManagerLoop::tell(const LogEvent& tell) {
  world_.tally.count("action tell");
  world_.tally.count("tell " + tell.kind);
  world_.trace.note(world_.now(), tell.kind, {}, tell.text);
  world_.judge->told(tell);
}

}  // namespace chimera::simulated
