// SPDX-License-Identifier: Apache-2.0
// Writes the values of variables, and the reasons for them, as JSON.
#include "chimera/manager/answer/value_json.h"

#include <algorithm>
#include <cmath>

#include "chimera/analysis/link_age.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/descriptor_value.h"
#include "chimera/manager/answer/status_json.h"
#include "chimera/platform/realtime.h"
#include "chimera/text/json.h"
#include "chimera/text/value_renderer.h"

namespace chimera::manager {
namespace {

/// A text for people, cut after a hundred numbers.
std::string short_text(const ValueForm& form, std::span<const std::byte> bytes) {
  constexpr std::size_t kValues = 100;
  std::string text;
  if (!ValueRenderer(form, bytes, ValueRenderer::As::kText).append_to(text, kValues)) return text;
  return text + " ...: " + std::to_string(form.count) + " elements";
}

bool is_finite(const ValueForm& form, std::span<const std::byte> bytes) {
  const std::vector<double> all = numbers(form, bytes);
  return std::all_of(all.begin(), all.end(), [](double n) { return std::isfinite(n); });
}

/// NaN and infinity become null when the JSON is written.
Json plain_of(std::uint32_t type, std::span<const std::byte> at) {
  return std::visit([](const auto& value) { return Json(value); }, load_plain(type, at));
}

Json element_of(const ValueForm& form, std::span<const std::byte> at) {
  if (form.type != CHIMERA_STRUCT) return plain_of(form.type, at.first(form.element_bytes));
  Json fields = Json::object();
  for (const FieldDescriptor& field : form.fields) {
    Json values = Json::array();
    for (std::uint32_t i = 0; i < field.count; ++i)
      values.push_back(plain_of(field.type, at.subspan(field.offset + i * field.size, field.size)));
    fields[field.name] = field.count == 1 ? values[0] : std::move(values);
  }
  return fields;
}

std::string producer_name(const ManagerState& state, VariableId variable, TaskId producer) {
  if (producer.is_valid()) return state.name(producer);
  return state.readings->is_operators(variable) ? "operator" : "";
}

std::string state_text(const ManagerState& state, VariableId variable, TaskId producer) {
  if (producer.is_valid()) return state_name(state.state(producer));
  return state_name(state.readings->is_operators(variable) ? State::kOn : State::kNotCreated);
}

/// The only candidate, or the one that wrote last; invalid: there are several, and none was ever created.
TaskId likely_producer(const ManagerState& state, VariableId variable) {
  const TaskId producer = state.readings->producer(variable);
  const auto& candidates = state.readings->variables().all()[variable.index].producers;
  return producer.is_valid() || candidates.size() != 1 ? producer : candidates[0].task;
}

/// Counts in the order of gravity.
std::string timing_text(const Profile& p) {
  const std::pair<std::uint64_t, const char*> counts[] = {
      {p.missed, "missed"},        {p.dropped, "dropped"},           {p.overrun, "over budget"},
      {p.demoted, "demoted"},      {p.exhausted, "out of capacity"}, {p.events_lost, "events lost"},
      {p.aborted, "aborted"},      {p.held, "held"},                 {p.partial, "partial"},
      {p.tolerated, "tolerated"}};
  std::string text;
  for (const auto& [count, word] : counts)
    if (count > 0) append_joined(text, ", ", std::to_string(count) + " " + word);
  return text;
}

void add_producer(const ManagerState& state, TaskId task, VariableFacts& facts) {
  const TaskSpec& spec = state.spec().tasks[task.index];
  const RtpuRecord& rtpu = state.rtpus[spec.rtpu.index];
  facts.task = task;
  facts.producer = spec.name;
  facts.component = spec.component;
  facts.rtpu = state.name(spec.rtpu);
  facts.state = state.state(task);
  facts.is_rtpu_dead = !rtpu.is_alive;
  facts.last_words = rtpu.is_alive ? fault_text(state, task) : facts.rtpu + " " + rtpu.last_end;
  facts.period = spec.aperiodic ? Nanoseconds{} : spec.period;
  if (const PeerSegment& segment = state.peers[spec.rtpu]; segment.is_there()) {
    const Profile profile = segment.block().profile(task);
    facts.timing = timing_text(profile);
    if (rtpu.is_alive && !rtpu.lost_rights.empty())
      append_joined(facts.timing, ", ", facts.rtpu + ": " + rtpu.lost_rights);
    const char* grant = segment.block().head().grant;
    if (const auto why = not_real_time({grant, ::strnlen(grant, sizeof BlockHead::grant)});
        rtpu.is_alive && !facts.timing.empty() && !why.view().empty())
      append_joined(facts.timing, ", ", facts.rtpu + " is not real time: " + why.c_str());
    facts.waits_for_events = spec.has_doorbell() && profile.events == 0;
  }
  for (const PortSpec& port : spec.ports)
    if (port.kind == CHIMERA_IN_VAR) facts.inputs.emplace_back(state.spec().link_name(port));
}

/// The shortest stale_after of its readers; 0: none states one.
Nanoseconds patience(const ManagerState& state, VariableId variable) {
  Nanoseconds shortest;
  for (const PortOf& reader : state.readings->variables().all()[variable.index].consumers) {
    const auto& limit = state.configuration->draft().tasks[reader.task.index].stale_after;
    if (limit && (shortest.count == 0 || limit->value < shortest)) shortest = limit->value;
  }
  return shortest;
}

VariableFacts facts_of(const ManagerState& state, VariableId variable, Nanoseconds at) {
  const VariableReading reading = state.readings->read(variable);
  VariableFacts facts;
  facts.variable = state.readings->configured(variable).name;
  facts.stale_after = patience(state, variable);
  facts.is_written = reading.is_valid;
  facts.published = {reading.slot.published_ns};
  facts.age = reading.age(std::max(at, now()));  // it may be younger than the question
  facts.is_finite = is_finite(reading.form, reading.value);
  facts.value = short_text(reading.form, reading.value);
  if (state.readings->is_operators(variable)) {
    facts.producer = "operator";
    facts.state = State::kOn;
    facts.stale_after = {};
  } else if (const TaskId producer = likely_producer(state, variable); producer.is_valid()) {
    add_producer(state, producer, facts);
  }
  return facts;
}

/// Why the task by which the variable came into the chain reads it a period late; empty: it does not.
std::string late_of(const ManagerState& state, std::span<const WhyLink> chain, const WhyLink& link) {
  const auto reads_it = [&](const WhyLink& each) {
    return std::ranges::count(each.facts.inputs, link.facts.variable) > 0;
  };
  const auto reader = std::ranges::find_if(chain, reads_it);
  if (link.depth == 0 || reader == chain.end() || !link.facts.task.is_valid()) return {};
  if (reader->facts.task == link.facts.task) return {};
  return late_text(state.spec(), link.facts.task, reader->facts.task);
}

Json link_json(const WhyLink& link, const std::string& late) {
  const VariableFacts& f = link.facts;
  return {{"depth", link.depth},
          {"variable", f.variable},
          {"producer", f.producer},
          {"component", f.component},
          {"rtpu", f.rtpu},
          {"state", state_name(f.state)},
          {"period_ns", f.period.count},
          {"published_ns", f.published.count},
          {"age_ns", f.age.count},
          {"valid", f.is_written},
          {"value", f.value},
          {"verdict", trouble_name(link.trouble)},
          {"timing", f.timing},
          {"late", late},
          {"inputs", f.inputs}};
}

}  // namespace

Json value_of(const ValueForm& form, std::span<const std::byte> bytes) {
  if (form.is_scalar) return element_of(form, bytes);
  Json list = Json::array();
  for (std::uint32_t i = 0; i < form.count; ++i)
    list.push_back(element_of(form, bytes.subspan(std::size_t{i} * form.element_bytes, form.element_bytes)));
  return list;
}

Json reading_head_json(const ManagerState& state, VariableId variable, const VariableReading& reading,
                       Nanoseconds at) {
  const ConfiguredVariable& known = state.readings->configured(variable);
  Json head = {{"unit", known.unit},
               {"type", known.type},
               {"shape", known.shape},
               {"producer", producer_name(state, variable, reading.producer)},
               {"state", state_text(state, variable, reading.producer)},
               {"published_ns", reading.slot.published_ns},
               {"age_ns", reading.age(at).count},
               {"sequence", reading.slot.sequence},
               {"valid", reading.is_valid}};
  if (reading.is_valid) return head;
  head["value"] = nullptr;
  head["text"] = "never written";
  return head;
}

Json reading_json(const ManagerState& state, VariableId variable, Nanoseconds at) {
  const VariableReading reading = state.readings->read(variable);
  Json json = reading_head_json(state, variable, reading, at);
  if (!reading.is_valid) return json;
  json["value"] = value_of(reading.form, reading.value);
  json["text"] = value_text(reading.form, reading.value);
  return json;
}

Json readings_json(const ManagerState& state, std::span<const VariableId> variables, Nanoseconds at) {
  Json values = Json::object();
  for (const VariableId variable : variables)
    values[state.readings->configured(variable).name] = reading_json(state, variable, at);
  return values;
}

Json why_json(const ManagerState& state, VariableId variable, Nanoseconds at) {
  const Why answer = why(state.readings->configured(variable).name, [&](std::string_view name) {
    return facts_of(state, *state.readings->find(name), at);
  });
  Json chain = Json::array();
  for (const WhyLink& link : answer.chain) chain.push_back(link_json(link, late_of(state, answer.chain, link)));
  return {{"variable", answer.chain[0].facts.variable}, {"chain", std::move(chain)}, {"verdict", answer.verdict}};
}

}  // namespace chimera::manager
