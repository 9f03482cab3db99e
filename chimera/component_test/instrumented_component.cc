// SPDX-License-Identifier: Apache-2.0
// Counts allocations and time around each method of a component, and returns faults on demand.
#include "chimera/component_test/instrumented_component.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "chimera/platform/allocation_count.h"

namespace chimera::component_test {
namespace {

InstrumentedComponent* present = nullptr;  // a method of the C interface gets only the state of its component

template <std::uint32_t kMethod>
std::int32_t through_shim(void* state, const chimera_call* call) {
  return present->call(kMethod, state, call);
}

template <std::size_t... kMethods>
constexpr std::array<chimera_method, CHIMERA_METHODS> all(std::index_sequence<kMethods...>) {
  return {&through_shim<kMethods>...};
}
constexpr auto kThrough = all(std::make_index_sequence<CHIMERA_METHODS>{});

}  // namespace

InstrumentedComponent::InstrumentedComponent(const chimera_component& real, Record& record)
    : real_(real), record_(record) {
  std::memcpy(&wrapped_, &real, std::min<std::size_t>(real.struct_size, sizeof wrapped_));
  wrapped_.struct_size = sizeof wrapped_;
  for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m) wrapped_.methods[m] = has(m) ? kThrough[m] : nullptr;
  measure_measuring();
  present = this;
}

InstrumentedComponent::~InstrumentedComponent() { present = nullptr; }

void InstrumentedComponent::measure_measuring() noexcept {
  for (std::int64_t& time : record_.measuring_ns) {
    const Nanoseconds began = clock_.now();
    time = (clock_.now() - began).count;
  }
}

std::int32_t InstrumentedComponent::call(std::uint32_t method, void* state, const chimera_call* call) noexcept {
  MethodRecord& counts = record_.methods[method];
  record_.method = method;
  record_.progress.fetch_add(1, std::memory_order_relaxed);
  const std::uint64_t allocations = allocations_of_this_thread(), system_calls = counts.system_calls;
  record_.watched.store(method + 1, std::memory_order_seq_cst);
  const Nanoseconds began = clock_.now();
  std::int32_t answer = real_.methods[method](state, call);
  const Nanoseconds ended = clock_.now();
  record_.watched.store(0, std::memory_order_seq_cst);
  ++counts.calls;
  const std::uint64_t asked = allocations_of_this_thread() - allocations;
  counts.allocations += asked;
  counts.most_allocations = std::max(counts.most_allocations, asked);
  counts.most_system_calls = std::max(counts.most_system_calls, counts.system_calls - system_calls);
  if (method == CHIMERA_CYCLE) cycle_time_ = ended - began;
  if (fails_[method]) {
    fails_[method] = false;
    std::strcpy(call->fault->text, "a fault on purpose");
    answer = CHIMERA_FAULT;
  }
  return answer;
}

}  // namespace chimera::component_test
