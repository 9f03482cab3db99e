// SPDX-License-Identifier: Apache-2.0
// Takes the tasks of one rtpu out of a draft, verifies them again, and compares both results port by port.
#include "chimera/bake/board_part.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/link/link_layout.h"

namespace chimera::bake {
namespace {

Node scalar(std::string text, Place at, bool quoted = false) {
  Node node;
  node.kind = Node::Kind::kScalar;
  node.at = at;
  node.text = std::move(text);
  node.quoted = quoted;
  return node;
}

class BoardPart {
 public:
  BoardPart(const Configuration& whole, RtpuId rtpu) : whole_(whole), spec_(whole.spec()), rtpu_(rtpu) {}

  Draft take() {
    const Draft& all = whole_.draft();
    Draft part = all;
    part.sequence.reset();
    part.rtpus = {all.rtpus[rtpu_.index]};
    part.rtpus[0].target.reset();
    part.rtpus[0].link.reset();
    std::erase_if(part.tasks, [&](const DraftTask& task) { return !is_here(task.name.text); });
    part.operators.clear();
    for (const Variable& variable : spec_.variables)
      if (const PortSpec* port = board_link::import_port(spec_, rtpu_, variable)) add_operator(part, variable, *port);
    for (DraftSet& set : part.configurations) {
      std::erase_if(set.tasks, [&](const Word& task) { return !is_here(task.text); });
      set.safe_when.reset();
    }
    std::erase_if(part.configurations, [](const DraftSet& set) { return set.tasks.empty(); });
    const auto is_start = [&](const DraftSet& set) { return part.start && set.name.text == part.start->text; };
    if (std::ranges::none_of(part.configurations, is_start)) part.start.reset();
    return part;
  }

 private:
  bool is_here(const std::string& task) const {
    return std::ranges::any_of(whole_.tasks(), [&](const ConfiguredTask& each) {
      return each.name == task && each.rtpu == rtpu_.index;
    });
  }

  /// A variable of the file's operator keeps its value. The default of an input that nothing feeds needs none.
  void add_operator(Draft& part, const Variable& variable, const PortSpec& port) const {
    const auto& written = whole_.draft().operators;
    const auto found = std::ranges::find(written, variable.name, [](const NamedNode& node) -> std::string_view {
      return node.name.text;
    });
    if (found != written.end()) return part.operators.push_back(*found);
    if (variable.is_given()) return;
    const Place at = whole_.draft().rtpus[rtpu_.index].name.at;
    part.operators.push_back({Word{std::string(variable.name), at}, value_of(variable, port, at)});
  }

  /// Zero, or what is nearest to it in the ranges of all readers on the board.
  Node value_of(const Variable& variable, const PortSpec& port, Place at) const {
    if (port.type == CHIMERA_BOOL) return scalar("false", at);
    if (port.type == CHIMERA_STRING) return scalar("", at, true);
    double value = 0;
    for (const PortOf& reader : variable.consumers)
      if (spec_.tasks[reader.task.index].rtpu == rtpu_)
        if (const PortSpec* range = spec_.port(CHIMERA_IN_VAR, reader); range->has_range)
          value = std::clamp(value, range->min, range->max);
    char text[40];
    const bool is_whole = port.type == CHIMERA_INT32 || port.type == CHIMERA_INT64;
    std::snprintf(text, sizeof text, is_whole ? "%.0f" : "%.17g", is_whole ? std::ceil(value) : value);
    return scalar(std::string(text) + (port.unit == "1" ? "" : " " + std::string(port.unit)), at);
  }

  const Configuration& whole_;
  const ApplicationSpec& spec_;
  RtpuId rtpu_;
};

/// Both have the same tasks of the board, with the same ports.
void compare(const Configuration& whole, RtpuId rtpu, const Configuration& part, Report& report) {
  std::size_t of_part = 0;
  for (std::size_t t = 0; t < whole.tasks().size(); ++t) {
    if (whole.tasks()[t].rtpu != rtpu.index) continue;
    const TaskSpec &a = whole.spec().tasks[t], &b = part.spec().tasks[of_part++];
    for (std::size_t p = 0; p < std::min(a.ports.size(), b.ports.size()); ++p) {
      if (a.ports[p].unit == b.ports[p].unit && a.ports[p].type == b.ports[p].type &&
          a.ports[p].max_bytes() == b.ports[p].max_bytes())
        continue;
      report.add({.rule = "board-rtpu",
                  .at = whole.tasks()[t].at,
                  .message = "port " + in_quotes(whole.tasks()[t].ports[p].name) + " of task " + in_quotes(a.name) +
                             " gets its type, unit or shape from a task of another rtpu, but runs on the board " +
                             in_quotes(whole.rtpus()[rtpu.index].name),
                  .remedy = "use a component whose port has a type, unit and shape of its own"});
    }
  }
}

}  // namespace

Verdict board_part(const Configuration& whole, RtpuId rtpu, const Library& library) {
  Verdict verdict = verify(BoardPart(whole, rtpu).take(), library);
  Report errors(whole.file(), whole.draft().keys);
  for (const Fault& fault : verdict.report.faults())
    if (fault.severity == Severity::kError) errors.add(fault);
  if (verdict.configuration) compare(whole, rtpu, *verdict.configuration, errors);
  if (!errors.is_legal()) verdict.configuration.reset();
  verdict.report = std::move(errors);
  return verdict;
}

}  // namespace chimera::bake
