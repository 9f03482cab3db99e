// SPDX-License-Identifier: Apache-2.0
// Names the tasks and rtpus that a starting subsystem waits for.
#include "chimera/cli/print/not_ready.h"

#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/cpu_text.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

/// The names of the tasks of an rtpu.
std::string tasks_of(const Json& status, const std::string& rtpu) {
  std::string names;
  for (const Json& task : status["tasks"])
    if (text_at(task, "rtpu") == rtpu) append_joined(names, ", ", text_at(task, "task"));
  return names;
}

bool is_board(const Json& status, const std::string& rtpu) {
  for (const Json& each : status["rtpus"])
    if (text_at(each, "name") == rtpu) return whole_at(each, "cpu") >= kFirstBoardCpu;
  return false;
}

}  // namespace

std::string not_ready(const Json& status) {
  std::string under_way, idle;
  for (const Json& task : status["tasks"]) {
    const std::string state = text_at(task, "state"), name = text_at(task, "task");
    if (truth_at(task, "in_service") && is_board(status, text_at(task, "rtpu")))
      append_joined(under_way, "; ", name + " waits for a frame of the board '" + text_at(task, "rtpu") +
                                         "': connect it to the line of its 'link'");
    else if (truth_at(task, "in_service"))
      append_joined(under_way, "; ", name + " (" + text_at(task, "component") + "): its `" +
                                         (state == "NOT-CREATED" ? "init" : "kill") + "` is under way");
    else if (state != "ON")
      append_joined(idle, "; ", name + " is " + state);
  }
  for (const Json& rtpu : status["rtpus"]) {
    const std::string name = text_at(rtpu, "name"), running = text_at(rtpu, "running");
    if (!truth_at(rtpu, "alive"))
      append_joined(under_way, "; ", "the process of rtpu " + name + " is dead");
    else if (text_at(rtpu, "phase") == "starting")
      append_joined(under_way, "; ", "rtpu " + name + " still makes its tasks (" + tasks_of(status, name) +
                                         "): it loads a shared object or runs a constructor");
    else if (!running.empty())
      append_joined(under_way, "; ", "`" + running + "` is under way");
  }
  if (!under_way.empty()) return under_way;
  return idle.empty() ? "the states of its tasks are not known" : idle;
}

}  // namespace chimera::cli
