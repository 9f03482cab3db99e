// SPDX-License-Identifier: Apache-2.0
// Copies objects into sealed memory and links them by their path in /proc.
#include "chimera/platform/linked_object.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <string_view>

namespace chimera {
namespace {

constexpr int kSeals = F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE;

Error failed(std::string_view what, const std::string& path) noexcept {
  return (Message() << what << ": " << std::strerror(errno)).error(ErrorCode::kSystem, path);
}

Result<void> write_all(int to, std::span<const std::byte> bytes, const std::string& path) noexcept {
  while (!bytes.empty()) {
    const ssize_t put = ::write(to, bytes.data(), bytes.size());
    if (put < 0) return failed("cannot be copied into memory", path);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  return {};
}

Result<void> copy_all(int from, int to, const std::string& path) noexcept {
  std::byte block[65536];
  for (;;) {
    const ssize_t got = ::read(from, block, sizeof block);
    if (got == 0) return {};
    if (got < 0) return failed("cannot be read", path);
    if (const auto put = write_all(to, {block, static_cast<std::size_t>(got)}, path); !put) return put.error();
  }
}

/// Makes memory, lets `fill` write into it, and seals it.
template <class Fill>
Result<OwnedDescriptor> sealed(const char* name, const std::string& path, Fill fill) noexcept {
  OwnedDescriptor copy(::memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (copy.fd < 0) return failed("no memory for a copy", path);
  if (const Result<void> filled = fill(copy.fd); !filled) return filled.error();
  if (::fcntl(copy.fd, F_ADD_SEALS, kSeals) != 0) return failed("the copy cannot be sealed", path);
  return copy;
}

/// The linker's reason without the path in /proc, which says nothing to a user.
std::string_view reason(const char* text) noexcept {
  const std::string_view all = text == nullptr ? "unknown" : text;
  const std::size_t colon = all.find(": ");
  return all.starts_with("/proc/self/fd/") && colon != std::string_view::npos ? all.substr(colon + 2) : all;
}

}  // namespace

Result<OwnedDescriptor> sealed_copy(int from, const char* name, const std::string& path) noexcept {
  return sealed(name, path, [&](int to) { return copy_all(from, to, path); });
}

Result<OwnedDescriptor> sealed_copy(std::span<const std::byte> from, const char* name,
                                    const std::string& path) noexcept {
  return sealed(name, path, [&](int to) { return write_all(to, from, path); });
}

Result<void*> link_object(OwnedDescriptor descriptor) {
  const std::string place = "/proc/self/fd/" + std::to_string(descriptor.fd);
  void* object = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) return (Message() << reason(::dlerror())).error(ErrorCode::kBadInput);
  (void)descriptor.release();
  return object;
}

void* symbol_of(void* object, const char* name) noexcept { return ::dlsym(object, name); }

}  // namespace chimera
