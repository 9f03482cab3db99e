// SPDX-License-Identifier: Apache-2.0
// The shared object of a component, opened so that nobody can change it under a running task:
// docs/formats/component-abi.md.
//
//   file -> sealed copy in memory -> dlopen of the copy, never closed
//
// A rebuild that overwrites the file in place would otherwise change code that is mapped and running. Closing an
// object that may still have a thread or a static destructor in it cannot be made safe, so it stays.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/load/descriptor.h"
#include "chimera/platform/descriptor.h"
#include "chimera/task/abi.h"

namespace chimera {

/// How every refusal of an object ends that would be another one after a build.
inline constexpr std::string_view kRebuild = ". Rebuild the component.";

/// An open object and the components it offers. Cheap to copy; what it points at lives as long as the process.
/// Opening one file twice gives two objects that share nothing, static variables included.
class SharedObject {
 public:
  /// Copies, seals and opens the file, and runs the static constructors in it. Refuses, with the path in
  /// Error::where: no such file, no ordinary file or one of more than 256 MiB, not
  /// an ELF object, one that cannot be linked (says which symbol), one without
  /// components, one built for another version of the component interface.
  /// Context: setup; may block.
  static Result<SharedObject> open(const std::string& path);
  /// The same of bytes that were read from `path`. Context: setup; may block.
  static Result<SharedObject> open(std::span<const std::byte> bytes, const std::string& path);
  /// The bytes of the file, for the other open(). Refuses one that is no ordinary file, or has more than 256 MiB.
  /// Context: setup; may block.
  static Result<std::string> read(const std::string& path);

  /// Refuses what open() and component() would refuse, as far as that can be seen without running code of the file:
  /// for whoever checks and does not load. Context: setup; may block.
  static Result<void> inspect(const std::string& path, std::string_view component);

  const std::string& path() const noexcept { return path_; }
  std::span<const chimera_component* const> components() const noexcept { return components_; }

  /// The component of that name; refuses when the object offers none such, and says what it offers.
  /// Context: setup.
  Result<const chimera_component*> component(std::string_view name) const;

  /// The component that `file` describes. Refuses when the object's declaration is not what the descriptor says,
  /// and names the port and the difference. Context: setup; may block.
  Result<const chimera_component*> matching(const Descriptor& file) const;

 private:
  static Result<SharedObject> link(Result<OwnedDescriptor> copy, const std::string& path);

  SharedObject(std::string path, std::span<const chimera_component* const> components)
      : path_(std::move(path)), components_(components) {}

  std::string path_;
  std::span<const chimera_component* const> components_;
};

}  // namespace chimera
