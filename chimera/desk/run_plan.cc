// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/run_plan.h"

#include "chimera/config/verify.h"
#include "chimera/desk/check.h"
#include "chimera/desk/run.h"
#include "chimera/desk/script_text.h"

namespace chimera::desk {
namespace {

Executor executor_of(const RunRequest& request) {
  if (request.virtual_time) return Executor::kVirtual;
  return request.one_process ? Executor::kOneProcess : Executor::kProcesses;
}

Result<void> judge_words(const RunRequest& request, RunPlan& plan) {
  for (const std::string& name : request.watch)
    if (auto found = find_variable(plan.configuration, name); !found) return found.error();
  for (const std::string& text : request.expect) {
    auto expectation = Expectation::parse(text, plan.configuration, plan.library.units());
    if (!expectation) return expectation.error();
    plan.expectations.push_back(*std::move(expectation));
  }
  auto acts = parse_script(request.at, plan.configuration.spec());
  if (!acts) return acts.error();
  plan.acts = *std::move(acts);
  return {};
}

}  // namespace

int refuse_run(const RunRequest& request, const Error& error, std::FILE* out, std::FILE* err) {
  const Output output = refused(error, request.json);
  std::fputs(output.out.c_str(), out);
  std::fputs(output.err.c_str(), err);
  return output.code;
}

std::optional<RunPlan> plan_run(const RunRequest& request, const Workplace& workplace, std::FILE* out,
                                std::FILE* err) {
  auto library = workplace.library();
  if (!library) {
    refuse_run(request, library.error(), out, err);
    return std::nullopt;
  }
  Reading reading = read_description_file(request.file);
  Verdict verdict = verify(reading, *library);
  if (verdict.configuration) verdict.report.add_all(unsupported(*verdict.configuration, executor_of(request)));
  if (!request.json) std::fputs(verdict.report.text().c_str(), err);
  if (!verdict.report.is_legal()) {
    if (request.json) std::fprintf(out, "%s\n", verdict.report.json().c_str());
    return std::nullopt;
  }
  if (!request.json) std::fputs(verdict_text(*verdict.configuration).c_str(), out);
  RunPlan plan{*std::move(library), std::move(reading.text), *std::move(verdict.configuration), {}, {}};
  if (auto judged = judge_words(request, plan); !judged) {
    refuse_run(request, judged.error(), out, err);
    return std::nullopt;
  }
  return plan;
}

}  // namespace chimera::desk
