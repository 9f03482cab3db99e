// SPDX-License-Identifier: Apache-2.0
#include "library/device/sentence.h"

#include <gtest/gtest.h>
#include <unistd.h>

namespace chimera::library {
namespace {

TEST(OpenRefusal, NamesThePathTheReasonAndTheRemedy) {
  EXPECT_EQ(open_refusal("/dev/ttyUSB0", ENOENT),
            "/dev/ttyUSB0: No such file or directory: plug the device in, or name another under `resources`");
  EXPECT_EQ(open_refusal("/dev/ttyUSB0", EBUSY),
            "/dev/ttyUSB0: Device or resource busy: check the path, and end a process that has it open");
  EXPECT_EQ(open_refusal("/nowhere", EACCES),
            "/nowhere: Permission denied: add the user to the group dialout or input and log in again");
}

TEST(LostSentence, KeepsTheEndOfALongPath) {
  LostSentence sentence;
  sentence.set("/dev/ttyUSB0", "is gone");
  EXPECT_STREQ(sentence.text(), "/dev/ttyUSB0 is gone: bring it back, then `clear` and `on`");
  sentence.set("/" + std::string(100, 'x') + "/port", "is silent");
  EXPECT_EQ(sentence.text(), "..." + std::string(55, 'x') + "/port is silent: bring it back, then `clear` and `on`");
}

}  // namespace
}  // namespace chimera::library
