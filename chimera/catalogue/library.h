// SPDX-License-Identifier: Apache-2.0
// The components that are installed: their descriptors, found along CHIMERA_PATH and then in the install prefix.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/load/descriptor.h"
#include "chimera/units/unit_system.h"

namespace chimera {

/// A component as found. The shared object stands beside the descriptor: NAME.so.
struct LibraryEntry {
  Descriptor descriptor;
  std::string descriptor_file;
  std::string object_file;
};

/// A component that was passed over, because an earlier folder has one of its name.
struct HiddenComponent {
  std::string name, file;  ///< of its descriptor
};

/// Context: setup; may block. Immutable after make().
class Library {
 public:
  /// Reads every NAME.component.json of `folders`, in order; of one name the first found counts. A folder that is
  /// named twice is read once, one that does not exist is passed over. What cannot be read, or has a unit unknown to
  /// `units`, goes to faults(). A file `buildable.txt` in a folder names, one a line, what its build tree can build.
  static Library make(std::span<const std::string> folders, UnitSystem units);

  /// A library of the given descriptors, for tests and tools that have no files.
  static Library of(std::vector<Descriptor> descriptors, UnitSystem units);
  /// A library of descriptors with the names of their files, as another process found them.
  static Library of_entries(std::vector<LibraryEntry> entries, UnitSystem units);

  /// By name, in alphabetical order.
  std::span<const LibraryEntry> entries() const noexcept { return entries_; }
  /// The component of that name, or nullptr.
  const LibraryEntry* find(std::string_view name) const noexcept;
  /// True when the source of that component belongs to a build tree among the folders, and was not built there.
  bool is_unbuilt(std::string_view name) const noexcept;
  std::size_t n_unbuilt() const noexcept;
  /// The installed name nearest to `name`, or "".
  std::string nearest_name(std::string_view name) const;
  /// What could not be read; `where` is the file.
  std::span<const Error> faults() const noexcept { return faults_; }
  /// Folders that CHIMERA_PATH names and that do not exist: whoever misses a component wants to know.
  std::span<const std::string> missing_folders() const noexcept { return missing_folders_; }
  /// What find() does not find because something else of that name stands before it.
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

/// The folders of CHIMERA_PATH (colons between them; empty parts are passed over), then `installed`.
std::vector<std::string> component_folders(std::span<const std::string> installed);

}  // namespace chimera
