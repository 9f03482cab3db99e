// SPDX-License-Identifier: Apache-2.0
// Reads and verifies a description and prints its verdict, its order of tasks, its picture, or its switches.
#include "chimera/cli/files/check.h"

#include "chimera/analysis/link_age.h"
#include "chimera/analysis/mode_report.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/boards.h"
#include "chimera/cli/files/modes_text.h"
#include "chimera/draw/graph_of.h"
#include "chimera/runtime/hosted/together.h"
#include "chimera/verify/offers.h"

namespace chimera::cli {
namespace {

std::string order_text(const Configuration& configuration, std::span<const TaskId> order) {
  return join(order, " -> ", [&](TaskId task) { return configuration.tasks()[task.index].name; });
}

/// The load of the start configuration, and the greatest one of all others and of takeovers, if it is greater.
std::string load_text(const Configuration& configuration, RtpuId rtpu) {
  const ApplicationSpec& spec = configuration.spec();
  const auto load_on = [&](const std::vector<TaskId>& tasks) {
    double load = 0;
    for (const TaskId task : tasks)
      if (spec.tasks[task.index].rtpu == rtpu) load += load_of(spec.tasks[task.index]);
    return load;
  };
  const double start = load_on(all_together(spec.standbys, spec.start)[0].tasks);
  double most = start;
  std::string where;
  for (const ConfiguredSet& set : configuration.sets())
    for (const Together& together : all_together(spec.standbys, set.order)) {
      if (load_on(together.tasks) < most + 0.001) continue;  // as it is printed
      most = load_on(together.tasks);
      where = formatted(", %.3f in configuration ", most) + in_quotes(set.name) + takeover_text(spec, together);
    }
  return most > 0 ? formatted("budgets take %.3f of at most 0.93", start) + where
                  : "no budgets stated, so the load is not judged";
}

/// A line for each rtpu whose policy runs jobs of one instant in another order.
std::string cycles_text(const Configuration& configuration, const ConfiguredSet& set) {
  const ApplicationSpec& spec = configuration.spec();
  std::string text;
  for (std::size_t r = 0; r < spec.rtpus.size(); ++r) {
    std::vector<TaskId> mine = set.order;
    std::erase_if(mine, [&](TaskId task) { return spec.tasks[task.index].rtpu != RtpuId(r); });
    const std::vector<TaskId> cycles = cycle_order(spec, mine);
    if (cycles == mine) continue;
    text += "    cycles on " + std::string(spec.rtpus[r].name) + ", " + std::string(policy_name(spec.rtpus[r].policy)) +
            ": " + order_text(configuration, cycles) + "\n";
  }
  return text;
}

CommandResult check_modes(const CheckOptions& options, const Verdict& verdict, const Library& library) {
  const ModeReport report = mode_report(*verdict.configuration, library);
  CommandResult output;
  output.code = report.is_accepted() ? kOk : kRefused;
  if (options.json) {
    output.out = mode_json(*verdict.configuration, report) + "\n";
    return output;
  }
  output.err = verdict.report.text();
  for (const std::string& warning : report.warnings) output.err += options.file + ": warning: " + warning + "\n";
  output.out = modes_text(*verdict.configuration, report);
  return output;
}

}  // namespace

std::string verdict_text(const Configuration& configuration, bool with_cycles) {
  std::size_t states = 0, constants = 0;
  for (const ConfiguredVariable& variable : configuration.variables()) ++(variable.is_constant ? constants : states);
  std::string text = configuration.subsystem() + ": legal. " + counted(configuration.tasks().size(), "task") + ", " +
                     counted(states, "state variable") + ", " + counted(constants, "constant") + ", " +
                     counted(configuration.sets().size(), "configuration") + "\n";
  for (std::size_t s = 0; s < configuration.sets().size(); ++s) {
    const ConfiguredSet& set = configuration.sets()[s];
    text +=
        "  " + set.name + (s == configuration.start() ? " (start): " : ": ") + order_text(configuration, set.order) +
        "\n" + (with_cycles ? cycles_text(configuration, set) : "");
  }
  for (std::size_t r = 0; r < configuration.rtpus().size(); ++r) {
    const RtpuSpec& rtpu = configuration.rtpus()[r];
    if (rtpu.link.is_there()) continue;  // board_text()
    text += "  rtpu " + std::string(rtpu.name) + " on cpu " + std::to_string(rtpu.cpu) + ": " +
            load_text(configuration, RtpuId(r)) + "\n";
  }
  return text;
}

CommandResult check(const CheckOptions& options, const Workplace& workplace) {
  const auto library = workplace.library(options.file);
  if (!library) return file_refusal(library.error(), options.json);
  const ReadDescription reading = read_description_file(options.file);
  Outlined outlined = verify_with_outline(reading, *library);
  if (options.json) offer_edits(reading, *library, outlined);
  Verdict& verdict = outlined.verdict;
  Boards boards{{}, Report(options.file)};
  if (verdict.configuration) {
    auto set = with_settings(*verdict.configuration, *library, options.settings);
    if (!set) return file_refusal(set.error(), options.json);
    verdict.configuration = *std::move(set);
    verdict.report.add_all(faulty_objects(*verdict.configuration, *library));
    boards = judge_boards(*verdict.configuration, *library, workplace);
    verdict.report.add_all(boards.faults);
  }
  if (options.modes && verdict.configuration && verdict.report.is_legal())
    return check_modes(options, verdict, *library);
  CommandResult output;
  output.code = verdict.report.is_legal() ? kOk : kRefused;
  if (options.json) {
    output.out = verdict.report.json() + "\n";
    return output;
  }
  output.err = verdict.report.text();
  if (!verdict.report.is_legal()) {
    output.err += counted(verdict.report.errors(), "error") + "\n";
    return output;
  }
  if (options.graph.empty()) {
    output.out = verdict_text(*verdict.configuration, true);
    for (const BoardImage& board : boards.images) output.out += board_text(*verdict.configuration, board);
    return output;
  }
  const draw::Graph graph = draw::graph_of(*verdict.configuration);
  output.out = options.graph == "dot"   ? draw::dot(graph)
               : options.graph == "svg" ? draw::svg(graph)
                                        : draw::text(graph);
  return output;
}

}  // namespace chimera::cli
