// SPDX-License-Identifier: Apache-2.0
// The constants of a context: written when a producer's init or reinit ends, read by init and reinit alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "chimera/base/mechanisms.h"
#include "chimera/base/result.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"

namespace chimera {

/// Why a task cannot be initialised with its constants, or cannot make them. Nothing is wrong with those that the
/// description gives.
using FaultWords = std::conditional_t<mechanisms::kVerified && !mechanisms::kConstants, NoWords, FixedString<160>>;

/// One constant with a value: that of one of its producers, or of the description.
struct Constant {
  const ConstantSpec* spec = nullptr;
  std::span<std::byte> value;  ///< at the size of the largest port that is linked to it
  bool is_known = false;
};

/// By ConstantId of the specs, which outlive it. A constant has a value for each of its producers, one of which counts:
/// the first, until choose() says otherwise. Context: setup and cycle boundary; never cycle.
class ConstantStore {
 public:
  ConstantStore() = default;
  /// Makes room for every constant and sets those that the description gives. Context: setup.
  ConstantStore(const ApplicationSpec& spec, SetupMemory& memory);

  /// With the value that counts. Requires: a valid id.
  const Constant& operator[](ConstantId id) const noexcept {
    return made_[mechanisms::kConstants ? counts_[id.index] : id.index];
  }
  /// With the value of one of its producers, by its place in ConstantSpec::producers.
  const Constant& of(ConstantId id, std::uint32_t producer) const noexcept {
    return made_[first_[id.index] + producer];
  }
  /// From now on the value of that producer counts.
  void choose(ConstantId id, std::uint32_t producer) noexcept { counts_[id.index] = first_[id.index] + producer; }
  /// Sets the value of the producer; true when it differs from the one before or was not known.
  bool set(ConstantId id, std::uint32_t producer, std::span<const std::byte> value) noexcept;
  /// Sets the value by the task that produces it.
  bool set_by(TaskId producer, ConstantId id, std::span<const std::byte> value) noexcept;
  /// The value that counts as a whole number, for extents. `fallback` when it is not known or not a whole number.
  std::int64_t integer(ConstantId id, std::int64_t fallback) const noexcept;

 private:
  // The description gives all values: they stay where they are, and nothing sets another.
  void take_given(const ApplicationSpec& spec, SetupMemory& memory);

  std::span<Constant> made_;         // the values of a constant lie side by side
  std::span<std::uint32_t> first_;   // by constant: in made_
  std::span<std::uint32_t> counts_;  // by constant: in made_
};

}  // namespace chimera
