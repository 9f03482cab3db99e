// SPDX-License-Identifier: Apache-2.0
// Any bytes on a line: a payload that the reader gives is one that the writer would make, and a frame behind the bytes
// is found.
#include <array>
#include <cstdint>
#include <span>

#include "chimera/base/testing/property.h"
#include "chimera/runtime/link/frame.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace chimera;
  using namespace chimera::board_link;
  FrameDecoder reader;
  std::array<std::byte, kMostLineBytes> line{};
  for (const std::uint8_t byte : std::span(bytes, size)) {
    if (!reader.add(static_cast<std::byte>(byte))) continue;
    require(!reader.payload().empty() && reader.payload().size() <= kMostPayload, "a payload has a legal size");
#ifdef CHIMERA_PLANTED_DEFECT
    require(reader.payload().size() != 3, "planted");
#endif
    require(encode_frame(reader.payload(), line) <= line.size(), "a payload can be sent again");
  }
  constexpr std::array kPayload = {std::byte{1}, std::byte{0}, std::byte{2}};
  const std::size_t n = encode_frame(kPayload, line);
  bool is_found = false;
  for (const std::byte byte : std::span(line).first(n)) is_found = reader.add(byte) || is_found;
  require(is_found && reader.payload().size() == kPayload.size(), "a whole frame is found");
  return 0;
}
