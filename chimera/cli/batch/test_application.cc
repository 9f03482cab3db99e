// SPDX-License-Identifier: Apache-2.0
// Finds the files of cases in folders, runs their cases side by side, and reports.
#include "chimera/cli/batch/test_application.h"

#include <algorithm>
#include <filesystem>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/cli/batch/case_report.h"
#include "chimera/cli/batch/piece_progress.h"
#include "chimera/cli/batch/side_by_side.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/cli/files/output_file.h"
#include "chimera/cli/run/run_plan.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/text/nearest.h"

namespace chimera::cli {
namespace {

namespace fs = std::filesystem;

Error refusal(const std::string& why, const std::string& where = {}) { return {ErrorCode::kRefused, {why}, {where}}; }

bool is_case_file(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.size() > kCaseFileEnding.size() && name.ends_with(kCaseFileEnding);
}

/// Not looked into: what is hidden, and what a build made.
bool is_passed_over(const fs::path& folder) {
  std::error_code unknown;
  return folder.filename().string().starts_with('.') || fs::exists(folder / "CMakeCache.txt", unknown);
}

Result<std::vector<std::string>> files_in(const std::string& place) {
  if (is_case_file(place)) return std::vector<std::string>{place};
  std::vector<std::string> files;
  std::error_code failed;
  fs::recursive_directory_iterator at(place, fs::directory_options::skip_permission_denied, failed), end;
  for (; !failed && at != end; at.increment(failed)) {
    std::error_code unknown;  // of a link that leads to itself
    if (at->is_directory(unknown) && is_passed_over(at->path()))
      at.disable_recursion_pending();
    else if (at->is_regular_file(unknown) && is_case_file(at->path()))
      files.push_back(at->path().string());
  }
  if (failed) return refusal(failed.message(), place);
  if (files.empty())
    return refusal(
        "there are no tests: no file NAME.cases.yaml here or below; docs/formats/cases.md says what one says", place);
  std::sort(files.begin(), files.end());
  return files;
}

/// All files of all places, each once; what is wrong in them goes to `faults`.
Result<std::vector<CaseFile>> read_all(const CasesRequest& request, std::string& faults) {
  std::vector<std::string> paths;
  for (const std::string& place : request.places) {
    auto found = files_in(place);
    if (!found) return found.error();
    for (std::string& path : *found)
      if (std::find(paths.begin(), paths.end(), path) == paths.end()) paths.push_back(std::move(path));
  }
  std::vector<CaseFile> files;
  for (const std::string& path : paths) {
    Report report(path);
    files.push_back(read_case_file(path, report));
    if (!report.is_legal()) faults += report.text();
  }
  return files;
}

/// Keeps the cases of these names.
Result<void> choose(const std::vector<std::string>& only, std::vector<CaseFile>& files) {
  std::vector<std::string> names;
  for (const CaseFile& file : files)
    for (const Case& one : file.cases) names.push_back(one.name);
  for (const std::string& name : only) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    return refusal("--case: " + no_such("case", name, names));
  }
  if (only.empty()) return {};
  for (CaseFile& file : files)
    std::erase_if(file.cases,
                  [&](const Case& one) { return std::find(only.begin(), only.end(), one.name) == only.end(); });
  std::erase_if(files, [](const CaseFile& file) { return file.cases.empty(); });
  return {};
}

CaseReport run_all(const CasesRequest& request, std::vector<CaseFile>& files, const Library& library, std::FILE* err) {
  std::vector<std::pair<CaseFile*, Case*>> cases;
  for (CaseFile& file : files)
    for (Case& one : file.cases) {
      one.request.folder = fs::path(absolute_path(file.description)).parent_path().string();
      cases.emplace_back(&file, &one);
    }
  PieceProgress progress(cases.size(), "cases", err);
  SideBySide plan;
  plan.pieces = cases.size();
  plan.jobs = request.jobs == 0 ? processors() : request.jobs;
  plan.limit = request.limit;
  plan.work = [&](std::size_t i) { return encode(measured_run(cases[i].second->request, library)); };
  plan.on_done = [&](std::size_t done) { progress.show(done); };
  const std::vector<PieceEnd> ends = side_by_side(plan);
  progress.wipe();
  CaseReport report;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (i == 0 || cases[i].first != cases[i - 1].first)
      report.files.push_back({cases[i].first->file, cases[i].first->description, {}});
    MeasuredRun run;
    if (ends[i].failure.empty())
      run = decode_measured(ends[i].said);
    else
      run.failure = ends[i].failure;
    report.files.back().cases.push_back({cases[i].second->name, std::move(run), cases[i].second->strict, ends[i].wall});
  }
  return report;
}

/// Cases run in folders of their own.
Workplace anywhere(Workplace workplace) {
  for (auto* list : {&workplace.component_folders, &workplace.unit_files})
    for (std::string& path : *list) path = absolute_path(path);
  return workplace;
}

}  // namespace

bool is_place_of_cases(const std::string& word, const Library& library) {
  if (is_case_file(word)) return true;
  std::error_code failed;
  if (!fs::is_directory(word, failed)) return false;
  return word.find('/') != std::string::npos || word == "." || word == ".." || library.find(word) == nullptr;
}

int test_application(const CasesRequest& request, const Workplace& workplace, std::FILE* out, std::FILE* err) {
  RunRequest words;
  words.json = request.json;
  std::string faults;
  auto files = read_all(request, faults);
  if (!files) return refuse_run(words, files.error(), out, err);
  const auto library = anywhere(workplace).library(files->empty() ? "" : files->front().description);
  if (!library) return refuse_run(words, library.error(), out, err);
  if (!faults.empty() && request.json) return refuse_run(words, refusal(faults.substr(0, faults.find('\n'))), out, err);
  if (!faults.empty()) {
    std::fputs(for_terminal(faults).c_str(), err);
    return kRefused;
  }
  if (auto chosen = choose(request.only, *files); !chosen) return refuse_run(words, chosen.error(), out, err);
  if (auto may = may_write(request.junit); !may) return refuse_run(words, may.error(), out, err);
  const CaseReport report = run_all(request, *files, *library, err);
  if (stop_is_requested()) {
    std::fputs("ended by the operator\n", err);
    return kRefused;
  }
  std::fputs(for_terminal(request.json ? json(report) : text(report)).c_str(), out);
  (void)flush_and_look(out);
  if (auto written = write_whole(request.junit, junit(report)); !written)
    return refuse_run({}, written.error(), out, err);
  return report.failed() == 0 ? kOk : kRefused;
}

}  // namespace chimera::cli
