// SPDX-License-Identifier: Apache-2.0
// Builds one task in virtual time, and feeds, signals and cycles it by hand.
#include "chimera/component_test/single_task.h"

#include <cstring>

namespace chimera::component_test {

Result<std::unique_ptr<SingleTask>> SingleTask::create(const LibraryEntry& entry, const Configuration& configuration,
                                                       const InputForm& form, Record& record) {
  auto object = SharedObject::open(entry.object_file);
  if (!object) return object.error();
  std::unique_ptr<SingleTask> made(new SingleTask(*std::move(object), configuration, form, record));
  if (auto built = made->build(entry); !built) return built.error();
  return made;
}

Result<void> SingleTask::build(const LibraryEntry& entry) {
  const auto component = object_.matching(entry.descriptor);
  if (!component) return component.error();
  component_ = std::make_unique<InstrumentedComponent>(**component, record_);
  const ApplicationSpec& spec = configuration_.spec();
  const chimera_component* components[] = {&component_->component()};
  auto set = HeapTaskSet::create(spec, components);
  if (!set) return set.error();
  set_ = *std::move(set);
  set_->methods().run_by({&clock_});
  std::size_t payload = 0;
  places_ = output_places(spec, payload);
  return {};
}

void SingleTask::feed(std::span<const std::byte> row) noexcept {
  const std::span<const GivenSpec> operators = configuration_.spec().operators;
  for (std::size_t o = 0; o < operators.size(); ++o)
    set_->table().set_operator(o, row.subspan(form_.offsets[o], operators[o].value.size()), now_);
}

State SingleTask::signal(Signal signal) {
  clock_.set(now_);
  const State before = state();
  set_->life().signal(task().id, signal, now_);
  now_ = clock_.now();
  Task& task = set_->tasks()[0];
  if (before != State::kOn && task.state == State::kOn) task.last_release = now_;
  return task.state;
}

RowRecord SingleTask::cycle() noexcept {
  Task& task = set_->tasks()[0];
  const Nanoseconds period = task.spec->period;
  now_ += period;
  clock_.set(now_);
  const CycleTime time{now_, now_ + task.spec->deadline, 0, set_->flag().is_up()};
  const std::uint64_t faults = task.faults.count, rejected = task.profile.rejected;
  const BodyEnd body = begin_cycle(task, time);
  RowRecord row;
  row.is_run = true;
  row.state = static_cast<std::uint8_t>(end_cycle(task, body, time, now_, true, &clock_));
  row.answer = static_cast<std::uint8_t>(task.faults.count != faults ? Answer::kFault : body.answer);
  row.valid = task.valid;
  row.time_ns = component_->cycle_time().count;
  if (task.profile.rejected != rejected && record_.unsafe++ == 0)
    std::memcpy(record_.unsafe_text, fault_text(), sizeof record_.unsafe_text);
  task.outbox.clear();  // no other task exists
  if (task.background != nullptr && body.answer != Answer::kNoEvent) run_background(task, Method::kCycle, now_);
  set_->on_set_changed();
  return row;
}

void SingleTask::copy_outputs(std::span<std::byte> to) const noexcept {
  const Task& mine = task();
  const auto* values = reinterpret_cast<const std::byte*>(mine.group.published() + 1);
  for (std::size_t i = 0; i < places_.size(); ++i)
    std::memcpy(to.data() + places_[i].offset, values + mine.outputs[i].offset, places_[i].bytes);
}

void SingleTask::copy_counts(std::span<std::uint32_t> to) const noexcept {
  const Task& mine = task();
  for (std::size_t i = 0; i < places_.size(); ++i) to[i] = mine.outputs[i].port->count;
}

}  // namespace chimera::component_test
