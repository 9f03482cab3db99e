// SPDX-License-Identifier: Apache-2.0
// Stage 2 in one pass: links, calls every rule, and only then makes the configuration.
#include "chimera/verify/verify.h"

#include <algorithm>

#include "chimera/catalogue/library.h"
#include "chimera/verify/board_links.h"
#include "chimera/verify/model.h"
#include "chimera/verify/outline.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

void link(Model& model) {
  find_components(model);
  link_ports(model);
  require_resources(model);
  place_tasks(model);
  make_sets(model);
  pair_standbys(model);
  link_left_out(model);
  collect_variables(model);
}

void judge_links(Model& model) {
  refuse_two_producers(model);
  find_unmet_inputs(model);
  settle_constants(model);
}

void judge_values(Model& model) {
  agree_on_types(model);
  agree_on_units(model);
  refuse_unmet_inputs(model);
  agree_on_shapes(model);
  share_maxima(model);
  limit_table(model);
  check_values(model);
  check_conditions(model);
  check_sequence(model);
  check_order_of_constants(model);
}

void judge_order(Model& model) {
  order_constants(model);
  order_sets(model);
  order_cycles(model);
  check_times(model);
  limit_utilisation(model);
  check_bands(model);
  check_standbys(model);
  warn_of_unused(model);
}

/// The links of boards are judged by the whole, so only when all else is legal.
void judge_boards(const Configuration& configuration, Verdict& verdict) {
  const std::size_t before = verdict.report.errors();
  judge_board_links(configuration, verdict.report);
  if (verdict.report.errors() != before) verdict.configuration.reset();
}

Verdict judge(const Draft& draft, const Library& library, Report report, Overload overload,
              std::optional<Outline>* outline = nullptr) {
  Verdict verdict{std::nullopt, std::move(report)};
  verdict.report.use(draft.keys);
  if (draft.tasks.empty() && !draft.is_partial && verdict.report.is_legal())
    verdict.report.add({.rule = "key-missing",
                        .at = draft.subsystem.at,
                        .message = "there is no task",
                        .expected = "tasks",
                        .remedy = "write 'tasks:' and a line 'NAME: {component: COMPONENT, rate: 100 Hz}' for each"});
  Model model(draft, library, verdict.report);
  model.overload = overload;
  link(model);
  judge_links(model);
  judge_values(model);
  judge_order(model);
  const auto is_overload = [](const Fault& fault) {
    return fault.rule == "utilisation" && fault.severity == Severity::kError;
  };
  const auto overloads = std::ranges::count_if(verdict.report.faults(), is_overload);
  if (verdict.report.errors() == static_cast<std::size_t>(overload == Overload::kShown ? overloads : 0))
    judge_boards(verdict.configuration.emplace(model), verdict);
  if (outline != nullptr) *outline = outline_of(model);
  verdict.report.sort();
  return verdict;
}

}  // namespace

Verdict verify(const Draft& draft, const Library& library) {
  return judge(draft, library, Report(draft.file), Overload::kRefused);
}

Verdict verify(const ReadDescription& reading, const Library& library, Overload overload) {
  if (!reading.draft) return {std::nullopt, reading.report};
  return judge(*reading.draft, library, reading.report, overload);
}

Outlined verify_with_outline(const ReadDescription& reading, const Library& library, Overload overload) {
  Outlined out{{std::nullopt, reading.report}, std::nullopt};
  if (reading.draft) out.verdict = judge(*reading.draft, library, reading.report, overload, &out.outline);
  return out;
}

}  // namespace chimera
