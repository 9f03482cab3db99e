// SPDX-License-Identifier: Apache-2.0
// Opens a sealed copy of an object file and finds the components in it.
#include "chimera/load/shared_object.h"

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/message.h"
#include "chimera/load/elf_check.h"
#include "chimera/platform/linked_object.h"
#include "chimera/platform/thread.h"

namespace chimera {
namespace {

constexpr std::size_t kMostObjectBytes = std::size_t{256} << 20;  // the copy stays in memory

/// "gain.so is empty (0 bytes). Rebuild the component."
Error unfit(const std::string& path, std::string_view clause, ErrorCode code = ErrorCode::kBadInput) {
  const std::string_view name = std::string_view(path).substr(path.rfind('/') + 1);
  return (Message() << name << " " << clause << kRebuild).error(code, path);
}

/// The name of the memory in /proc.
std::string name_of(const std::string& path) {
  return path.substr(path.rfind('/') + 1).substr(0, 200);  // npos + 1: the whole path
}

Result<std::span<const chimera_component* const>> components_of(void* handle, const std::string& path) {
  void* symbol = symbol_of(handle, CHIMERA_COMPONENTS_SYMBOL);
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
  const auto opened = open_ordinary(path, kMostObjectBytes);
  if (!opened) return opened.error();
  const OwnedDescriptor file(*opened);
  return link(sealed_copy(file.fd, name_of(path).c_str(), path), path);
}

Result<SharedObject> SharedObject::open(std::span<const std::byte> bytes, const std::string& path) {
  return link(sealed_copy(bytes, name_of(path).c_str(), path), path);
}

Result<std::string> SharedObject::read(const std::string& path) {
  if (const auto opened = open_ordinary(path, kMostObjectBytes); !opened) return opened.error();
  else const OwnedDescriptor file(*opened);
  return read_ordinary(path, kMostObjectBytes);
}

Result<SharedObject> SharedObject::link(Result<OwnedDescriptor> copy, const std::string& path) {
  if (!copy) return copy.error();
  if (const auto why = elf_fault(copy->fd); !why.empty()) return unfit(path, why.view());
  use_decimal_point();
  const auto object = link_object(*std::move(copy));
  if (!object)
    return (Message() << "cannot be loaded: " << object.error().message.view()).error(ErrorCode::kBadInput, path);
  const auto components = components_of(*object, path);
  if (!components) return components.error();
  return SharedObject(path, *components);
}

Result<void> SharedObject::inspect(const std::string& path, std::string_view component) {
  const auto opened = open_ordinary(path, kMostObjectBytes);
  if (!opened && opened.error().code == ErrorCode::kNotFound) return unfit(path, "is missing", ErrorCode::kNotFound);
  if (!opened) return opened.error();
  const OwnedDescriptor file(*opened);
  if (const auto why = elf_fault(file.fd, component); !why.empty()) return unfit(path, why.view());
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
