// SPDX-License-Identifier: Apache-2.0
// The offsets of values in the frames between a board and Linux. Both sides compute them from the same description: the
// board from its part, in which the variables of other rtpus are operator variables. docs/formats/link.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/base/ids.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"

namespace chimera::board_link {

inline constexpr std::size_t kMostTasks = 32, kMostImports = 64;

enum class FrameKind : std::uint8_t { kToBoard = 1, kFromBoard = 2 };
inline constexpr std::uint8_t kFlagIsUp = 1;  ///< of FrameHead::flags, to a board: the illegal-configuration flag

/// At the start of a payload. Little-endian, as all numbers.
struct FrameHead {
  FrameKind kind = FrameKind::kToBoard;
  std::uint8_t flags = 0;
  std::uint16_t sequence = 0;   ///< of this direction
  std::uint32_t layout = 0;     ///< LinkLayout::hash
  std::uint64_t sent_us = 0;    ///< clock of the sender; that of a board counts from its reset
  std::uint32_t wanted = 0;     ///< to a board: bit i, its task i shall be ON; from it: what it heard last
  std::uint32_t received = 0;   ///< from a board: whole frames so far
};
static_assert(sizeof(FrameHead) == 24);

/// News of each task of the board, in the order of tasks, behind the head of a frame from a board.
struct TaskNews {
  std::uint8_t state = 0;       ///< State
  std::uint8_t faults = 0;      ///< count, modulo 256
  std::uint16_t sequence = 0;   ///< of its publication, modulo 65536; 0 only before the first
  std::uint32_t age_us = 0;     ///< of the publication when the frame was sent
};
static_assert(sizeof(TaskNews) == 8);

/// The last fault of one task in ERROR, at the end of a frame from a board; left out if there is none.
struct FaultNews {
  std::uint8_t task = 0, method = 0;
  std::uint16_t reserved = 0;
  std::int32_t code = 0;
  char text[96] = {};           ///< zero-terminated
};
static_assert(sizeof(FaultNews) == 104);

/// A variable that the board reads and does not produce.
struct Import {
  VariableId variable;
  std::uint32_t bytes = 0;
  std::uint32_t offset = 0;     ///< among the values, a multiple of 8
};

/// All outputs of a task of the board, as they stand in its group.
struct Export {
  TaskId task;
  std::uint32_t bytes = 0;
  std::uint32_t offset = 0;     ///< among the values, a multiple of 8
};

class LinkLayout {
 public:
  /// Plans for the tasks of `rtpu`. What exceeds kMostTasks or kMostImports is left out: LinkSize::of() finds it first.
  /// Context: setup.
  void plan(const ApplicationSpec& spec, RtpuId rtpu, SetupMemory& memory);

  std::span<const Import> imports() const noexcept { return imports_; }  ///< by name of the variable
  std::span<const Export> exports() const noexcept { return exports_; }  ///< by task
  /// Over names, kinds, sizes and times of all that is exchanged or decides it: an image of another description has
  /// another one.
  std::uint32_t hash() const noexcept { return hash_; }

  // Places in the payload of a frame to a board: head, valid bits, ages in us, values.
  static constexpr std::size_t valid_at() noexcept { return sizeof(FrameHead); }
  static constexpr std::size_t ages_at() noexcept { return valid_at() + 8; }
  std::size_t imports_at() const noexcept { return ages_at() + (imports_.size() + 1) / 2 * 8; }
  std::size_t to_board_bytes() const noexcept { return imports_at() + import_bytes_; }
  // Places in the payload of a frame from a board: head, news of the tasks, values, a fault if there is one.
  static constexpr std::size_t news_at(std::size_t i) noexcept { return sizeof(FrameHead) + i * sizeof(TaskNews); }
  std::size_t exports_at() const noexcept { return news_at(exports_.size()); }
  std::size_t fault_at() const noexcept { return exports_at() + export_bytes_; }
  std::size_t most_from_board_bytes() const noexcept { return fault_at() + sizeof(FaultNews); }

 private:
  std::span<Import> imports_;
  std::span<Export> exports_;
  std::uint32_t import_bytes_ = 0, export_bytes_ = 0;
  std::uint32_t hash_ = 0;
};

/// The number of tasks of `rtpu`, and of variables that they read and do not produce. Context: setup.
struct LinkSize {
  std::size_t tasks = 0, imports = 0;
  static LinkSize of(const ApplicationSpec& spec, RtpuId rtpu) noexcept;
};

/// The consumer port of the variable on that rtpu if no task there produces it; null: it is no import. Context: setup.
const PortSpec* import_port(const ApplicationSpec& spec, RtpuId rtpu, const Variable& variable) noexcept;

}  // namespace chimera::board_link
