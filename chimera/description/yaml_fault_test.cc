// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/description/draft.h"

namespace chimera {
namespace {

std::string said(std::string_view text) { return read_description(text, "a.yaml").report.text(); }

TEST(YamlFault, NamesTheBracketThatIsNotClosed) {
  EXPECT_EQ(said("subsystem: demo\ntasks:\n  pid: {rate: 1 kHz, constants: {kp: 1}\n  arm: {rate: 1 kHz}\n"),
            "a.yaml:3:8: error: not YAML: nothing closes this '{' [yaml-syntax]\n  add the missing '}'\n");
  EXPECT_EQ(said("subsystem: demo\nconfigurations: {all: [pid, arm}\n"),
            "a.yaml:2:32: error: not YAML: '}' stands where the '[' of 2:23 has to be closed [yaml-syntax]\n"
            "  add the missing ']', or take this one out\n");
}

TEST(YamlFault, PassesOverQuotesAndComments) {
  EXPECT_EQ(said("subsystem: 'd{'  # {\nresource: \"a\\\"{\"\ntasks: {pid: {rate: it's}\n"),
            "a.yaml:3:8: error: not YAML: nothing closes this '{' [yaml-syntax]\n  add the missing '}'\n");
}

TEST(YamlFault, NamesTheColonWithoutItsSpace) {
  EXPECT_EQ(said("subsystem: demo\nconstants:\n  kp:0.2 V\n  ki: 1 V\n"),
            "a.yaml:3:3: error: not YAML: no space after the ':' of 'kp:' [yaml-syntax]\n  write 'kp: 0.2 V'\n");
}

TEST(YamlFault, SaysHowKeysOfOneMapStand) {
  EXPECT_EQ(said("subsystem: demo\n tasks: {}\n"),
            "a.yaml:2:7: error: not YAML: illegal map value [yaml-syntax]\n"
            "  begin the keys of one map in the same column; the line above has its value already\n");
}

TEST(YamlFault, AFileThatIsNoTextIsNotSplit) {
  const std::string binary = std::string(
                                 "\x7f"
                                 "ELF\x02\x01\x01\0",
                                 8) +
                             std::string(300'000, '\0');
  EXPECT_EQ(said(binary),
            "a.yaml:1:1: error: byte 0x7F is a control character [text-encoding]\n"
            "  this is a binary file; a description is YAML text\n");
}

TEST(YamlFault, AnEmptyFileIsCalledEmpty) {
  EXPECT_EQ(said("# nothing yet\n"),
            "a.yaml: error: the file is empty; a description starts with 'subsystem: NAME' "
            "[value-kind]\n  'chimera new app NAME' writes one\n");
}

}  // namespace
}  // namespace chimera
