// SPDX-License-Identifier: Apache-2.0
// For tests: declarations of components without code.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chimera/load/descriptor.h"

namespace chimera::testing {

inline std::int32_t construct(void*, chimera_fault*) { return CHIMERA_OK; }
inline void destroy(void*) {}
inline std::int32_t nothing(void*, const chimera_call*) { return CHIMERA_OK; }

inline chimera_port_decl port(const char* name, std::uint32_t kind, const char* unit = "1") {
  chimera_port_decl p{};
  p.name = name;
  p.doc = "";
  p.unit = unit;
  p.shape = "";
  p.frame = "";
  p.type_name = "";
  p.kind = kind;
  p.type = CHIMERA_FLOAT64;
  p.element_size = 8;
  p.max_instances = 1;
  return p;
}

/// A legal component with ports x (in) and dx (out), for tests that make it illegal.
struct Sample {
  double zero = 0;
  std::vector<chimera_port_decl> ports{port("x", CHIMERA_IN_VAR, "U"), port("dx", CHIMERA_OUT_VAR, "U/s")};
  chimera_component component{};

  Sample() {
    component.abi_version = CHIMERA_ABI_VERSION;
    component.struct_size = sizeof(chimera_component);
    component.name = "tderiv";
    component.doc = "Time derivative of one signal.";
    component.default_rate_hz = 100;
    component.state_size = 4096;
    component.state_align = 8;
    component.construct = construct;
    component.destroy = destroy;
    component.methods[CHIMERA_CYCLE] = nothing;
    set_initial(1, &zero);
  }
  void set_initial(std::size_t i, const void* bytes, std::uint32_t count = 1) {
    ports[i].flags |= CHIMERA_PORT_HAS_INITIAL;
    ports[i].initial = bytes;
    ports[i].initial_count = count;
  }
  Result<Descriptor> described() {
    component.n_ports = static_cast<std::uint32_t>(ports.size());
    component.ports = ports.data();
    return describe(component);
  }
  std::string refusal() {
    const auto result = described();
    return result ? "accepted" : std::string(result.error().message.view());
  }
};

}  // namespace chimera::testing
