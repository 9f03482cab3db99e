// SPDX-License-Identifier: Apache-2.0
// Any bytes as a descriptor file: refused or read, never a crash; and what was read is written and read back equal.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "chimera/config/descriptor_json.h"

namespace {

void require(bool kept, const char* property) {
  if (kept) return;
  std::fprintf(stderr, "property broken: %s\n", property);
  std::abort();
}

#ifdef CHIMERA_PLANTED_DEFECT
/// A defect to prove that the fuzzer finds one: beyond the end for ports of more than 4 instances.
void planted(const chimera::Descriptor& descriptor) {
  for (const chimera::PortDescriptor& port : descriptor.ports) {
    volatile char marks[5] = {};
    marks[port.max_instances] = 1;
  }
}
#endif

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto read = chimera::parse_descriptor({reinterpret_cast<const char*>(bytes), size});
  if (!read) {
    require(!read.error().message.empty(), "a refusal says why");
    return 0;
  }
#ifdef CHIMERA_PLANTED_DEFECT
  planted(read.value());
#endif
  const std::string text = chimera::to_json(read.value());
  if (text.size() > chimera::kMaxDescriptorBytes) return 0;  // indentation may make a legal file too long
  const auto again = chimera::parse_descriptor(text);
  require(again.has_value(), "what was written can be read");
  require(again.value() == read.value(), "reading gives back what was written");
  return 0;
}
