// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/not_ready.h"
#include "chimera/text/json.h"

#include <gtest/gtest.h>

namespace chimera::cli {
namespace {

Json task(const char* name, const char* state, bool in_service) {
  return {{"task", name}, {"component", "csv_log"}, {"rtpu", "servo"}, {"state", state}, {"in_service", in_service}};
}

Json rtpu(const char* phase, const Json& running = nullptr, bool alive = true) {
  return {{"name", "servo"}, {"phase", phase}, {"running", running}, {"alive", alive}};
}

TEST(NotReady, NamesTheTaskAndTheMethod) {
  EXPECT_EQ(not_ready({{"tasks", {task("wave", "OFF", false), task("log", "NOT-CREATED", true)}},
                       {"rtpus", {rtpu("serving")}}}),
            "log (csv_log): its `init` is under way");
  EXPECT_EQ(not_ready({{"tasks", {task("log", "OFF", false)}}, {"rtpus", {rtpu("serving", "log.on")}}}),
            "`log.on` is under way");
}

TEST(NotReady, NamesTheBoardThatDoesNotAnswer) {
  Json board = rtpu("serving");
  board["cpu"] = 1025;
  EXPECT_EQ(not_ready({{"tasks", {task("log", "NOT-CREATED", true)}}, {"rtpus", {board}}}),
            "log waits for a frame of the board 'servo': connect it to the line of its 'link'");
}

TEST(NotReady, NamesAProcessThatDoesNotComeUp) {
  EXPECT_EQ(not_ready({{"tasks", {task("log", "NOT-CREATED", false)}}, {"rtpus", {rtpu("starting")}}}),
            "rtpu servo still makes its tasks (log): it loads a shared object or runs a constructor");
  EXPECT_EQ(not_ready({{"tasks", {task("log", "NOT-CREATED", false)}}, {"rtpus", {rtpu("ended", nullptr, false)}}}),
            "the process of rtpu servo is dead");
}

TEST(NotReady, NamesATaskThatIsOffWhenNoRtpuIsAtFault) {
  EXPECT_EQ(not_ready({{"tasks", {task("a", "OFF", false), task("b", "ON", false)}}, {"rtpus", {rtpu("serving")}}}),
            "a is OFF");
  EXPECT_EQ(not_ready(Json::object()), "the states of its tasks are not known");
}

}  // namespace
}  // namespace chimera::cli
