// SPDX-License-Identifier: Apache-2.0
// Runs a component in forked children: once under trace, three times timed, and once with faults and bad inputs.
#include "chimera/component_test/trial.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <functional>

#include "chimera/base/message.h"
#include "chimera/catalogue/descriptor_json.h"
#include "chimera/component_test/scenarios.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/forked_child.h"
#include "chimera/platform/shared_memory.h"

namespace chimera::component_test {
namespace {

/// Counts the system calls of watched methods, and detects a child that makes no progress.
class Watcher final : public ChildWatcher {
 public:
  Watcher(Record& record, Nanoseconds patience) : record_(record), patience_(patience) {}

  void calls(std::uint64_t number) noexcept override {
    const std::uint32_t watched = record_.watched.load(std::memory_order_seq_cst);
    if (watched == 0) return;
    MethodRecord& method = record_.methods[watched - 1];
    if (method.system_calls++ == 0) method.first_system_call = number;
  }
  bool has_waited_enough() noexcept override {
    const std::uint64_t progress = record_.progress.load(std::memory_order_relaxed);
    const Nanoseconds now = clock_.now();
    if (progress != seen_ || since_ == Nanoseconds{}) seen_ = progress, since_ = now;
    return now - since_ > patience_;
  }

 private:
  Record& record_;
  Nanoseconds patience_;
  std::uint64_t seen_ = 0;
  LinuxClock clock_;
  Nanoseconds since_;
};

/// Runs in the child.
int live(const std::function<void()>& scenario, Record& record, bool traced) {
  record.is_traced = traced && let_parent_trace();
  try {
    scenario();
  } catch (const std::exception& fault) {  // of the framework: the C++ interface catches those of a component
    std::snprintf(record.refusal, sizeof record.refusal, "%s", fault.what());
    return 1;
  }
  return 0;
}

Result<PlayEnd> run(const std::function<void()>& scenario, Record& record, const TrialOptions& options, bool traced) {
  BlockedChildSignal blocked;
  const auto child = fork_quietly(options.folder, [&] {
    blocked.undo();
    return live(scenario, record, traced);
  });
  if (!child) return child.error();
  PlayEnd end;
  Watcher watcher(record, options.patience);
  end.has_hung = watch_child(*child, watcher, end.process);
  return end;
}

void take_least_times(std::span<const RowRecord> from, std::span<RowRecord> to) {
  for (std::size_t i = 0; i < to.size(); ++i)
    if (from[i].is_run) to[i].time_ns = std::min(to[i].time_ns, from[i].time_ns);
}

// The first cycles warm the caches.
void keep_times(std::span<const RowRecord> rows, std::vector<std::int64_t>& times) {
  for (const RowRecord& row : rows.subspan(rows.size() / 10))
    if (row.is_run && static_cast<Answer>(row.answer) == Answer::kOk) times.push_back(row.time_ns);
}

}  // namespace

Result<Trial> run_trial(const LibraryEntry& entry, const Configuration& configuration, const InputForm& form,
                        const Inputs& inputs, const TrialOptions& options) {
  std::size_t payload = 0;
  (void)output_places(configuration.spec(), payload);
  Trial trial(inputs.rows(), payload);
  const auto scenario_of = [&](const SharedRecord& record) {
    return Scenario{entry, configuration, form, inputs, record};
  };
  auto end = run([&] { run_inputs(scenario_of(trial.counted)); }, trial.counted.record(), options, true);
  if (!end) return end.error();
  trial.counted_end = *end;
  if (end->has_hung && trial.counted.record().stage < Stage::kRows) return trial;  // the other scenarios would hang too
  end = run([&] { run_inputs(scenario_of(trial.timed)); }, trial.timed.record(), options, false);
  if (!end) return end.error();
  trial.timed_end = *end;
  keep_times(trial.timed.rows(), trial.times_ns);
  for (int again = 0; again < 2 && trial.timed_end.is_clean(); ++again) {
    const SharedRecord record(inputs.rows(), payload);
    end = run([&] { run_inputs(scenario_of(record)); }, record.record(), options, false);
    if (!end) return end.error();
    if (!end->is_clean()) break;
    keep_times(record.rows(), trial.times_ns);
    take_least_times(record.rows(), trial.timed.rows());
  }
  const auto good = trial.counted.rows();
  end = run([&] { run_faults(scenario_of(trial.troubled), good); }, trial.troubled.record(), options, false);
  if (!end) return end.error();
  trial.troubled_end = *end;
  return trial;
}

Result<std::string> descriptor_text(const std::string& object_file, const TrialOptions& options) {
  SharedRecord record(0, 0);
  constexpr std::size_t kBytes = kMaxDescriptorBytes + 1;
  const auto shared = FamilyMemory::create(kBytes);
  if (!shared) return shared.error();
  auto* text = reinterpret_cast<char*>(shared->bytes().data());
  const auto ask = [&] {
    const auto said = [&]() -> Result<std::string> {
      const auto object = SharedObject::open(object_file);
      if (!object) return object.error();
      if (object->components().size() != 1)
        return (Message() << "offers " << object->components().size() << " components; one is tested at a time")
            .error(ErrorCode::kBadInput, object_file);
      const auto descriptor = describe(*object->components()[0]);
      if (!descriptor) return descriptor.error();
      return to_json(*descriptor);
    }();
    if (said && said->size() < kBytes) std::memcpy(text, said->c_str(), said->size() + 1);
    if (said) return;
    char(&refusal)[sizeof(Record::refusal)] = record.record().refusal;
    std::snprintf(refusal, sizeof refusal, "%s", std::string(said.error().message.view()).c_str());
  };
  const auto end = run(ask, record.record(), options, false);
  const std::string found(text);
  if (!end) return end.error();
  if (!found.empty() && end->is_clean()) return found;
  const char* refusal = record.record().refusal;
  return (Message() << (refusal[0] != '\0' ? refusal : "crashes or hangs when it is opened"))
      .error(ErrorCode::kBadInput, object_file);
}

}  // namespace chimera::component_test
