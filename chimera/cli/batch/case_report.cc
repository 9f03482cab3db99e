// SPDX-License-Identifier: Apache-2.0
// Writes the outcome of cases as text, JSON and JUnit XML.
#include "chimera/cli/batch/case_report.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/run/run_verdict.h"
#include "chimera/draw/svg_text.h"
#include "chimera/text/json_text.h"

namespace chimera::cli {
namespace {

using draw::escaped;

std::string said_by(const RunReport::Judged& judged) { return judged.text + " (" + judged.said + ")"; }


Json json_of(const CaseOutcome& one) {
  Json expectations = Json::array();
  for (const RunReport::Judged& judged : one.run.expectations)
    expectations.push_back({{"text", judged.text}, {"holds", judged.holds}, {"said", judged.said}});
  return {{"name", one.name},
          {"passes", one.complaints().empty()},
          {"failure", one.run.failure.empty() ? Json() : Json(one.run.failure)},
          {"ran_ns", one.run.ran.count},
          {"strict", one.strict},
          {"expectations", std::move(expectations)},
          {"remarks", one.run.remarks}};
}

/// "examples.02_cruise_control.cruise_control": build machines cut it at the dots.
std::string class_of(const std::string& file) {
  std::string name = file.substr(0, file.size() - kCaseFileEnding.size());
  while (name.starts_with("./") || name.starts_with("/")) name.erase(0, name.find('/') + 1);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

std::string junit_of(const CaseOutcome& one, const std::string& file) {
  const std::vector<std::string> complaints = one.complaints();
  std::string said;
  for (const RunReport::Judged& judged : one.run.expectations)
    said += std::string(judged.holds ? "holds: " : "FAILS: ") + said_by(judged) + "\n";
  for (const std::string& remark : one.run.remarks) said += remark + "\n";
  std::string lines;
  for (const std::string& complaint : complaints) lines += escaped(complaint) + "\n";
  std::string text = "    <testcase classname=\"" + escaped(class_of(file)) + "\" name=\"" + escaped(one.name) +
                     "\" file=\"" + escaped(file) + "\" time=\"" + seconds_text(one.wall) + "\">\n";
  const std::string kind = one.run.failure.empty() ? "failure" : "error";
  if (!complaints.empty())
    text += "      <" + kind + " type=\"" + kind + "\" message=\"" + escaped(complaints[0]) + "\">" + lines + "</" +
            kind + ">\n";
  std::string out;
  for (std::size_t at = 0; at < said.size();) {  // escaped() makes a blank of a line end
    const std::size_t end = said.find('\n', at);
    out += escaped(said.substr(at, end - at)) + "\n";
    at = end + 1;
  }
  if (!out.empty()) text += "      <system-out>" + out + "</system-out>\n";
  return text + "    </testcase>\n";
}

/// The counts and the time of one suite, or of all, as attributes.
std::string sums(const std::vector<const CaseOutcome*>& cases) {
  std::size_t failures = 0, errors = 0;
  Nanoseconds time;
  for (const CaseOutcome* one : cases) {
    time = time + one->wall;
    if (!one->run.failure.empty())
      ++errors;
    else if (!one->complaints().empty())
      ++failures;
  }
  return "tests=\"" + std::to_string(cases.size()) + "\" failures=\"" + std::to_string(failures) + "\" errors=\"" +
         std::to_string(errors) + "\" skipped=\"0\" time=\"" + seconds_text(time) + "\"";
}

std::vector<const CaseOutcome*> cases_of(const CaseFileOutcome& file) {
  std::vector<const CaseOutcome*> all;
  for (const CaseOutcome& one : file.cases) all.push_back(&one);
  return all;
}

}  // namespace

std::vector<std::string> CaseOutcome::complaints() const {
  if (!run.failure.empty()) return {run.failure};
  std::vector<std::string> all;
  for (const RunReport::Judged& judged : run.expectations)
    if (!judged.holds) all.push_back(said_by(judged));
  if (strict)
    for (const std::string& remark : run.remarks) all.push_back("strict: " + remark);
  return all;
}

std::size_t CaseReport::passed() const {
  std::size_t n = 0;
  for (const CaseFileOutcome& file : files)
    for (const CaseOutcome& one : file.cases) n += one.complaints().empty() ? 1 : 0;
  return n;
}

std::size_t CaseReport::failed() const {
  std::size_t n = 0;
  for (const CaseFileOutcome& file : files) n += file.cases.size();
  return n - passed();
}

std::string text(const CaseReport& report) {
  std::string all;
  for (const CaseFileOutcome& file : report.files) {
    all += file.file + "\n";
    for (const CaseOutcome& one : file.cases) {
      const std::vector<std::string> complaints = one.complaints();
      all += (complaints.empty() ? "  ok     " : "  FAILS  ") + one.name + "\n";
      for (const std::string& complaint : complaints) all += "           " + complaint + "\n";
    }
  }
  return all + counted(report.passed() + report.failed(), "case") + " in " + counted(report.files.size(), "file") +
         ": " + std::to_string(report.passed()) + " passed, " + std::to_string(report.failed()) + " failed\n";
}

std::string json(const CaseReport& report) {
  const std::string files = join(report.files, ",\n", [](const CaseFileOutcome& file) {
    Json cases = Json::array();
    for (const CaseOutcome& one : file.cases) cases.push_back(json_of(one));
    return spaced_json({{"file", file.file}, {"description", file.description}, {"cases", std::move(cases)}});
  });
  return "{\"passed\": " + std::to_string(report.passed()) + ", \"failed\": " + std::to_string(report.failed()) +
         ", \"files\": [\n" + files + "]}\n";
}

std::string junit(const CaseReport& report) {
  std::vector<const CaseOutcome*> all;
  std::string suites;
  for (const CaseFileOutcome& file : report.files) {
    const auto cases = cases_of(file);
    all.insert(all.end(), cases.begin(), cases.end());
    suites += "  <testsuite name=\"" + escaped(class_of(file.file)) + "\" " + sums(cases) + ">\n";
    for (const CaseOutcome* one : cases) suites += junit_of(*one, file.file);
    suites += "  </testsuite>\n";
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"chimera\" " + sums(all) + ">\n" + suites +
         "</testsuites>\n";
}

}  // namespace chimera::cli
