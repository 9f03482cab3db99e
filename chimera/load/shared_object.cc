// SPDX-License-Identifier: Apache-2.0
#include "chimera/load/shared_object.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/message.h"
#include "chimera/load/elf_check.h"

namespace chimera {
namespace {

constexpr unsigned kSeals = F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE;

constexpr std::size_t kMostObjectBytes = std::size_t{256} << 20;  // the copy stays in memory

/// A descriptor that is closed at the end of the scope, unless it is taken.
class OpenFile {
 public:
  explicit OpenFile(int number) noexcept : number_(number) {}
  ~OpenFile() {
    if (number_ >= 0) ::close(number_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int number() const noexcept { return number_; }
  int take() noexcept { return std::exchange(number_, -1); }

 private:
  int number_;
};

Error system_error(std::string_view what, const std::string& path) {
  const ErrorCode code = errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kSystem;
  return (Message() << what << ": " << ::strerror(errno)).error(code, path);
}

/// "gain.so is empty (0 bytes). Rebuild the component."
Error unfit(const std::string& path, std::string_view clause, ErrorCode code = ErrorCode::kBadInput) {
  const std::string_view name = std::string_view(path).substr(path.rfind('/') + 1);
  return (Message() << name << " " << clause << ". Rebuild the component.").error(code, path);
}

Result<void> copy_all(int from, int to, const std::string& path) {
  char block[65536];
  for (;;) {
    const ssize_t got = ::read(from, block, sizeof block);
    if (got == 0) return {};
    if (got < 0) return system_error("cannot be read", path);
    for (ssize_t done = 0; done < got;) {
      const ssize_t put = ::write(to, block + done, static_cast<std::size_t>(got - done));
      if (put < 0) return system_error("cannot be copied into memory", path);
      done += put;
    }
  }
}

/// The descriptor of a sealed copy of the file.
Result<int> sealed_copy(const std::string& path) {
  const auto opened = open_ordinary(path, kMostObjectBytes);
  if (!opened) return opened.error();
  const OpenFile file(*opened);
  const std::size_t slash = path.rfind('/');
  const std::string name = (slash == std::string::npos ? path : path.substr(slash + 1)).substr(0, 200);
  OpenFile copy(::memfd_create(name.c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (copy.number() < 0) return system_error("no memory for a copy", path);
  if (const auto copied = copy_all(file.number(), copy.number(), path); !copied) return copied.error();
  if (const auto why = elf_fault(copy.number()); !why.empty()) return unfit(path, why.view());
  if (::fcntl(copy.number(), F_ADD_SEALS, kSeals) != 0) return system_error("the copy cannot be sealed", path);
  return copy.take();
}

/// The linker's reason without the place in /proc that only we know about.
std::string_view reason(const char* text) {
  std::string_view all = text == nullptr ? "unknown" : text;
  const std::size_t colon = all.find(": ");
  return all.starts_with("/proc/self/fd/") && colon != std::string_view::npos ? all.substr(colon + 2) : all;
}

Result<std::span<const chimera_component* const>> components_of(void* handle, const std::string& path) {
  void* symbol = ::dlsym(handle, CHIMERA_COMPONENTS_SYMBOL);
  if (symbol == nullptr) {
    return unfit(path, "offers no components: it has no symbol " CHIMERA_COMPONENTS_SYMBOL
                       ", so no CHIMERA_COMPONENT or PBO_MODULE was built into it");
  }
  const auto components = reinterpret_cast<chimera_components_fn>(symbol);
  std::uint32_t count = 0;
  const chimera_component* const* list = components(CHIMERA_ABI_VERSION, &count);
  if (list == nullptr) {
    return unfit(path,
                 (Message() << "was built for another ABI; this chimera needs ABI " << CHIMERA_ABI_VERSION).view(),
                 ErrorCode::kUnsupported);
  }
  if (count == 0) return unfit(path, "offers no component");
  return std::span(list, count);
}

}  // namespace

Result<SharedObject> SharedObject::open(const std::string& path) {
  const auto copy = sealed_copy(path);
  if (!copy) return copy.error();
  // The descriptor stays open: the linker knows an object by its path, and a second one must not get this number.
  const std::string place = "/proc/self/fd/" + std::to_string(*copy);
  void* handle = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const auto error = (Message() << "cannot be loaded: " << reason(::dlerror())).error(ErrorCode::kBadInput, path);
    ::close(*copy);
    return error;
  }
  const auto components = components_of(handle, path);
  if (!components) return components.error();
  return SharedObject(path, *components);
}

Result<void> SharedObject::inspect(const std::string& path, std::string_view component) {
  const auto opened = open_ordinary(path, kMostObjectBytes);
  if (!opened && opened.error().code == ErrorCode::kNotFound) return unfit(path, "is missing", ErrorCode::kNotFound);
  if (!opened) return opened.error();
  const OpenFile file(*opened);
  if (const auto why = elf_fault(file.number(), component); !why.empty()) return unfit(path, why.view());
  return {};
}

Result<const chimera_component*> SharedObject::component(std::string_view name) const {
  Message offered;
  for (const chimera_component* one : components_) {
    if (one->name != nullptr && one->name == name) return one;
    offered << (offered.empty() ? "" : " ") << (one->name == nullptr ? "(unnamed)" : one->name);
  }
  return (Message() << "has no component " << name << "; it offers " << offered.view())
      .error(ErrorCode::kNotFound, path_);
}

Result<const chimera_component*> SharedObject::matching(const Descriptor& file) const {
  const auto found = component(file.name);
  if (!found) return found.error();
  const auto said = describe(**found);
  Error error;
  if (!said) {
    error = said.error();
  } else {
    const auto same = match(file, *said);
    if (same) return *found;
    error = same.error();
  }
  error.where.assign(path_);
  return error;
}

}  // namespace chimera
