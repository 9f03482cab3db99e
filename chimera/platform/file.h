// SPDX-License-Identifier: Apache-2.0
// Files: reading at any place, replacing a file whole (PartFile, replace_file), growing by whole lines (LineFile).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "chimera/base/result.h"
#include "chimera/platform/descriptor.h"

namespace chimera {

/// The begin of a small file of /proc or /sys: at most 8191 bytes, zero-terminated; empty if the file cannot be read.
struct FileStart {
  /// Context: setup; may block.
  explicit FileStart(const char* path) noexcept;
  std::string_view view() const noexcept { return {bytes, size}; }

  char bytes[8192] = {};
  std::size_t size = 0;
};

/// Size of the open file in bytes; -1 if the system does not say. Context: setup.
std::int64_t file_size(int file) noexcept;

/// Reads from `offset` until `to` is full or the file ends; the file position stays. Returns the number of bytes, -1 on
/// an error of the system. Context: setup; may block on the disk.
std::int64_t read_at(int file, std::uint64_t offset, std::span<std::byte> to) noexcept;

/// Gives the room of all bytes before `offset` back to the file system; they then read as zeros. False if the file
/// system cannot do that. Context: setup; may block.
bool free_bytes_before(int file, std::uint64_t offset) noexcept;

/// Two different states mean that the file has changed.
struct FileState {
  std::uint64_t inode = 0;
  unsigned mode = 0;            ///< permissions
  std::int64_t changed_ns = 0;  ///< since 1970
  bool operator==(const FileState&) const noexcept = default;
};

/// None if there is no such file. Context: setup; may block.
std::optional<FileState> state_of_file(const std::string& path);

/// Replaces the file at `path`, whole or not at all, by a new file with `text` and the permissions of `known`. Refuses,
/// with the path in `where`, if the file is not in the state `known` or cannot be written. Context: setup; may block.
Result<void> replace_file(const std::string& path, const FileState& known, std::string_view text);

/// Opens an ordinary file to add lines at its end; makes it if there is none. Ends its last line if that is cut.
/// Refuses, with the path in `where`: "cannot be opened: REASON", "is no ordinary file". Context: setup; may block.
Result<OwnedDescriptor> open_to_append(const std::string& path);

/// Makes a folder that only this user may enter; true if there is a folder. Context: setup; may block.
bool make_private_folder(const std::string& path);

/// A new file that is written beside its place first, then renamed to its place. Movable; removes the new file unless
/// put() succeeds. Context: setup; may block.
class PartFile {
 public:
  /// Refuses, with the path in `where`, a place that holds no ordinary file ("is no ordinary file"), and a folder that
  /// refuses a new file ("cannot be written: REASON"). `mode`: permissions of the file, less those of the umask.
  static Result<PartFile> open(const std::string& path, unsigned mode = 0666);
  PartFile(PartFile&& other) noexcept = default;
  PartFile& operator=(PartFile&&) = delete;
  ~PartFile();

  /// Writes `text`, waits until the disk has it, and renames the file to its place, once. Refuses as open().
  Result<void> put(std::string_view text) { return put(text, true); }
  /// As put(), and refuses if there is a file at the place: "is there already".
  Result<void> put_new(std::string_view text) { return put(text, false); }

 private:
  Result<void> put(std::string_view text, bool may_replace);
  PartFile(std::string path, std::string part, OwnedDescriptor file) noexcept
      : path_(std::move(path)), part_(std::move(part)), file_(std::move(file)) {}

  std::string path_, part_;
  OwnedDescriptor file_;
};

/// A file that grows at its end by whole lines, even if a writer dies while it writes. Open to write, and locked
/// against all other LineFiles of the same path. Movable; closes. Context of all functions: setup; may block on the
/// disk and on the lock.
class LineFile {
 public:
  /// Makes the file for this user alone if there is none. Cuts off text behind the last line end: the part of a line
  /// whose writer died. Refuses, with the path in `where`: "is no ordinary file", "cannot be opened: REASON".
  static Result<LineFile> open(const std::string& path);

  std::uint64_t bytes() const noexcept { return bytes_; }
  /// The last whole lines, of at most `most` bytes together.
  std::string tail(std::size_t most) const;
  /// Appends `lines`, each with its end, and waits until the disk has them: all or none. Refuses, with the path in
  /// `where`: "cannot be written: No space left on device".
  Result<void> append(std::string_view lines);
  /// Renames the file to `path`, in place of a file there. Refuses as append(): "cannot be renamed: REASON".
  Result<void> rename_to(const std::string& path);

 private:
  LineFile(std::string path, OwnedDescriptor file, std::uint64_t bytes) noexcept
      : path_(std::move(path)), file_(std::move(file)), bytes_(bytes) {}

  std::string path_;
  OwnedDescriptor file_;
  std::uint64_t bytes_;
};

}  // namespace chimera
