// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/cpu_claim.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <cstddef>

#include "chimera/platform/linux/owned_descriptor.h"

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

// Process that holds the claim; 0 when it cannot be told.
pid_t holder(const Address& address) noexcept {
  const OwnedDescriptor asking = make_socket();
  ucred credentials{};
  socklen_t size = sizeof credentials;
  if (asking.fd < 0 || ::connect(asking.fd, address.get(), address.size) != 0) return 0;
  return ::getsockopt(asking.fd, SOL_SOCKET, SO_PEERCRED, &credentials, &size) == 0 ? credentials.pid : 0;
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
  Message text;
  text << "CPU " << cpu << " is in use by another real-time subsystem";
  if (const pid_t pid = holder(address); pid > 0) text << " (process " << pid << ")";
  text << ": end that one, place the rtpu on another CPU, or run with --priority 0";
  return text.error(ErrorCode::kRefused);
}

CpuClaim& CpuClaim::operator=(CpuClaim&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

CpuClaim::~CpuClaim() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace chimera
