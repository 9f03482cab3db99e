// SPDX-License-Identifier: Apache-2.0
// Runs the rows, faults and bad inputs of a test inside the child.
#include "chimera/component_test/scenarios.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "chimera/component_test/judge_values.h"
#include "chimera/platform/allocation_count.h"
#include "chimera/platform/process_state.h"

namespace chimera::component_test {
namespace {

constexpr int kTries = 8;  // signals that a task may need to return to ON
constexpr std::size_t kBadRows = 5;
constexpr std::size_t kGoodRows = 100;
constexpr std::size_t kLastRows = 10;  // of the rows; these must be finite

void refuse(Record& record, const char* text) { std::snprintf(record.refusal, sizeof record.refusal, "%s", text); }

std::unique_ptr<SingleTask> begin(const Scenario& scenario) {
  Record& record = scenario.record.record();
  record.stage = Stage::kLoad;
  auto task = SingleTask::create(scenario.entry, scenario.configuration, scenario.form, record);
  if (!task) {
    refuse(record, std::string(task.error().message.view()).c_str());
    return nullptr;
  }
  watch_allocations();
  record.stage = Stage::kStart;
  return *std::move(task);
}

/// Brings the task from any state to ON, with as few signals as possible; returns the way.
Return revive(SingleTask& task, Trouble* trouble) {
  Return how = Return::kAtOnce;
  const auto at_least = [&how](Return means) { how = std::max(how, means); };
  for (int i = 0; i < kTries; ++i) {
    switch (task.state()) {
      case State::kOn:
        return how;
      case State::kOff:
        at_least(Return::kByOn);
        task.signal(Signal::kOn);
        break;
      case State::kNotCreated:
        at_least(Return::kBySpawn);
        task.signal(Signal::kSpawn);
        break;
      case State::kError:
        at_least(Return::kByClear);
        if (task.signal(Signal::kClear) != State::kError) break;
        if (trouble != nullptr) trouble->refused_clear = true;
        task.signal(Signal::kKill);
    }
  }
  return task.state() == State::kOn ? how : Return::kNot;
}

void note_rejected(const SingleTask& task, Record& record, std::size_t row) {
  if (record.rejected++ > 0) return;
  record.first_rejected = static_cast<std::uint32_t>(row);
  std::memcpy(record.first_text, task.fault_text(), sizeof record.first_text);
}

void run_rows(const Scenario& scenario, SingleTask& task) {
  Record& record = scenario.record.record();
  record.stage = Stage::kRows;
  for (std::size_t i = 0; i < scenario.inputs.rows(); ++i) {
    record.row = static_cast<std::uint32_t>(i);
    task.feed(scenario.inputs.row(i));
    if (task.state() != State::kOn) {
      const Return how = revive(task, nullptr);
      if (how == Return::kNot) return;
      if (how == Return::kBySpawn) ++record.lost;
    }
    RowRecord& row = scenario.record.rows()[i];
    row = task.cycle();
    if (static_cast<Answer>(row.answer) == Answer::kFault) note_rejected(task, record, i);
    task.copy_outputs(scenario.record.outputs(i));
  }
}

/// Disturbs one task again and again.
class Troubles {
 public:
  Troubles(const Scenario& scenario, std::span<const RowRecord> good, SingleTask& task)
      : scenario_(scenario), record_(scenario.record.record()), task_(task), outputs_(scenario.record.outputs(0)) {
    for (std::size_t i = 0; i < good.size() && rows_.size() < kGoodRows; ++i)
      if (good[i].is_run && static_cast<Answer>(good[i].answer) == Answer::kOk) rows_.push_back(i);
    if (rows_.empty()) rows_.push_back(0);
  }

