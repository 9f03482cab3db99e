// SPDX-License-Identifier: Apache-2.0
// Variables: legality of a set of tasks, and the search for the smallest legal set around one.
#include "chimera/runtime/hosted/variables.h"

#include <algorithm>

#include "chimera/runtime/set_words.h"

namespace chimera {
namespace {

SetFault fault_of(const Variable& variable, const std::vector<bool>& on) noexcept {
  return set_fault(variable, [&on](TaskId task) -> bool { return on[task.index]; });
}

}  // namespace

std::string names_in(const std::vector<bool>& on, std::span<const TaskSpec> tasks) {
  std::string names;
  for (std::size_t t = 0; t < on.size(); ++t)
    if (on[t]) names += (names.empty() ? "" : " ") + std::string(tasks[t].name);
  return names;
}

std::size_t Variables::find(std::string_view name) const noexcept {
  for (std::size_t i = 0; i < variables_.size(); ++i)
    if (variables_[i].name == name) return i;
  return variables_.size();
}

bool Variables::is_legal(const std::vector<bool>& on) const noexcept { return is_legal_set(variables_, on); }

std::string Variables::explain(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const {
  const std::string text = fault(on, tasks), help = text.empty() ? "" : remedy(smallest_legal(on), tasks);
  return text + (help.empty() ? "" : "; " + help);
}

std::string Variables::fault(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const {
  std::string text;
  put_set_fault(variables_, on, tasks, [&text](std::string_view part) { text += part; });
  return text;
}

std::string Variables::remedy(const std::vector<bool>& smallest, std::span<const TaskSpec> tasks) {
  return smallest.empty() ? "" : "the smallest legal set is: " + names_in(smallest, tasks);
}

namespace {

constexpr int kTries = 20'000;  // sets looked at: more than any application has needed, milliseconds at most

}  // namespace

// Adds a producer of each missing variable until nothing is missing, any of them where there are several: the
// smallest of the sets found, the first in the order of the description among equals.
std::vector<bool> Variables::smallest_legal(std::vector<bool> on) const {
  std::vector<bool> best;
  int tries = kTries;
  complete(on, best, tries);
  return best;
}

// Leaves `on` as it was, and in `best` the smallest legal set that holds it; gives up after `tries`.
void Variables::complete(std::vector<bool>& on, std::vector<bool>& best, int& tries) const {
  const auto count = [](const std::vector<bool>& set) { return std::count(set.begin(), set.end(), true); };
  if (--tries < 0 || (!best.empty() && count(on) >= count(best))) return;
  const Variable* missing = nullptr;
  for (const Variable& variable : variables_) {
    const SetFault fault = fault_of(variable, on);
    if (fault == SetFault::kTwoProducers) return;
    if (fault == SetFault::kNoProducer && missing == nullptr) missing = &variable;
  }
  if (missing == nullptr) {
    best = on;
    return;
  }
  for (const PortOf& producer : missing->producers) {
    on[producer.task.index] = true;
    complete(on, best, tries);
    on[producer.task.index] = false;
  }
}

}  // namespace chimera
