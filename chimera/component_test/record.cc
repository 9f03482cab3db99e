// SPDX-License-Identifier: Apache-2.0
// Lays out the record of a run in memory shared with the child.
#include "chimera/component_test/record.h"

#include <new>

#include "chimera/base/assert.h"

namespace chimera::component_test {
namespace {

constexpr std::size_t kFixed = (sizeof(Record) + 63) / 64 * 64;

}  // namespace

SharedRecord::SharedRecord(std::size_t rows, std::size_t payload) : rows_(rows), payload_(payload) {
  auto memory = FamilyMemory::create(kFixed + rows * (sizeof(RowRecord) + payload));
  CHIMERA_ASSERT(memory.has_value());
  memory_ = *std::move(memory);
  new (memory_.bytes().data()) Record;
}

std::span<RowRecord> SharedRecord::rows() const noexcept {
  return {reinterpret_cast<RowRecord*>(memory_.bytes().data() + kFixed), rows_};
}

std::span<std::byte> SharedRecord::outputs(std::size_t i) const noexcept {
  std::byte* first = memory_.bytes().data() + kFixed + rows_ * sizeof(RowRecord);
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

}  // namespace chimera::component_test
