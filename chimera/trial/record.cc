// SPDX-License-Identifier: Apache-2.0
#include "chimera/trial/record.h"

#include <sys/mman.h>

#include <new>
#include <utility>

#include "chimera/base/assert.h"

namespace chimera::trial {
namespace {

constexpr std::size_t kFixed = (sizeof(Record) + 63) / 64 * 64;

}  // namespace

SharedRecord::SharedRecord(std::size_t rows, std::size_t payload)
    : rows_(rows), payload_(payload), bytes_(kFixed + rows * (sizeof(RowRecord) + payload)),
      memory_(::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0)) {
  CHIMERA_ASSERT(memory_ != MAP_FAILED);
  new (memory_) Record;
}

SharedRecord::SharedRecord(SharedRecord&& other) noexcept
    : rows_(other.rows_), payload_(other.payload_), bytes_(other.bytes_),
      memory_(std::exchange(other.memory_, nullptr)) {}

SharedRecord::~SharedRecord() {
  if (memory_ != nullptr) ::munmap(memory_, bytes_);
}

std::span<RowRecord> SharedRecord::rows() const noexcept {
  return {reinterpret_cast<RowRecord*>(static_cast<std::byte*>(memory_) + kFixed), rows_};
}

std::span<std::byte> SharedRecord::outputs(std::size_t i) const noexcept {
  std::byte* first = static_cast<std::byte*>(memory_) + kFixed + rows_ * sizeof(RowRecord);
  return {first + i * payload_, payload_};
}

std::vector<OutputPlace> output_places(const ApplicationSpec& spec, std::size_t& payload) {
  std::vector<OutputPlace> places;
  payload = 0;
  for (const PortSpec& port : spec.tasks[0].ports) {
    if (port.kind != CHIMERA_OUT_VAR) continue;
    places.push_back({&port, payload, port.max_bytes()});
    payload += (port.max_bytes() + 7) / 8 * 8;
  }
  return places;
}

}  // namespace chimera::trial
