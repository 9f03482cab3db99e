// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/variables.h"

#include <algorithm>

namespace chimera {

std::size_t Variables::find(std::string_view name) const noexcept {
  for (std::size_t i = 0; i < variables_.size(); ++i)
    if (variables_[i].name == name) return i;
  return variables_.size();
}

std::size_t Variables::index_of(std::string_view name) {
  const std::size_t found = find(name);
  if (found == variables_.size()) variables_.push_back({name, {}, {}, UINT32_MAX});
  return found;
}

Variables::Variables(const ApplicationSpec& spec) {
  for (std::size_t o = 0; o < spec.operators.size(); ++o)
    variables_[index_of(spec.operators[o].name)].operator_index = static_cast<std::uint32_t>(o);
  inputs_.resize(spec.tasks.size());
  outputs_.resize(spec.tasks.size());
  for (std::size_t t = 0; t < spec.tasks.size(); ++t) {
    for (std::size_t p = 0; p < spec.tasks[t].ports.size(); ++p) {
      const std::uint32_t kind = spec.tasks[t].ports[p].kind;
      if (kind != CHIMERA_IN_VAR && kind != CHIMERA_OUT_VAR) continue;
      const std::size_t v = index_of(spec.tasks[t].ports[p].variable);
      auto& mine = kind == CHIMERA_IN_VAR ? inputs_[t] : outputs_[t];
      auto& theirs = kind == CHIMERA_IN_VAR ? variables_[v].consumers : variables_[v].producers;
      theirs.push_back({TaskId(t), static_cast<std::uint32_t>(mine.size())});
      mine.push_back(VariableId(v));
    }
  }
}

std::size_t Variables::writers(const Variable& variable, const std::vector<bool>& on) const noexcept {
  std::size_t n = variable.operator_index == UINT32_MAX ? 0 : 1;
  for (const PortOf& producer : variable.producers) n += on[producer.task.index] ? 1 : 0;
  return n;
}

bool Variables::is_read(const Variable& variable, const std::vector<bool>& on) const noexcept {
  for (const PortOf& consumer : variable.consumers)
    if (on[consumer.task.index]) return true;
  return false;
}

bool Variables::is_legal(const std::vector<bool>& on) const noexcept {
  for (const Variable& variable : variables_) {
    const std::size_t n = writers(variable, on);
    if (n > 1 || (n == 0 && is_read(variable, on))) return false;
  }
  return true;
}

std::string Variables::explain(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const {
  const std::string text = fault(on, tasks), help = text.empty() ? "" : remedy(on, tasks);
  return text + (help.empty() ? "" : "; " + help);
}

std::string Variables::fault(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const {
  std::string text;
  const auto add = [&text](std::string part) { text += (text.empty() ? "" : "; ") + std::move(part); };
  for (const Variable& variable : variables_) {
    const std::size_t n = writers(variable, on);
    if (n > 1) {
      std::string who;
      for (const PortOf& p : variable.producers)
        if (on[p.task.index]) who += (who.empty() ? "" : " and ") + std::string(tasks[p.task.index].name);
      add(std::string(variable.name) + " would have two producers: " + who);
    } else if (n == 0 && is_read(variable, on)) {
      add(std::string(variable.name) + " would have no producer");
    }
  }
  return text;
}

std::string Variables::remedy(const std::vector<bool>& on, std::span<const TaskSpec> tasks) const {
  const std::string names = smallest_legal(on, tasks);
  return names.empty() ? "" : "the smallest legal set is: " + names;
}

namespace {

constexpr int kTries = 20'000;  // sets looked at: more than any application has needed, milliseconds at most

}  // namespace

// Adds a producer of each missing variable until nothing is missing, any of them where there are several: the
// smallest of the sets found, the first in the order of the description among equals.
std::string Variables::smallest_legal(std::vector<bool> on, std::span<const TaskSpec> tasks) const {
  std::vector<bool> best;
  int tries = kTries;
  complete(on, best, tries);
  std::string names;
  for (std::size_t t = 0; t < best.size(); ++t)
    if (best[t]) names += (names.empty() ? "" : " ") + std::string(tasks[t].name);
  return names;
}

// Leaves `on` as it was, and in `best` the smallest legal set that holds it; gives up after `tries`.
void Variables::complete(std::vector<bool>& on, std::vector<bool>& best, int& tries) const {
  const auto count = [](const std::vector<bool>& set) { return std::count(set.begin(), set.end(), true); };
  if (--tries < 0 || (!best.empty() && count(on) >= count(best))) return;
  const Variable* missing = nullptr;
  for (const Variable& variable : variables_) {
    const std::size_t n = writers(variable, on);
    if (n > 1) return;
    if (n == 0 && missing == nullptr && is_read(variable, on)) missing = &variable;
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
