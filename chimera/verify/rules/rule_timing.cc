// SPDX-License-Identifier: Apache-2.0
// Rules on rates, deadlines, budgets, offsets and servers.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "chimera/description/cpu_text.h"
#include "chimera/runtime/hosted/together.h"
#include "chimera/schedule/utilisation.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {

std::string say(Nanoseconds t) {
  constexpr struct {
    std::int64_t ns;
    const char* name;
  } kUnits[] = {{1'000'000'000, "s"}, {1'000'000, "ms"}, {1'000, "us"}, {1, "ns"}};
  for (const auto& unit : kUnits) {
    if (t.count < unit.ns && unit.ns != 1) continue;
    char out[40];
    std::snprintf(out, sizeof out, "%.9g %s", static_cast<double>(t.count) / static_cast<double>(unit.ns), unit.name);
    return out;
  }
  return "0 ns";
}

namespace {

void read_rate(Model& model, TaskModel& task) {
  const DraftTask& draft = *task.draft;
  if (draft.server && draft.server->period.value.count > 0) {
    task.period = draft.server->period.value;
    task.rate_hz = 1e9 / static_cast<double>(task.period->count);
    return;
  }
  if (draft.rate) {
    task.period = draft.rate->value.period;
    task.rate_hz = draft.rate->value.hz;
    return;
  }
  if (task.is_partial()) return;
  const double hz = task.component->default_rate_hz;
  if (hz == 0) {
    model.error("rate-missing", draft.name.at,
                "task '" + task.name() + "' has no rate, and component '" + task.component->name + "' has no default",
                {}, "a rate", {}, "write rate: 100 Hz");
    return;
  }
  task.period = Nanoseconds{std::llround(1e9 / hz)};  // describe() bounds the default
  task.rate_hz = hz;
}

/// Checks one duration of one task against its bounds: above (or from) zero, and up to (or below) another.
void check_time(Model& model, const TaskModel& task, const char* key, const std::optional<Located<Nanoseconds>>& time,
                bool may_be_zero, const char* limit_name, std::optional<Nanoseconds> limit, bool may_be_limit) {
  if (!time) return;
  const auto refuse = [&](const std::string& expected) {
    model.error(
        "time-range", time->at,
        "'" + std::string(key) + "' of task '" + task.name() + "' is " + say(time->value) + "; expected " + expected,
        say(time->value), expected);
  };
  if (!may_be_zero && time->value.count == 0) {
    refuse("more than 0");
  } else if (limit && (may_be_limit ? time->value > *limit : time->value >= *limit)) {
    refuse(std::string(may_be_limit ? "at most" : "less than") + " the " + limit_name + ", " + say(*limit));
  }
}

template <class Key>
std::optional<Place> place_of(const std::optional<Key>& key) {
  return key ? std::optional(key->at) : std::nullopt;
}

void check_server(Model& model, const TaskModel& task) {
  const auto& server = task.draft->server;
  if (!server) return;
  const std::optional<Located<Nanoseconds>> capacity = server->capacity, period = server->period;
  check_time(model, task, "period", period, false, "", std::nullopt, true);
  check_time(model, task, "capacity", capacity, false, "server's period", server->period.value, true);
  if (task.component != nullptr && !task.component->is_aperiodic())
    model.error("server-periodic", server->at,
                "task '" + task.name() + "' has a server, and component '" + task.component->name + "' is periodic",
                task.component->name, "an aperiodic component", {}, "take 'server' out, or write a method sync");
  const DraftTask& draft = *task.draft;
  const std::pair<const char*, std::optional<Place>> of_releases[] = {
      {"rate", place_of(draft.rate)},        {"deadline", place_of(draft.deadline)},
      {"offset", place_of(draft.offset)},    {"min", place_of(draft.min_time)},
      {"on_miss", place_of(draft.on_miss)},  {"max_consecutive", place_of(draft.max_consecutive)},
      {"tolerate", place_of(draft.tolerate)}, {"safe_after", place_of(draft.safe_after)}};
  for (const auto& [key, at] : of_releases) {
    if (!at) continue;
    model.error(
        "server-key", *at,
        "task '" + task.name() + "' has a server, and '" + key + "' speaks of releases: it is released by events", key,
        {}, {}, "take '" + std::string(key) + "' out; the server has the capacity and the period");
  }
}

void check_task(Model& model, TaskModel& task) {
  const DraftTask& draft = *task.draft;
  read_rate(model, task);
  check_time(model, task, "deadline", draft.deadline, false, "period", task.period, true);
  const std::optional<Nanoseconds> deadline = draft.deadline ? std::optional(draft.deadline->value) : task.period;
  check_time(model, task, "offset", draft.offset, true, "period", task.period, false);
  check_time(model, task, "budget", draft.budget, false, "deadline", deadline, true);
  const bool has_budget = draft.budget && draft.budget->value.count > 0;
  check_time(model, task, "min", draft.min_time, false, has_budget ? "budget" : "deadline",
             has_budget ? std::optional(draft.budget->value) : deadline, true);
  check_time(model, task, "stale_after", draft.stale_after, false, "", std::nullopt, true);
  check_server(model, task);
  task.deadline = deadline.value_or(Nanoseconds{});
  task.offset = draft.offset ? draft.offset->value : Nanoseconds{};
  task.budget = draft.budget ? draft.budget->value : Nanoseconds{};
  task.min_time = draft.min_time ? draft.min_time->value : Nanoseconds{};
  task.criticality = draft.criticality ? draft.criticality->value : 0;
}

/// The execution time in each period: the budget, or the capacity of a server if it is legal.
Nanoseconds time_of(const TaskModel& task) {
  const auto& server = task.draft->server;
  if (!server) return task.budget;
  return server->capacity.value <= server->period.value ? server->capacity.value : Nanoseconds{};
}

Place place_of_time(const TaskModel& task) {
  return task.draft->server ? task.draft->server->capacity.at : task.draft->budget->at;
}

double load(const TaskModel& task) {
  return task.period ? static_cast<double>(time_of(task).count) / static_cast<double>(task.period->count) : 0;
}

/// True if the task drops work that finds no time before its deadline (on_miss: abort).
bool gives_way(const TaskModel& task) { return task.draft->on_miss && task.draft->on_miss->kind == OnMiss::kAbort; }

/// "the budgets of configuration 'run' with 'spare' for 'pid' take 0.950 of CPU 1".
std::string load_text(const Model& model, const SetModel& set, const Together& together, const char* sum,
                      std::uint32_t cpu) {
  std::string text = "the budgets of configuration '" + set.name + "'";
  if (together.is_takeover())
    text += " with '" + model.tasks[together.standby.index].name() + "' for '" +
            model.tasks[together.primary.index].name() + "'";
  return text + " take " + sum + " of " + cpu_text(cpu);
}

/// Rounds to the first three digits.
Nanoseconds first_digits(double ns) {
  const double unit = std::max(1.0, std::pow(10.0, std::floor(std::log10(std::max(ns, 1.0))) - 2));
  return {std::llround(std::floor(ns / unit * (1 + 1e-12)) * unit)};
}

/// Describes a load that the task could have.
std::string what_fits(const TaskModel& task, double load) {
  const Nanoseconds time = first_digits(load * static_cast<double>(task.period->count));
  const double period_ns = static_cast<double>(time_of(task).count) / load;
  if (task.draft->server)
    return "capacity: " + say(time) + " or period: " + say(Nanoseconds{std::llround(std::ceil(period_ns))});
  char room[64];
  std::snprintf(room, sizeof room, "%.1f", 1e9 / period_ns);
  return "budget: " + say(time) + " or rate: " + room + " Hz";
}

/// False: the tasks exceed the limit of the CPU.
bool limit(Model& model, const SetModel& set, const Together& together, std::uint32_t cpu) {
  double sum = 0;
  bool all_give_way = true;
  std::size_t heaviest = model.tasks.size();
  for (const TaskId id : together.tasks) {
    const TaskModel& task = model.tasks[id.index];
    if (model.rtpus[task.rtpu].cpu.value != cpu) continue;
    sum += load(task);
    all_give_way = all_give_way && gives_way(task);
    if (heaviest == model.tasks.size() || load(task) > load(model.tasks[heaviest])) heaviest = id.index;
  }
  if (!is_beyond(sum)) return true;
  const TaskModel& task = model.tasks[heaviest];
  char found[64];
  std::snprintf(found, sizeof found, "%.3f", sum);
  const std::string taken = load_text(model, set, together, found, cpu);
  if (all_give_way) {
    model.warn("utilisation", Spot(place_of_time(task)).in(set),
               taken + ", more than 0.93: every task says 'on_miss: abort', so what finds no time ends at its deadline",
               "run it in virtual time");
    return false;
  }
  const double fits = kMaxUtilisation - (sum - load(task));
  const std::string message = taken + "; expected at most 0.93";
  const std::string remedy = fits > 0
                                 ? "task '" + task.name() + "' takes most: it would fit with " + what_fits(task, fits)
                                 : "move tasks to another CPU, or lower their rates";
  const Spot spot = Spot(place_of_time(task)).in(set);
  if (model.overload == Overload::kTold) model.warn("utilisation", spot, message, remedy);
  else model.error("utilisation", spot, message, found, "at most 0.93", {}, remedy);
  return false;
}

}  // namespace

void check_times(Model& model) {
  for (TaskModel& task : model.tasks) check_task(model, task);
}

void limit_utilisation(Model& model) {
  for (const SetModel& set : model.sets)
    for (std::size_t i = 0; i < model.rtpus.size(); ++i) {
      bool is_first = true;
      for (std::size_t j = 0; j < i; ++j) is_first = is_first && model.rtpus[j].cpu.value != model.rtpus[i].cpu.value;
      if (!is_first) continue;
      // An excess without a standby is reported only once.
      for (const Together& together : all_together(model.standbys, set.tasks))
        if (!limit(model, set, together, model.rtpus[i].cpu.value)) break;
    }
}

}  // namespace chimera
