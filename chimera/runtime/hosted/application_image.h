// SPDX-License-Identifier: Apache-2.0
// An application as bytes: what verification made, for processes that read no text. docs/formats/image.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/runtime/application_spec.h"

namespace chimera {

/// Where the code of a task is: its shared object, and fingerprint(descriptor) of load/descriptor.h, by which it is
/// known to be what verification saw.
struct ComponentPlace {
  std::string_view object_file;
  std::uint64_t fingerprint = 0;
};

/// How the processes are to run it.
struct RunSettings {
  std::int32_t priority = 80;          ///< top of the bands, SCHED_FIFO; 0: as ordinary processes
  Nanoseconds method_limit = seconds(2);  ///< of off and kill at the end
};

/// Context: setup; may block. `places` has one entry a task.
std::vector<std::byte> encode(const ApplicationSpec& spec, std::span<const ComponentPlace> places,
                              const RunSettings& settings);

/// A decoded image. Owns what its specs point at (the bytes must outlive it). Movable; spans stay valid.
class ApplicationImage {
 public:
  /// Refuses what is not an image of this version, is cut short, or points outside itself. Never crashes, whatever the
  /// bytes. Context: setup; may block.
  static Result<ApplicationImage> decode(std::span<const std::byte> bytes);

  const ApplicationSpec& spec() const noexcept;
  std::span<const ComponentPlace> places() const noexcept;
  const RunSettings& settings() const noexcept;

  struct Parts;

 private:
  explicit ApplicationImage(std::shared_ptr<const Parts> parts) noexcept : parts_(std::move(parts)) {}
  std::shared_ptr<const Parts> parts_;
};

}  // namespace chimera
