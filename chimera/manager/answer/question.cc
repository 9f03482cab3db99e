// SPDX-License-Identifier: Apache-2.0
// Answers a question about a description: if it is legal, and if it meets its deadlines.
#include "chimera/manager/answer/question.h"

#include "chimera/analysis/schedule_report.h"
#include "chimera/text/json.h"
#include "chimera/verify/offers.h"

namespace chimera::manager {
namespace {

/// The JSON on one line, with its keys in the order of all other answers.
std::string one_line(const std::string& json) { return Json::parse(json).dump(); }

}  // namespace

std::string answer_of(const Question& question, const Library& library) {
  const bool is_check = question.kind == Question::Kind::kCheck;
  const ReadDescription reading = read_description(question.text, question.file);
  Outlined outlined = verify_with_outline(reading, library, is_check ? Overload::kRefused : Overload::kTold);
  if (is_check) offer_edits(reading, library, outlined);
  Verdict& verdict = outlined.verdict;
  if (!is_check && verdict.configuration)
    return one_line(schedule_json(*verdict.configuration, schedule_report(*verdict.configuration, {})));
  if (is_check && verdict.configuration) verdict.report.add_all(faulty_objects(*verdict.configuration, library));
  return one_line(verdict.report.json());
}

}  // namespace chimera::manager
