// SPDX-License-Identifier: Apache-2.0
// Names the tasks and units that a starting subsystem waits for.
#include "chimera/cli/run/not_ready.h"

#include <nlohmann/json.hpp>
#include <vector>

namespace chimera::cli {
namespace {

using Json = nlohmann::json;

std::string word_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  return all;
}

/// The names of the tasks of a real-time unit.
std::string tasks_of(const Json& status, const std::string& rtpu) {
  std::string names;
  for (const Json& task : status.value("tasks", Json::array()))
    if (word_of(task, "rtpu") == rtpu) names += (names.empty() ? "" : ", ") + word_of(task, "task");
  return names;
}

}  // namespace

std::string not_ready(const Json& status) {
  std::vector<std::string> under_way, idle;
  for (const Json& task : status.value("tasks", Json::array())) {
    const std::string state = word_of(task, "state"), name = word_of(task, "task");
    if (task.value("in_service", false))
      under_way.push_back(name + " (" + word_of(task, "component") + "): its `" +
                          (state == "NOT-CREATED" ? "init" : "kill") + "` is under way");
    else if (state != "ON")
      idle.push_back(name + " is " + state);
  }
  for (const Json& rtpu : status.value("rtpus", Json::array())) {
    const std::string name = word_of(rtpu, "name"), running = word_of(rtpu, "running");
    if (!rtpu.value("alive", false))
      under_way.push_back("the process of real-time unit " + name + " is dead");
    else if (word_of(rtpu, "phase") == "starting")
      under_way.push_back("real-time unit " + name + " still makes its tasks (" + tasks_of(status, name) +
                          "): it loads a shared object or runs a constructor");
    else if (!running.empty())
      under_way.push_back("`" + running + "` is under way");
  }
  if (!under_way.empty()) return joined(under_way);
  return idle.empty() ? "the states of its tasks are not known" : joined(idle);
}

}  // namespace chimera::cli