  void faults() {
    record_.stage = Stage::kFaults;
    for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m)
      if (task_.component().has(m)) fault(m);
  }
  void bad_inputs() {
    record_.stage = Stage::kBadInputs;
    for (std::size_t kind = 0; kind < kBadInputs; ++kind) bad_input(kind);
  }
  void safe_state() {
    record_.stage = Stage::kSafeState;
    const std::vector<std::size_t> places = safe_places();
    if (places.empty() || revive(task_, nullptr) == Return::kNot) return;
    const auto are_all = [&](bool expected) {
      run_good(1);
      task_.copy_outputs(outputs_);
      return std::ranges::all_of(places, [&](std::size_t at) { return outputs_[at] != std::byte{0}; }) == expected;
    };
    const auto most = static_cast<std::uint32_t>(seconds(5).count / task_.task().spec->period.count) + 2;
    record_.safe_state.is_tried = true;
    run_good(kBadRows);
    task_.raise_flag(true);
    for (std::uint32_t n = 1; n <= most && record_.safe_state.cycles == 0; ++n)
      if (are_all(true)) record_.safe_state.cycles = n;
    task_.raise_flag(false);
    for (std::uint32_t n = 1; n <= most && !record_.safe_state.is_left; ++n)
      record_.safe_state.is_left = are_all(false);
  }
  void leftovers() {
    record_.stage = Stage::kLeftovers;
    Descriptors before;
    for (std::size_t i = 0; i < kRounds; ++i) {
      if (task_.state() != State::kNotCreated) task_.signal(Signal::kKill);
      const Descriptors after = open_descriptors();
      record_.rounds[i] = {live_allocations(), static_cast<std::uint32_t>(after.names.size()), threads()};
      if (i + 1 == kRounds) name_first_new(before, after, record_.left_open);
      before = after;
      revive(task_, nullptr);
      run_good(kLastRows);
    }
    task_.signal(Signal::kKill);
  }

 private:
  /// Cycles with rows that were accepted before; returns the number of completed cycles.
  std::size_t run_good(std::size_t n, Trouble* trouble = nullptr) {
    std::size_t completed = 0;
    for (std::size_t i = 0; i < n; ++i) {
      task_.feed(scenario_.inputs.row(rows_[i % rows_.size()]));
      if (task_.state() != State::kOn && revive(task_, trouble) == Return::kNot) return completed;
      const RowRecord row = task_.cycle();
      if (static_cast<Answer>(row.answer) != Answer::kFault) ++completed;
      if (trouble == nullptr || i + kLastRows < n) continue;
      trouble->is_finite = trouble->is_finite && are_finite();
    }
    return completed;
  }
  /// The places of the outputs that are a safe state.
  std::vector<std::size_t> safe_places() const {
    std::vector<std::size_t> places;
    std::size_t payload = 0;
    for (const OutputPlace& place : output_places(scenario_.configuration.spec(), payload))
      if (scenario_.entry.descriptor.ports[place.spec->declared].safe_state) places.push_back(place.offset);
    return places;
  }
  bool are_finite() {
    task_.copy_outputs(outputs_);
    std::uint32_t counts[CHIMERA_MAX_PORTS] = {};
    task_.copy_counts(counts);
    return !first_unsound(scenario_.configuration, scenario_.entry.descriptor, counts, outputs_, ~std::uint64_t{0},
                          false);
  }

