// SPDX-License-Identifier: Apache-2.0
// File descriptors: owning them, waiting for them, pipes, writing without waiting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "chimera/base/message.h"
#include "chimera/base/result.h"
#include "chimera/base/time.h"

namespace chimera {

/// Closes its descriptor unless released. Move-only. Context: setup.
struct OwnedDescriptor {
  explicit OwnedDescriptor(int f = -1) noexcept : fd(f) {}
  OwnedDescriptor(OwnedDescriptor&& other) noexcept : fd(std::exchange(other.fd, -1)) {}
  OwnedDescriptor& operator=(OwnedDescriptor&& other) noexcept {
    std::swap(fd, other.fd);
    return *this;
  }
  ~OwnedDescriptor();
  int release() noexcept { return std::exchange(fd, -1); }
  int fd;  ///< -1: none
};

/// "WHAT: CALL failed: REASON" by errno. Context: setup.
Error system_error(const Message& what, const char* call) noexcept;

inline constexpr int kDescriptorLost = 4;  ///< exit status of end_without_descriptor()
/// Ends a process in which a component closed descriptors of the framework, after a line on stderr. A wait for such a
/// descriptor would return at once forever, or never. Context: any; never returns.
[[noreturn]] void end_without_descriptor() noexcept;

/// Waits until one of `descriptors` (negative numbers are skipped) is readable, has failed or is closed, at most
/// `limit` (kNever: without end). False if the limit passes first or a signal handler runs.
/// At most 64 descriptors. Context: setup; blocks.
bool await_readable(std::span<const int> descriptors, Nanoseconds limit) noexcept;

struct Watched {
  int descriptor = -1;    ///< a negative number is skipped
  bool for_room = false;  ///< wait until the descriptor is writable, instead of readable
  bool is_ready = false;  ///< readable (writable), failed or closed
  bool is_lost = false;   ///< no open descriptor of this process has this number
};

/// Waits like await_readable() and sets `is_ready` and `is_lost`. Returns the number of ready descriptors; 0: the limit
/// passed; -1: a signal handler ran. At most 64 descriptors. Context: setup; blocks.
int await_ready(std::span<Watched> watched, Nanoseconds limit) noexcept;

/// Events to wait for in a DescriptorSet: bits.
inline constexpr std::uint32_t kToRead = 1, kToWrite = 2;

/// Many descriptors; one call returns the ready ones. The set is itself a descriptor to wait for. Movable; closes
/// itself, not its members. A member that is closed leaves the set. Context: setup; never blocks.
class DescriptorSet {
 public:
  struct Ready {
    std::uint64_t number = 0;  ///< as given to add()
    bool is_readable = false;  ///< also true if the descriptor has ended
    bool has_ended = false;    ///< the other end is gone, or the descriptor failed
  };

  DescriptorSet() noexcept = default;
  /// Refuses with the system's reason; `what` begins the message.
  static Result<DescriptorSet> open(const Message& what) noexcept;

  /// False with errno if the system refuses.
  bool add(int descriptor, std::uint32_t wanted, std::uint64_t number) const noexcept;
  bool change(int descriptor, std::uint32_t wanted, std::uint64_t number) const noexcept;
  /// Fills `ready` with descriptors that are ready now and returns their number. Context: setup; never blocks.
  std::size_t take(std::span<Ready> ready) const noexcept;
  /// Readable while a member is ready.
  int descriptor() const noexcept { return epoll_.fd; }

 private:
  explicit DescriptorSet(OwnedDescriptor epoll) noexcept : epoll_(std::move(epoll)) {}
  OwnedDescriptor epoll_;
};

/// A pipe to a child. Both ends are close-on-exec; reading never blocks. Movable; closes. Context: setup.
struct Pipe {
  /// Refuses with the system's reason.
  static Result<Pipe> open() noexcept;

  /// The first line from the pipe, without its line end and cut after 200 bytes. Empty if no line comes within
  /// `patience`, or if the last writer closes. Context: setup; blocks.
  std::string first_line(Nanoseconds patience) const;

  OwnedDescriptor reading, writing;
};

/// Prepares a device for writing in place of its dead owner: later writes never wait, and unsent output in the queue of
/// a terminal is dropped. Requires: no other process uses the device. Context: any; a few system calls that do not
/// wait.
void take_over_device(int descriptor) noexcept;

/// Returns the number of bytes written; 0: the device accepts none now; -1: the device failed. Context: any; one system
/// call that does not wait.
int write_device(int descriptor, std::span<const std::byte> bytes) noexcept;

}  // namespace chimera
