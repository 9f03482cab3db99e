// SPDX-License-Identifier: Apache-2.0
// Claims a CPU by binding an abstract Unix socket with its number: the kernel gives the claim back at the holder's
// death.
#include "chimera/platform/cpu_claim.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

#include "chimera/platform/owned_descriptor.h"

namespace chimera {
namespace {

struct Address {
  explicit Address(int cpu) noexcept {
    const Message name = Message() << "chimera-cpu-" << cpu;
    un.sun_family = AF_UNIX;
    std::memcpy(un.sun_path + 1, name.view().data(), name.view().size());  // the zero before it: abstract
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.view().size());
  }
  const sockaddr* get() const noexcept { return reinterpret_cast<const sockaddr*>(&un); }
  sockaddr_un un{};
  socklen_t size = 0;
};

OwnedDescriptor make_socket() noexcept {
  return OwnedDescriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

// Who holds the claim, as the kernel knows it; pid 0 when it cannot be told.
ucred holder(const Address& address) noexcept {
  const OwnedDescriptor asking = make_socket();
  ucred credentials{};
  socklen_t size = sizeof credentials;
  if (asking.fd < 0 || ::connect(asking.fd, address.get(), address.size) != 0 ||
      ::getsockopt(asking.fd, SOL_SOCKET, SO_PEERCRED, &credentials, &size) != 0)
    return {};
  return credentials;
}

// Any user may bind the name, also one who runs no subsystem: whose process it is decides what the reader does.
Error in_use(int cpu, const ucred& who) noexcept {
  Message text;
  text << "CPU " << cpu << " is in use by ";
  if (who.pid > 0)
    text << "another real-time subsystem (process " << who.pid << " of user " << who.uid << "): end that one, ";
  else
    text << "a process that does not answer: find it with `ss -xap | grep chimera-cpu-" << cpu << "` as root, end it, ";
  text << "place the rtpu on another CPU, or run with --priority 0";
  return text.error(ErrorCode::kRefused);
}

}  // namespace

Result<CpuClaim> CpuClaim::take(int cpu) noexcept {
  const Message what = Message() << "claim of CPU " << cpu;
  const Address address(cpu);
  OwnedDescriptor claim = make_socket();
  if (claim.fd < 0) return system_error(what, "socket");
  if (::bind(claim.fd, address.get(), address.size) == 0) {
    if (::listen(claim.fd, 64) != 0) return system_error(what, "listen");
    return CpuClaim(claim.release());
  }
  if (errno != EADDRINUSE) return system_error(what, "bind");
  return in_use(cpu, holder(address));
}

CpuClaim& CpuClaim::operator=(CpuClaim&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

CpuClaim::~CpuClaim() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace chimera
