// SPDX-License-Identifier: Apache-2.0
// How far each variable moves that is handed over in a switch: from the last value of the producer before to what the
// producer after wrote.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/runtime/switch_receipt.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// Compares the first `count` elements of an out-var. A boolean counts as 0 or 1; of a struct every field counts.
/// `declared` is the component's declaration of the port. Requires: max_bytes() of the port at both. Context: cycle
/// boundary; wait-free; O(elements).
ValueStep step_between(const PortSpec& port, const chimera_port_decl& declared, std::uint32_t count,
                       const std::byte* before, const std::byte* after) noexcept;

/// Of the tasks of one context. Context of everything not marked: cycle boundary; O(bytes of the variables); no
/// allocation.
class HandoverSteps {
 public:
  explicit HandoverSteps(TaskSet& set) noexcept : set_(set) {}
  /// Takes memory for every variable. Context: setup.
  void prepare();

  /// Keeps what the present producers of the variables have published last. Requires: they are the ones before.
  void keep_last(std::span<const VariablePart> variables) noexcept;
  /// The same of the one variable, of a producer of this context that has gone.
  void keep_last_of(const Handover& handover) noexcept;
  /// Compares what the present producers before published last with what they had at the last call: a step between two
  /// publications in a row that is larger than `usual` takes its place. Of variables that go to a task of this
  /// context.
  void watch(std::span<VariablePart> variables) noexcept;
  /// Of a producer of another context that has gone: what watch() saw of it last while it was ON.
  void keep_watched(const Handover& handover) noexcept;
  /// Forgets what watch() has seen.
  void begin_watch() noexcept;
  /// From the value that was kept to the latest one of the producer after, a task of this context. Not known when one
  /// of the two is not there.
  ValueStep step_to(const Handover& handover) noexcept;

 private:
  ValueStep step(const Handover& handover, const std::byte* from, const std::byte* to) const noexcept;
  void keep(const Handover& handover, const chimera_slot* slot, std::uint32_t offset, std::uint32_t bit) noexcept;

  TaskSet& set_;
  std::span<std::span<std::byte>> last_;  // by variable
  std::span<bool> has_last_;              // by variable
  std::span<std::span<std::byte>> watched_;     // by variable
  std::span<std::uint64_t> watched_sequence_;  // by variable: of the publication that is in watched_; 0: none
};

}  // namespace chimera
