// SPDX-License-Identifier: Apache-2.0
// Goes through the rows, faults and bad inputs of a test run inside of the child.
#include "chimera/trial/plays.h"

#include <cmath>
#include <cstdio>
#include <cstring>

#include "chimera/platform/allocation_count.h"
#include "chimera/trial/judge_values.h"
#include "chimera/platform/open_resources.h"

namespace chimera::trial {
namespace {

constexpr int kTries = 8;           // signals that a task may need to come back
constexpr std::size_t kBadRows = 5;
constexpr std::size_t kGoodRows = 100;
constexpr std::size_t kLastRows = 10;  // of them, which must be finite

void refuse(Record& record, const char* text) {
  std::snprintf(record.refusal, sizeof record.refusal, "%s", text);
}

std::unique_ptr<Solo> begin(const Play& play) {
  Record& record = play.record.record();
  record.stage = Stage::kLoad;
  auto solo = Solo::create(play.entry, play.configuration, play.form, record);
  if (!solo) {
    refuse(record, std::string(solo.error().message.view()).c_str());
    return nullptr;
  }
  watch_allocations();
  record.stage = Stage::kStart;
  return *std::move(solo);
}

/// Brings the task ON from whatever state it is in, by the mildest means; how it went.
Return revive(Solo& solo, Trouble* trouble) {
  Return how = Return::kAtOnce;
  const auto at_least = [&how](Return means) { how = std::max(how, means); };
  for (int i = 0; i < kTries; ++i) {
    switch (solo.state()) {
      case State::kOn: return how;
      case State::kOff:
        at_least(Return::kByOn);
        solo.signal(Signal::kOn);
        break;
      case State::kNotCreated:
        at_least(Return::kBySpawn);
        solo.signal(Signal::kSpawn);
        break;
      case State::kError:
        at_least(Return::kByClear);
        if (solo.signal(Signal::kClear) != State::kError) break;
        if (trouble != nullptr) trouble->refused_clear = true;
        solo.signal(Signal::kKill);
    }
  }
  return solo.state() == State::kOn ? how : Return::kNot;
}

void note_rejected(const Solo& solo, Record& record, std::size_t row) {
  if (record.rejected++ > 0) return;
  record.first_rejected = static_cast<std::uint32_t>(row);
  std::memcpy(record.first_text, solo.fault_text(), sizeof record.first_text);
}

void run_rows(const Play& play, Solo& solo) {
  Record& record = play.record.record();
  record.stage = Stage::kRows;
  for (std::size_t i = 0; i < play.inputs.rows(); ++i) {
    record.row = static_cast<std::uint32_t>(i);
    solo.feed(play.inputs.row(i));
    if (solo.state() != State::kOn) {
      const Return how = revive(solo, nullptr);
      if (how == Return::kNot) return;
      if (how == Return::kBySpawn) ++record.lost;
    }
    RowRecord& row = play.record.rows()[i];
    row = solo.cycle();
    if (static_cast<Answer>(row.answer) == Answer::kFault) note_rejected(solo, record, i);
    solo.copy_outputs(play.record.outputs(i));
  }
}

/// Plays troubles on one task, again and again.
class Troubles {
 public:
  Troubles(const Play& play, std::span<const RowRecord> good, Solo& solo)
      : play_(play), record_(play.record.record()), solo_(solo), outputs_(play.record.outputs(0)) {
    for (std::size_t i = 0; i < good.size() && rows_.size() < kGoodRows; ++i)
      if (good[i].is_run && static_cast<Answer>(good[i].answer) == Answer::kOk) rows_.push_back(i);
    if (rows_.empty()) rows_.push_back(0);
  }

  void faults() {
    record_.stage = Stage::kFaults;
    for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m)
      if (solo_.shim().has(m)) fault(m);
  }
  void bad_inputs() {
    record_.stage = Stage::kBadInputs;
    for (std::size_t kind = 0; kind < kBadInputs; ++kind) bad_input(kind);
  }
  void leftovers() {
    record_.stage = Stage::kLeftovers;
    Descriptors before;
    for (std::size_t i = 0; i < kRounds; ++i) {
      if (solo_.state() != State::kNotCreated) solo_.signal(Signal::kKill);
      const Descriptors after = open_descriptors();
      record_.rounds[i] = {live_allocations(), static_cast<std::uint32_t>(after.names.size()), threads()};
      if (i + 1 == kRounds) name_first_new(before, after, record_.left_open);
      before = after;
      revive(solo_, nullptr);
      run_good(kLastRows);
    }
    solo_.signal(Signal::kKill);
  }

 private:
  /// Cycles with rows that were accepted before; the number of cycles completed.
  std::size_t run_good(std::size_t n, Trouble* trouble = nullptr) {
    std::size_t completed = 0;
    for (std::size_t i = 0; i < n; ++i) {
      solo_.feed(play_.inputs.row(rows_[i % rows_.size()]));
      if (solo_.state() != State::kOn && revive(solo_, trouble) == Return::kNot) return completed;
      const RowRecord row = solo_.cycle();
      if (static_cast<Answer>(row.answer) != Answer::kFault) ++completed;
      if (trouble == nullptr || i + kLastRows < n) continue;
      trouble->is_finite = trouble->is_finite && are_finite();
    }
    return completed;
  }
  bool are_finite() {
    solo_.copy_outputs(outputs_);
    std::uint32_t counts[CHIMERA_MAX_PORTS] = {};
    solo_.copy_counts(counts);
    return !first_unsound(play_.configuration, play_.entry.descriptor, counts, outputs_, ~std::uint64_t{0}, false);
  }

