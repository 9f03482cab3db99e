// SPDX-License-Identifier: Apache-2.0
// Any bytes on a serial line: each line is refused, or taken apart into words that lie in it; a typed value has the
// bytes of its variable.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/testing/property.h"
#include "chimera/task/abi.h"
#include "firmware/shell/command_line.h"
#include "firmware/shell/line_reader.h"
#include "firmware/shell/typed_value.h"

namespace {

using namespace chimera;
using namespace chimera::firmware;

constexpr std::uint32_t kBytes[] = {1, 4, 8, 4, 8, 16, 24};  // by type, to CHIMERA_STRUCT

void type(const CommandLine& line, std::uint32_t type, std::uint32_t count) {
  std::array<std::byte, kMostValueBytes> memory{};
  const std::span<const std::string_view> words(line.words.begin() + 2, line.words.size() - 2);
  TypedValue value({"x", "m/s", type, kBytes[type], count}, words, line.after_first, memory);
  TextLine why;
  bool is_good = value.begin(why);
  while (is_good && !value.is_complete()) is_good = value.read_next(why);
  require(is_good == (why.size() == 0), "a refusal has a reason");
  if (is_good) require(value.bytes().size() == count * kBytes[type], "a value has its size");
}

void judge(std::string_view text) {
  require(text.size() <= LineReader::kMost, "a line is not too long");
  const CommandLine line = parse(text);
  const char* at = text.data();
  for (const std::string_view word : line.words) {
    require(!word.empty() && word.data() >= at, "words stand in their order");
    at = word.data() + word.size();
    require(at <= text.data() + text.size(), "a word lies in the line");
    require(word.find_first_of(" \t") == std::string_view::npos, "a word has no blank");
  }
  if (line.fault != LineFault::kNone || line.command == nullptr) return;
  require(line.n_operands() <= line.command->most, "a command has no more operands than it takes");
#ifdef CHIMERA_PLANTED_DEFECT
  require(line.command->verb != Verb::kSwitch, "planted");
#endif
  if (line.command->verb != Verb::kSet) return;
  for (std::uint32_t each = CHIMERA_BOOL; each <= CHIMERA_STRUCT; ++each)
    for (const std::uint32_t count : {1u, 2u, 5u}) type(line, each, count);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  LineReader reader;
  for (const std::uint8_t byte : std::span(bytes, size)) {
    if (!reader.add(byte)) continue;
    if (reader.fault() == LineReader::Fault::kNone) judge(reader.line());
    reader.restart();
  }
  return 0;
}
