// SPDX-License-Identifier: Apache-2.0
// The component of tests/conformance/toy.h for an image: it counts its cycles and follows its script.
#include <cstddef>
#include <cstring>

#include "chimera/task/signal.h"
#include "tests/firmware/toys/toys.h"

namespace chimera::baked_toys {
namespace {

/// Zeroed by the framework.
struct State {
  chimera_port me, out, in;
  double value;
  std::uint32_t n_sync, n_error, n_sent;
};

const Toy& toy_of(const State& state) noexcept {
  std::int64_t number = 0;
  std::memcpy(&number, state.me.value, sizeof number);
  return kToys[static_cast<std::size_t>(number)];
}

std::int32_t next(std::span<const std::int32_t> answers, std::uint32_t& n) noexcept {
  return n < answers.size() ? answers[n++] : std::int32_t{CHIMERA_OK};
}

std::int32_t cycle(void* memory, const chimera_call* call) {
  State& state = *static_cast<State*>(memory);
  const Toy& toy = toy_of(state);
  if (toy.spend_ns > 0) call->host->spend(call->context, toy.spend_ns);
  state.value += 1;
  if (state.out.value != nullptr) std::memcpy(state.out.value, &state.value, sizeof state.value);
  if (state.n_sent >= toy.sends.size()) return CHIMERA_OK;
  const Sent& sent = toy.sends[state.n_sent++];
  if (sent.target[0] != '\0')
    call->host->signal(call->context, static_cast<std::uint32_t>(sent.signal), sent.target);
  return CHIMERA_OK;
}

std::int32_t sync(void* memory, const chimera_call*) {
  State& state = *static_cast<State*>(memory);
  return next(toy_of(state).sync_answers, state.n_sync);
}

std::int32_t error(void* memory, const chimera_call*) {
  State& state = *static_cast<State*>(memory);
  return next(toy_of(state).error_answers, state.n_error);
}

std::int32_t nothing(void*, const chimera_call*) { return CHIMERA_OK; }
std::int32_t construct(void*, chimera_fault*) { return CHIMERA_OK; }
void destroy(void*) {}

constexpr chimera_port_decl port(const char* name, std::uint32_t kind, std::uint32_t type, std::size_t offset) {
  chimera_port_decl p{};
  p.name = name;
  p.doc = p.shape = p.frame = p.type_name = "";
  p.unit = "1";
  p.kind = kind;
  p.type = type;
  p.element_size = 8;
  p.max_instances = 1;
  p.live_offset = static_cast<std::uint32_t>(offset);
  return p;
}

constexpr chimera_port_decl kPorts[] = {port("me", CHIMERA_IN_CONST, CHIMERA_INT64, offsetof(State, me)),
                                        port("out", CHIMERA_OUT_VAR, CHIMERA_FLOAT64, offsetof(State, out)),
                                        port("in", CHIMERA_IN_VAR, CHIMERA_FLOAT64, offsetof(State, in))};

constexpr chimera_component component(bool with_sync) {
  chimera_component c{};
  c.abi_version = CHIMERA_ABI_VERSION;
  c.struct_size = sizeof c;
  c.name = "toy";
  c.doc = c.source = "";
  c.state_size = sizeof(State);
  c.state_align = alignof(State);
  c.n_ports = 3;
  c.ports = kPorts;
  c.construct = construct;
  c.destroy = destroy;
  for (auto& method : c.methods) method = nothing;
  c.methods[CHIMERA_CYCLE] = cycle;
  c.methods[CHIMERA_ERROR] = error;
  c.methods[CHIMERA_SYNC] = with_sync ? sync : nullptr;
  return c;
}

}  // namespace
}  // namespace chimera::baked_toys

extern "C" {
extern const chimera_component chimera_component_toy, chimera_component_toy_polled;
constinit const chimera_component chimera_component_toy = chimera::baked_toys::component(false);
constinit const chimera_component chimera_component_toy_polled = chimera::baked_toys::component(true);
}
