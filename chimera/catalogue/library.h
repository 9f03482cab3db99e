// SPDX-License-Identifier: Apache-2.0
// The installed components: their descriptors, found along CHIMERA_PATH and then in the install prefix.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/load/descriptor.h"
#include "chimera/units/unit_system.h"

namespace chimera {

/// A component in the library. The shared object NAME.so lies beside the descriptor.
struct LibraryEntry {
  Descriptor descriptor;
  std::string descriptor_file;
  std::string object_file;
};

/// A component that is hidden, because an earlier folder has one of its name.
struct HiddenComponent {
  std::string name, file;  ///< of its descriptor
};

/// The components of all folders. Context: setup; may block. Immutable after make().
class Library {
 public:
  /// Reads every NAME.component.json of `folders`, in order; for each name the first file counts. A repeated folder is
  /// read once; a missing folder is skipped. Files that cannot be read, or have a unit unknown to `units`, go to
  /// faults(). A file `buildable.txt` in a folder lists, one per line, the components that its build tree can build.
  static Library make(std::span<const std::string> folders, UnitSystem units);

  /// A library of the given descriptors, for tests and tools that have no files.
  static Library of(std::vector<Descriptor> descriptors, UnitSystem units);
  /// A library of descriptors with the names of their files, from another process.
  static Library of_entries(std::vector<LibraryEntry> entries, UnitSystem units);

  /// All components in alphabetical order of their names.
  std::span<const LibraryEntry> entries() const noexcept { return entries_; }
  /// The component with that name, or nullptr.
  const LibraryEntry* find(std::string_view name) const noexcept;
  /// True if a build tree among the folders has the source of that component, but has not built it.
  bool is_unbuilt(std::string_view name) const noexcept;
  std::size_t n_unbuilt() const noexcept;
  /// The installed name nearest to `name`, or "".
  std::string nearest_name(std::string_view name) const;
  /// Files that could not be read; `where` is the file.
  std::span<const Error> faults() const noexcept { return faults_; }
  /// Folders of CHIMERA_PATH that do not exist: a possible reason for a missing component.
  std::span<const std::string> missing_folders() const noexcept { return missing_folders_; }
  /// Components that find() does not return, because an earlier folder has one of the same name.
  std::span<const HiddenComponent> hidden() const noexcept { return hidden_; }
  const UnitSystem& units() const noexcept { return units_; }

 private:
  explicit Library(UnitSystem units) : units_(std::move(units)) {}
  void read_folder(const std::string& folder);
  void read_file(const std::string& path);
  void add(LibraryEntry entry);

  std::vector<std::string> buildable_;
  UnitSystem units_;
  std::vector<LibraryEntry> entries_;
  std::vector<Error> faults_;
  std::vector<std::string> missing_folders_;
  std::vector<HiddenComponent> hidden_;
};

/// The folders of CHIMERA_PATH (separated by colons; empty parts are skipped), then `installed`.
std::vector<std::string> component_folders(std::span<const std::string> installed);

}  // namespace chimera
