// SPDX-License-Identifier: Apache-2.0
// Reads any bytes as a descriptor file: no crash, and a descriptor that was read stays equal when written and read
// again.
#include <cstddef>
#include <cstdint>

#include "chimera/base/testing/property.h"
#include "chimera/catalogue/descriptor_json.h"

namespace {

#ifdef CHIMERA_PLANTED_DEFECT
/// A planted defect, to prove that the fuzzer finds one: a read beyond the end for a refusal of more than 200 bytes.
void planted(const chimera::Error& refusal) {
  volatile char copy[201] = {};
  copy[refusal.message.view().size()] = 1;
}
#endif

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto read = chimera::parse_descriptor({reinterpret_cast<const char*>(bytes), size});
  if (!read) {
    chimera::require(!read.error().message.empty(), "a refusal says why");
#ifdef CHIMERA_PLANTED_DEFECT
    planted(read.error());
#endif
    return 0;
  }
  const std::string text = chimera::to_json(read.value());
  if (text.size() > chimera::kMaxDescriptorBytes) return 0;  // indentation may make a legal file too long
  const auto again = chimera::parse_descriptor(text);
  chimera::require(again.has_value(), "what was written can be read");
  chimera::require(again.value() == read.value(), "reading gives back what was written");
  return 0;
}
