// SPDX-License-Identifier: Apache-2.0
// Names the tasks and rtpus that a starting subsystem waits for.
#include "chimera/cli/run/not_ready.h"

#include <vector>

#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  return all;
}

/// The names of the tasks of an rtpu.
std::string tasks_of(const Json& status, const std::string& rtpu) {
  std::string names;
  for (const Json& task : status["tasks"])
    if (text_at(task, "rtpu") == rtpu) names += (names.empty() ? "" : ", ") + text_at(task, "task");
  return names;
}

}  // namespace

std::string not_ready(const Json& status) {
  std::vector<std::string> under_way, idle;
  for (const Json& task : status["tasks"]) {
    const std::string state = text_at(task, "state"), name = text_at(task, "task");
    if (truth_at(task, "in_service"))
      under_way.push_back(name + " (" + text_at(task, "component") + "): its `" +
                          (state == "NOT-CREATED" ? "init" : "kill") + "` is under way");
    else if (state != "ON")
      idle.push_back(name + " is " + state);
  }
  for (const Json& rtpu : status["rtpus"]) {
    const std::string name = text_at(rtpu, "name"), running = text_at(rtpu, "running");
    if (!truth_at(rtpu, "alive"))
      under_way.push_back("the process of rtpu " + name + " is dead");
    else if (text_at(rtpu, "phase") == "starting")
      under_way.push_back("rtpu " + name + " still makes its tasks (" + tasks_of(status, name) +
                          "): it loads a shared object or runs a constructor");
    else if (!running.empty())
      under_way.push_back("`" + running + "` is under way");
  }
  if (!under_way.empty()) return joined(under_way);
  return idle.empty() ? "the states of its tasks are not known" : joined(idle);
}

}  // namespace chimera::cli
