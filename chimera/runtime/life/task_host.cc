// SPDX-License-Identifier: Apache-2.0
// Answers the calls of a component to the framework while one of its methods runs.
#include "chimera/runtime/life/task_host.h"

#include <cstring>

#include "chimera/base/mechanisms.h"
#include "chimera/base/message.h"
#include "chimera/runtime/life/task_set.h"

namespace chimera {
namespace {

const TaskHost& host_of(void* context) noexcept { return *static_cast<const TaskHost*>(context); }

JobClock& clock_of(const TaskHost& host) noexcept {
  return host.clock != nullptr ? *host.clock : *host.set->methods().clock();
}

std::int32_t host_expired(void* context) {
  const TaskHost& host = host_of(context);
  if (host.task->give_up.load(std::memory_order_relaxed)) return 1;
  return clock_of(host).now().count > host.task->call.deadline_ns ? 1 : 0;
}

TaskId task_named(std::string_view name, std::span<const TaskSpec> tasks) noexcept {
  for (std::size_t t = 0; t < tasks.size(); ++t)
    if (tasks[t].name == name) return TaskId(t);
  return TaskId{};
}

std::int32_t host_signal(void* context, std::uint32_t signal, const char* name) {
  if constexpr (!mechanisms::kSignals) return CHIMERA_FAULT;
  const TaskHost& host = host_of(context);
  const TaskId target = name == nullptr ? host.task->id : task_named(name, host.set->spec().tasks);
  if (!target.is_valid() || signal > CHIMERA_SIGNAL_WAKEUP) return CHIMERA_FAULT;
  if (signal == CHIMERA_SIGNAL_WAKEUP && !host.set->spec().tasks[target.index].has_doorbell()) return CHIMERA_FAULT;
  host.task->has_news = true;
  return host.task->outbox.try_push({static_cast<Signal>(signal), target}) ? CHIMERA_OK : CHIMERA_FAULT;
}

void host_spend(void* context, std::int64_t ns) { clock_of(host_of(context)).spend(Nanoseconds{ns}); }

void host_note(void* context, const char* text) { record_note(*host_of(context).task, text); }

// Says once for each task why its requests are refused.
std::int32_t refuse_request(void* context, const char* name, std::string_view why) {
  Task& task = *host_of(context).task;
  if (task.requests_refused < UINT8_MAX) ++task.requests_refused;
  if (task.requests_refused > 1) return CHIMERA_FAULT;
  const Message message = Message(has_lists(name) ? "asks for '" : "asks for the configuration '") << name
                                                                                                   << "': " << why;
  host_note(context, FixedString<CHIMERA_FAULT_TEXT - 1>(message.view()).c_str());
  return CHIMERA_FAULT;
}

std::int32_t request_lists(void* context, const char* text) {
  const TaskHost& host = host_of(context);
  SentSignals& sent = host.set->sent();
  TaskLists lists;
  const auto find = [&host](std::string_view name) { return task_named(name, host.set->spec().tasks); };
  const ListsFault fault = read_lists(text, find, lists);
  if (fault.kind == ListsFault::Kind::kUnknownTask)
    return refuse_request(context, text, (Message("there is no task '") << fault.word << "'").view());
  if (fault) return refuse_request(context, text, "expected '--on TASK... --off TASK...'");
  TaskLists* const kept = sent.takes_requests() ? sent.lists_of(host.task->id) : nullptr;
  if (kept == nullptr) return refuse_request(context, text, "requests are not taken here");
  *kept = lists;
  host.task->requested_set = kListsRequested;
  host.task->has_news = true;
  return CHIMERA_OK;
}

std::int32_t host_request(void* context, const char* name) {
  if constexpr (!mechanisms::kSignals) return CHIMERA_FAULT;
  if constexpr (!mechanisms::kSwitch) return refuse_request(context, name, "requests are not taken here");
  if (has_lists(name)) return request_lists(context, name);
  const TaskHost& host = host_of(context);
  const auto sets = host.set->spec().sets;
  std::uint32_t set = 0;
  while (set < sets.size() && sets[set].name != name) ++set;
  if (set == sets.size()) return refuse_request(context, name, "there is none of this name");
  if (sets.size() == 1) return refuse_request(context, name, "it is the only one");
  if (!host.set->sent().takes_requests())
    return refuse_request(context, name, "requests are not taken here");
  host.task->requested_set = static_cast<std::uint16_t>(set);
  host.task->has_news = true;
  return CHIMERA_OK;
}

const PortSpec* spec_of(void* context, const chimera_port* port) noexcept {
  const TaskHost& host = host_of(context);
  return host.set->memory(host.task->id).spec_of(port);
}

chimera_text host_variable(void* context, const chimera_port* port) {
  const PortSpec* spec = spec_of(context, port);
  if (spec == nullptr) return {"", 0};
  const std::string_view name = host_of(context).set->spec().link_name(*spec);
  return {name.data(), static_cast<std::uint32_t>(name.size())};
}

chimera_text host_unit(void* context, const chimera_port* port) {
  const PortSpec* spec = spec_of(context, port);
  if (spec == nullptr) return {"", 0};
  return {spec->unit.data(), static_cast<std::uint32_t>(spec->unit.size())};
}

chimera_text host_configuration(void* context) {
  TaskSet& set = *host_of(context).set;
  const std::uint32_t number = set.flag().configuration();
  const std::string_view name = number < set.spec().sets.size() ? set.spec().sets[number].name : std::string_view{};
  return {name.data(), static_cast<std::uint32_t>(name.size())};
}

SafeFrames* frames_of(void* context) noexcept {
  return mechanisms::kPeers ? host_of(context).set->place().safe_frames : nullptr;
}

std::int32_t host_safe_frame(void* context, std::uint32_t index, std::int32_t descriptor, std::int64_t pause_ns) {
  SafeFrames* frames = frames_of(context);
  if (frames == nullptr || index >= kSafeFrames) return CHIMERA_FAULT;
  return frames->keep(host_of(context).task->id, index, descriptor, {pause_ns}) ? CHIMERA_OK : CHIMERA_FAULT;
}

std::int32_t host_safe_bytes(void* context, std::uint32_t index, const void* bytes, std::uint32_t size) {
  SafeFrames* frames = frames_of(context);
  if (index >= kSafeFrames || size > kSafeBytes) return CHIMERA_FAULT;
  if (frames == nullptr) return CHIMERA_OK;
  frames->of(host_of(context).task->id)[index].put({static_cast<const std::byte*>(bytes), size});
  return CHIMERA_OK;
}

std::uint32_t host_incarnation(void* context) { return host_of(context).set->place().incarnation; }

}  // namespace

const chimera_host TaskHost::kCalls = {&host_expired,    &host_signal,        &host_spend,   &host_note,
                                       &host_variable,   &host_unit,          &host_request, &host_safe_frame,
                                       &host_safe_bytes, &host_configuration, &host_incarnation};

}  // namespace chimera
