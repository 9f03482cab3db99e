// SPDX-License-Identifier: Apache-2.0
// Opens the shared object of a component, so that no program can change it under a running task:
// docs/formats/component-abi.md.
//
//   file -> sealed copy in memory -> dlopen of the copy, never closed
//
// Without the copy, a rebuild that overwrites the file in place would change code that is mapped and running. An object
// is never closed: a thread or a static destructor may still be in it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/load/descriptor.h"
#include "chimera/platform/descriptor.h"
#include "chimera/task/abi.h"

namespace chimera {

/// The last words of each refusal that a rebuild may cure.
inline constexpr std::string_view kRebuild = ". Rebuild the component.";

/// An open object and its components. Cheap to copy; the data it points to lives as long as the process. Opening a file
/// twice gives two objects that share nothing, not even static variables.
class SharedObject {
 public:
  /// Copies, seals and opens the file, and runs its static constructors. Refuses, with the path in Error::where: a
  /// missing file, a file that is not ordinary or has more than 256 MiB, a file that is no ELF object, one that cannot
  /// be linked (names the symbol), one without components, one for another version of the component interface. Context:
  /// setup; may block.
  static Result<SharedObject> open(const std::string& path);
  /// Opens bytes that were read from `path`, like open(path). Context: setup; may block.
  static Result<SharedObject> open(std::span<const std::byte> bytes, const std::string& path);
  /// The bytes of the file, for open(bytes, path). Refuses a file that is not ordinary or has more than 256 MiB.
  /// Context: setup; may block.
  static Result<std::string> read(const std::string& path);

  /// Refuses the files that open() and component() would refuse, as far as is possible without running code of the
  /// file. For programs that check and do not load. Context: setup; may block.
  static Result<void> inspect(const std::string& path, std::string_view component);

  const std::string& path() const noexcept { return path_; }
  std::span<const chimera_component* const> components() const noexcept { return components_; }

  /// The component with that name. If the object has none, refuses and lists the components that it offers. Context:
  /// setup.
  Result<const chimera_component*> component(std::string_view name) const;

  /// The component that `file` describes. If the declaration of the object differs, refuses and names the port and the
  /// difference. Context: setup; may block.
  Result<const chimera_component*> matching(const Descriptor& file) const;

 private:
  static Result<SharedObject> link(Result<OwnedDescriptor> copy, const std::string& path);

  SharedObject(std::string path, std::span<const chimera_component* const> components)
      : path_(std::move(path)), components_(components) {}

  std::string path_;
  std::span<const chimera_component* const> components_;
};

}  // namespace chimera
