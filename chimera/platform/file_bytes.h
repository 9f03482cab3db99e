// SPDX-License-Identifier: Apache-2.0
// Reading an open file at any place, without moving where others read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace chimera {

/// Bytes of the open file; -1 when that cannot be told. Context: setup.
std::int64_t file_size(int file) noexcept;

/// Reads from `offset` on until `to` is full or the file ends; how many bytes, -1 on an error of the system.
/// Context: setup; may block on the disk.
std::int64_t read_at(int file, std::uint64_t offset, std::span<std::byte> to) noexcept;

}  // namespace chimera
