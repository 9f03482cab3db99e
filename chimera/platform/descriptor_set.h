// SPDX-License-Identifier: Apache-2.0
// Many descriptors of which one asks at once which are ready, itself a descriptor to wait for.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/result.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {

/// What is wanted of a descriptor: bits.
inline constexpr std::uint32_t kToRead = 1, kToWrite = 2;

/// Movable; closes itself, not what is in it. A descriptor that is closed leaves it. Context: setup; never blocks.
class DescriptorSet {
 public:
  struct Ready {
    std::uint64_t number = 0;  ///< as given to add()
    bool is_readable = false;  ///< or has ended
    bool has_ended = false;    ///< the other end is gone, or it failed
  };

  DescriptorSet() noexcept = default;
  /// Refuses with the system's reason, said of `what`.
  static Result<DescriptorSet> open(const Message& what) noexcept;

  /// False with errno when the system refuses.
  bool add(int descriptor, std::uint32_t wanted, std::uint64_t number) const noexcept;
  bool change(int descriptor, std::uint32_t wanted, std::uint64_t number) const noexcept;
  /// Those that are ready now, at most as many as there is room for; how many. Context: setup; never blocks.
  std::size_t take(std::span<Ready> ready) const noexcept;
  /// Readable when one of them is ready.
  int descriptor() const noexcept { return epoll_.fd; }

 private:
  explicit DescriptorSet(OwnedDescriptor epoll) noexcept : epoll_(std::move(epoll)) {}
  OwnedDescriptor epoll_;
};

}  // namespace chimera