  // What leads to the method, with the task ON.
  void provoke(std::uint32_t method) {
    switch (method) {
      case CHIMERA_INIT:
        solo_.signal(Signal::kKill);
        solo_.signal(Signal::kSpawn);
        return;
      case CHIMERA_ON:
        solo_.signal(Signal::kOff);
        solo_.signal(Signal::kOn);
        return;
      case CHIMERA_OFF: solo_.signal(Signal::kOff); return;
      case CHIMERA_KILL: solo_.signal(Signal::kKill); return;
      case CHIMERA_REINIT: solo_.signal(Signal::kReinit); return;
      default: break;
    }
    if (method == CHIMERA_ERROR || method == CHIMERA_CLEAR) solo_.shim().fail_next(CHIMERA_CYCLE);
    if (method == CHIMERA_CLEAR && solo_.shim().has(CHIMERA_ERROR)) solo_.shim().fail_next(CHIMERA_ERROR);
    for (int i = 0; i < kTries && solo_.state() == State::kOn && !solo_.shim().has_failed(method); ++i) {
      solo_.feed(play_.inputs.row(rows_[0]));
      solo_.cycle();
    }
    if (method == CHIMERA_CLEAR && solo_.state() == State::kError) solo_.signal(Signal::kClear);
  }
  void fault(std::uint32_t method) {
    Trouble& trouble = record_.faults[method];
    trouble.is_tried = true;
    record_.row = method;
    if (revive(solo_, nullptr) == Return::kNot) return;
    run_good(kBadRows);
    if (solo_.state() != State::kOn) return;
    solo_.shim().fail_next(method);
    provoke(method);
    trouble.has_happened = solo_.shim().has_failed(method);
    trouble.after = solo_.state();
    trouble.how = revive(solo_, &trouble);
    if (trouble.how != Return::kNot && run_good(2 * kLastRows, &trouble) == 0) trouble.how = Return::kNot;
    std::memcpy(trouble.text, solo_.fault_text(), sizeof trouble.text);
  }
  void bad_input(std::size_t kind) {
    Trouble& trouble = record_.bad_inputs[kind];
    record_.row = static_cast<std::uint32_t>(kind);
    const auto good = play_.inputs.row(rows_[0]);
    std::vector<std::byte> row(good.begin(), good.end());
    trouble.is_tried = spoil(play_.form, kind, row);
    if (!trouble.is_tried || revive(solo_, nullptr) == Return::kNot) return;
    run_good(kBadRows);
    for (std::size_t i = 0; i < kBadRows; ++i) {
      if (solo_.state() != State::kOn) run_good(1);
      if (solo_.state() != State::kOn) break;
      solo_.feed(row);
      const RowRecord cycle = solo_.cycle();
      trouble.has_happened = true;
      if (static_cast<Answer>(cycle.answer) != Answer::kFault || trouble.is_rejected) continue;
      trouble.is_rejected = true;
      std::memcpy(trouble.text, solo_.fault_text(), sizeof trouble.text);
    }
    trouble.after = solo_.state();
    solo_.feed(good);
    trouble.how = revive(solo_, &trouble);
    if (trouble.how != Return::kNot && run_good(kGoodRows, &trouble) == 0) trouble.how = Return::kNot;
  }

  const Play& play_;
  Record& record_;
  Solo& solo_;
  std::span<std::byte> outputs_;
  std::vector<std::size_t> rows_;
};

}  // namespace

void play_inputs(const Play& play) {
  Record& record = play.record.record();
  const auto solo = begin(play);
  if (!solo) return;
  if (play.inputs.rows() > 0) solo->feed(play.inputs.row(0));
  if (solo->signal(Signal::kSpawn) != State::kOff || solo->signal(Signal::kOn) != State::kOn)
    return refuse(record, solo->fault_text());
  solo->copy_counts(record.counts);
  run_rows(play, *solo);
  record.stage = Stage::kStop;
  if (solo->state() == State::kOn) solo->signal(Signal::kOff);
  if (solo->state() != State::kNotCreated) solo->signal(Signal::kKill);
  record.stage = Stage::kEnd;
}

void play_troubles(const Play& play, std::span<const RowRecord> good) {
  const auto solo = begin(play);
  if (!solo) return;
  if (play.inputs.rows() > 0) solo->feed(play.inputs.row(0));
  if (revive(*solo, nullptr) == Return::kNot) return refuse(play.record.record(), solo->fault_text());
  Troubles troubles(play, good, *solo);
  troubles.faults();
  troubles.bad_inputs();
  troubles.leftovers();
  play.record.record().stage = Stage::kEnd;
}

}  // namespace chimera::trial