  // Makes the framework call the method, with the task ON.
  void provoke(std::uint32_t method) {
    switch (method) {
      case CHIMERA_INIT:
        task_.signal(Signal::kKill);
        task_.signal(Signal::kSpawn);
        return;
      case CHIMERA_ON:
        task_.signal(Signal::kOff);
        task_.signal(Signal::kOn);
        return;
      case CHIMERA_OFF:
        task_.signal(Signal::kOff);
        return;
      case CHIMERA_KILL:
        task_.signal(Signal::kKill);
        return;
      case CHIMERA_REINIT:
        task_.signal(Signal::kReinit);
        return;
      default:
        break;
    }
    if (method == CHIMERA_ERROR || method == CHIMERA_CLEAR) task_.component().fail_next(CHIMERA_CYCLE);
    if (method == CHIMERA_CLEAR && task_.component().has(CHIMERA_ERROR)) task_.component().fail_next(CHIMERA_ERROR);
    for (int i = 0; i < kTries && task_.state() == State::kOn && !task_.component().has_failed(method); ++i) {
      task_.feed(scenario_.inputs.row(rows_[0]));
      task_.cycle();
    }
    if (method == CHIMERA_CLEAR && task_.state() == State::kError) task_.signal(Signal::kClear);
  }
  void fault(std::uint32_t method) {
    Trouble& trouble = record_.faults[method];
    trouble.is_tried = true;
    record_.row = method;
    if (revive(task_, nullptr) == Return::kNot) return;
    run_good(kBadRows);
    if (task_.state() != State::kOn) return;
    task_.component().fail_next(method);
    provoke(method);
    trouble.has_happened = task_.component().has_failed(method);
    trouble.after = task_.state();
    trouble.how = revive(task_, &trouble);
    if (trouble.how != Return::kNot && run_good(2 * kLastRows, &trouble) == 0) trouble.how = Return::kNot;
    std::memcpy(trouble.text, task_.fault_text(), sizeof trouble.text);
  }
  void bad_input(std::size_t kind) {
    Trouble& trouble = record_.bad_inputs[kind];
    record_.row = static_cast<std::uint32_t>(kind);
    const auto good = scenario_.inputs.row(rows_[0]);
    std::vector<std::byte> row(good.begin(), good.end());
    trouble.is_tried = spoil(scenario_.form, kind, row);
    if (!trouble.is_tried || revive(task_, nullptr) == Return::kNot) return;
    run_good(kBadRows);
    for (std::size_t i = 0; i < kBadRows; ++i) {
      if (task_.state() != State::kOn) run_good(1);
      if (task_.state() != State::kOn) break;
      task_.feed(row);
      const RowRecord cycle = task_.cycle();
      trouble.has_happened = true;
      if (static_cast<Answer>(cycle.answer) != Answer::kFault || trouble.is_rejected) continue;
      trouble.is_rejected = true;
      std::memcpy(trouble.text, task_.fault_text(), sizeof trouble.text);
    }
    trouble.after = task_.state();
    task_.feed(good);
    trouble.how = revive(task_, &trouble);
    if (trouble.how != Return::kNot && run_good(kGoodRows, &trouble) == 0) trouble.how = Return::kNot;
  }

  const Scenario& scenario_;
  Record& record_;
  SingleTask& task_;
  std::span<std::byte> outputs_;
  std::vector<std::size_t> rows_;
};

}  // namespace

void run_inputs(const Scenario& scenario) {
  Record& record = scenario.record.record();
  const auto task = begin(scenario);
  if (!task) return;
  if (scenario.inputs.rows() > 0) task->feed(scenario.inputs.row(0));
  if (task->signal(Signal::kSpawn) != State::kOff || task->signal(Signal::kOn) != State::kOn)
    return refuse(record, task->fault_text());
  task->copy_counts(record.counts);
  run_rows(scenario, *task);
  record.stage = Stage::kStop;
  if (task->state() == State::kOn) task->signal(Signal::kOff);
  if (task->state() != State::kNotCreated) task->signal(Signal::kKill);
  record.stage = Stage::kEnd;
}

void run_faults(const Scenario& scenario, std::span<const RowRecord> good) {
  const auto task = begin(scenario);
  if (!task) return;
  if (scenario.inputs.rows() > 0) task->feed(scenario.inputs.row(0));
  if (revive(*task, nullptr) == Return::kNot) return refuse(scenario.record.record(), task->fault_text());
  Troubles troubles(scenario, good, *task);
  troubles.faults();
  troubles.bad_inputs();
  troubles.safe_state();
  troubles.leftovers();
  scenario.record.record().stage = Stage::kEnd;
}

}  // namespace chimera::component_test
