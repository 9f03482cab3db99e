// SPDX-License-Identifier: Apache-2.0
// The inputs of a component under trial: a row of values for each cycle, recorded or generated.
// The rules are in docs/formats/component-test.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/load/descriptor.h"
#include "chimera/verify/configuration.h"

namespace chimera::component_test {

inline constexpr std::size_t kMaxRecordingBytes = 16u * 1024 * 1024;
inline constexpr std::size_t kMaxRows = 100'000;
inline constexpr std::size_t kMaxColumns = 256;

/// A number of an in-var.
struct InputChannel {
  std::string name;        ///< its name in a recording: "q_ref[2]"
  std::string port_name;   ///< name by the port, for a repeated port: "in[0][2]"
  std::string unit;        ///< of its values
  std::size_t offset = 0;  ///< in the row
  std::uint32_t type = CHIMERA_FLOAT64;
  double base = 0;           ///< value in the setup
  double low = 0, high = 0;  ///< limits of generated values
  double declared_high = 0;  ///< end of the declared range; infinity: none
};

/// The layout of a row: the values of operator variable o begin at offsets[o]. Context: setup.
struct InputForm {
  static InputForm of(const Configuration& configuration, const Descriptor& component);

  std::vector<std::size_t> offsets;  ///< by operator variable
  std::vector<InputChannel> channels;
  std::vector<std::size_t> quaternions;  ///< offsets of four numbers that form a unit quaternion
  std::vector<std::byte> base;           ///< the row of the setup

  std::size_t bytes() const noexcept { return base.size(); }
  double get(const InputChannel& channel, std::span<const std::byte> row) const noexcept;
  /// Writes `value`: rounded for whole numbers; a truth value is true above 0.5.
  void put(const InputChannel& channel, double value, std::span<std::byte> row) const noexcept;
};

/// Rows of inputs. Context: setup.
class Inputs {
 public:
  /// `rows` pseudo-random rows that depend only on `seed` and the form, to the bit.
  static Inputs generated(const InputForm& form, std::uint64_t seed, std::size_t rows);
  /// The rows of a recording, sampled at each `period`; at least `least` rows (the last one repeats). `file` names it
  /// in messages; `names` replace in[0], in[1], ... of its first line.
  static Result<Inputs> recorded(const InputForm& form, std::string_view text, const std::string& file,
                                 std::span<const std::string> names, Nanoseconds period, std::size_t least);

  std::size_t rows() const noexcept { return row_bytes_ == 0 ? rows_ : bytes_.size() / row_bytes_; }
  std::span<const std::byte> row(std::size_t i) const noexcept { return {bytes_.data() + i * row_bytes_, row_bytes_}; }
  bool are_recorded() const noexcept { return are_recorded_; }

 private:
  Inputs(std::size_t rows, std::size_t row_bytes) : rows_(rows), row_bytes_(row_bytes), bytes_(rows * row_bytes) {}
  std::span<std::byte> writable(std::size_t i) noexcept { return {bytes_.data() + i * row_bytes_, row_bytes_}; }

  std::size_t rows_, row_bytes_;
  std::vector<std::byte> bytes_;
  bool are_recorded_ = false;
};

/// Writes bad values of kind `kind` < kBadInputs into every number of `row`: NaN, infinity, -infinity, beyond the
/// declared range, the least whole numbers. False if no number accepts such values. Context: setup.
bool spoil(const InputForm& form, std::size_t kind, std::span<std::byte> row) noexcept;
/// The name of the values that spoil() writes: "NaN".
const char* spoilt_name(std::size_t kind) noexcept;

}  // namespace chimera::component_test
