// SPDX-License-Identifier: Apache-2.0
// Runs a description once for each combination of values and collects the figures.
#include "chimera/cli/batch/sweep.h"

#include <utility>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/batch/piece_progress.h"
#include "chimera/cli/batch/side_by_side.h"
#include "chimera/cli/batch/sweep_table.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/cli/files/output_file.h"
#include "chimera/cli/run/run_plan.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/verify/verify.h"

namespace chimera::cli {
namespace {

/// True if the operator variable or constant has one element: a list then has several values for it.
bool is_single(const std::string& name, const Configuration& configuration) {
  for (const ConfiguredVariable& variable : configuration.variables())
    if (variable.name == name) return variable.shape.empty();
  for (const ConfiguredTask& task : configuration.tasks())
    for (const ConfiguredPort& port : task.ports)
      if (task.name + "." + port.name == name) return port.shape.empty();
  return false;
}

Result<std::vector<ValueList>> lists_of(const SweepRequest& request, const Configuration& configuration) {
  std::vector<ValueList> lists;
  double runs = 1;
  for (const std::string& text : request.over) {
    auto list = parse_value_list(text, [&](const std::string& name) { return is_single(name, configuration); });
    if (!list) return list.error();
    runs *= static_cast<double>(list->values.size());
    lists.push_back(*std::move(list));
  }
  if (runs <= static_cast<double>(kMostRuns)) return lists;
  return Error{ErrorCode::kRefused,
               {"these lists make " + formatted("%.0f", runs) + " runs, all combinations; at most " +
                std::to_string(kMostRuns) + ": take wider steps, or fewer lists"},
               {}};
}

/// The settings of one run. Its values say which run it is when they are refused.
MeasuredRequest request_of(const SweepRequest& request, const SweepTable& table, std::size_t run) {
  MeasuredRequest made = request.each;
  for (std::size_t l = 0; l < table.lists.size(); ++l) {
    const ValueList& list = table.lists[l];
    const std::string& value = list.values[table.index_of(run, l)];
    made.run.settings.push_back({list.name, value, list.name + " = " + value});
  }
  return made;
}

/// Everything but the values: names and words. A value that is refused is a run that failed.
Result<void> judge(const SweepRequest& request, const SweepTable& table, const Configuration& configuration,
                   const Library& library) {
  std::vector<Setting> settings = request.each.run.settings;
  for (std::size_t l = 0; l < table.lists.size(); ++l)
    settings.push_back({table.lists[l].name, "", "--over '" + request.over[l] + "'"});
  if (auto known = knows(configuration, settings); !known) return known;
  return judge_measured(request.each, library);
}

void run_all(const SweepRequest& request, SweepTable& table, const Library& library, std::FILE* err) {
  PieceProgress progress(table.runs.size(), "runs", err);
  SideBySide plan;
  plan.pieces = table.runs.size();
  plan.jobs = request.jobs == 0 ? processors() : request.jobs;
  plan.limit = request.limit;
  plan.work = [&](std::size_t run) { return encode(measured_run(request_of(request, table, run), library)); };
  plan.on_done = [&](std::size_t done) { progress.show(done); };
  std::vector<PieceEnd> ends = side_by_side(plan);
  progress.wipe();
  for (std::size_t r = 0; r < ends.size(); ++r) {
    if (ends[r].failure.empty())
      table.runs[r] = decode_measured(ends[r].said);
    else
      table.runs[r].failure = ends[r].failure;
  }
}

Result<SweepTable> prepare(const SweepRequest& request, const Configuration& configuration, const Library& library) {
  auto lists = lists_of(request, configuration);
  if (!lists) return lists.error();
  SweepTable table{configuration.subsystem(), *std::move(lists), request.each.expect, {}};
  if (auto judged = judge(request, table, configuration, library); !judged) return judged.error();
  for (const std::string& path : {request.csv, request.svg})
    if (auto may = may_write(path); !may) return may.error();
  std::size_t runs = 1;
  for (const ValueList& list : table.lists) runs *= list.values.size();
  table.runs.resize(runs);
  return table;
}

}  // namespace

int sweep(const SweepRequest& request, const Workplace& workplace, std::FILE* out, std::FILE* err) {
  const auto library = workplace.library(request.each.run.file);
  RunRequest words;
  words.json = request.json;
  if (!library) return refuse_run(words, library.error(), out, err);
  const Verdict verdict = verify(read_description_file(request.each.run.file), *library);
  if (!verdict.configuration) {
    std::fprintf(request.json ? out : err, "%s\n",
                 (request.json ? verdict.report.json() : verdict.report.text()).c_str());
    return kRefused;
  }
  auto table = prepare(request, *verdict.configuration, *library);
  if (!table) return refuse_run(words, table.error(), out, err);
  run_all(request, *table, *library, err);
  if (stop_is_requested()) {
    std::fputs("ended by the operator: no table\n", err);
    return kRefused;
  }
  std::fputs(for_terminal(request.json ? json(*table) : text(*table)).c_str(), out);
  (void)flush_and_look(out);
  for (const auto& [path, made] : {std::pair{request.csv, csv(*table)}, {request.svg, draw::svg(plot(*table))}})
    if (auto written = write_whole(path, made); !written) return refuse_run({}, written.error(), out, err);
  return table->is_good() ? kOk : kRefused;
}

}  // namespace chimera::cli
