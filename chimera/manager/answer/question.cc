// SPDX-License-Identifier: Apache-2.0
// Answers a question about a description: if it is legal, if it meets its deadlines, what an edit makes of it.
#include "chimera/manager/answer/question.h"

#include <array>
#include <optional>

#include "chimera/analysis/mode_report.h"
#include "chimera/analysis/schedule_report.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/description/edit/same_value.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/description/edit_json.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/draw/graph_of.h"
#include "chimera/draw/picture.h"
#include "chimera/text/json.h"
#include "chimera/verify/offers.h"

namespace chimera::manager {
namespace {

/// The JSON on one line, with its keys in the order of all other answers.
std::string one_line(const std::string& json) { return Json::parse(json).dump(); }

std::string report_or_schedule(const Question& question, const Library& library) {
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

Result<std::string> text_after_acts(const Question& question, const Library& library) {
  const auto json = Json::parse_or_none(question.with.empty() ? "[]" : question.with);
  auto acts = edit_acts(json.value_or(Json()));
  if (!acts) return acts.error();
  Result<std::string> text = question.text;
  for (EditAct& act : *acts) {
    const auto lacks_ports = [](const auto& each) {
      if constexpr (requires { each.lacks_ports; }) return each.lacks_ports;
      return false;
    };
    if (std::visit(lacks_ports, act))
      if (const auto now = verify_with_outline(read_description(*text, question.file), library); now.outline)
        name_ports(act, *now.outline);
    text = edit_text(*text, std::array{act});
    if (!text) break;
  }
  return text;
}

Result<AnalystAnswer> draft_answer(const Question& question, const Library& library) {
  auto text = text_after_acts(question, library);
  if (!text) return text.error();
  auto [verdict, outline] = verify_with_outline(read_description(*text, question.file), library, Overload::kShown);
  std::string drawn = "null", picture = "null", schedule = "null";
  if (outline) {
    drawn = outline_json(*outline).dump(Json::Style::kAsMade);
    picture = draw::picture_json(draw::graph_of(*outline)).dump(Json::Style::kAsMade);
  }
  if (verdict.configuration) {
    schedule = schedule_json(*verdict.configuration, schedule_report(*verdict.configuration, {}));
    if (verdict.report.is_legal()) verdict.report.add_all(faulty_objects(*verdict.configuration, library));
  }
  std::string json = "{\"version\":" + std::to_string(question.version) + ",\"text\":" + Json(*text).dump() +
                     ",\"report\":" + verdict.report.json() + ",\"outline\":" + drawn + ",\"picture\":" + picture +
                     ",\"schedule\":" + schedule + "}";
  return AnalystAnswer{std::move(json), *std::move(text)};
}

std::string offers_json(const Question& question, const Library& library) {
  const ReadDescription reading = read_description(question.text, question.file);
  Outlined outlined = verify_with_outline(reading, library);
  offer_edits(reading, library, outlined);
  Json offers = Json::array();
  const auto faults = outlined.verdict.report.faults();
  for (std::size_t f = 0; f < faults.size(); ++f)
    for (const Offer& offer : faults[f].offers)
      offers.push_back({{"fault", f}, {"label", offer.label}, {"acts", edits_json(offer.acts)}});
  return Json{{"version", question.version}, {"offers", std::move(offers)}}.dump(Json::Style::kAsMade);
}

std::string modes_json(const Question& question, const Library& library) {
  const Verdict verdict = verify(read_description(question.text, question.file), library);
  const std::string modes =
      verdict.configuration ? mode_json(*verdict.configuration, mode_report(*verdict.configuration, library)) : "null";
  return "{\"version\":" + std::to_string(question.version) + ",\"modes\":" + modes + "}";
}

Result<Node> tree_of(const std::string& text, const char* which) {
  Report faults;
  auto tree = read_yaml(text, faults);
  if (tree && (tree->is_map() || tree->is_none())) return *std::move(tree);
  const Fault fault = tree ? Fault{.rule = {}, .at = tree->at, .message = "it has no keys"} : faults.faults()[0];
  const std::string where = std::to_string(fault.at.line) + ":" + std::to_string(fault.at.column);
  return Error{ErrorCode::kRefused, {std::string(which) + " cannot be read: " + sentence(fault)}, {where}};
}

/// Adds the paths of keys, at most `depth` deep, whose values differ in two maps.
void add_differences(const Node& a, const Node& b, const std::string& above, int depth, const UnitSystem& units,
                     std::vector<std::string>& paths) {
  std::vector<std::string> keys = names_of(a.keys, &Word::text);
  for (const Word& key : b.keys)
    if (a.find(key.text) == nullptr) keys.push_back(key.text);
  for (const std::string& key : keys) {
    const Node *x = a.find(key), *y = b.find(key);
    if (x != nullptr && y != nullptr && (says_same(*x, *y, units) || says_same(*y, *x, units))) continue;
    const bool have_keys = (x == nullptr || x->is_map()) && (y == nullptr || y->is_map());
    if (depth > 1 && have_keys)
      add_differences(x == nullptr ? Node() : *x, y == nullptr ? Node() : *y, above + key + "/", depth - 1, units,
                      paths);
    else
      paths.push_back(above + key);
  }
}

Result<AnalystAnswer> differences(const Question& question, const Library& library) {
  const auto text = tree_of(question.text, "the text");
  if (!text) return text.error();
  const auto with = tree_of(question.with, "the other text");
  if (!with) return with.error();
  std::vector<std::string> paths;
  add_differences(*text, *with, "", 2, library.units(), paths);
  return AnalystAnswer{Json{{"version", question.version}, {"paths", paths}}.dump(Json::Style::kAsMade), {}};
}

}  // namespace

Result<AnalystAnswer> answer_of(const Question& question, const Library& library) {
  switch (question.kind) {
    case Question::Kind::kDraft: return draft_answer(question, library);
    case Question::Kind::kOffers: return AnalystAnswer{offers_json(question, library), {}};
    case Question::Kind::kModes: return AnalystAnswer{modes_json(question, library), {}};
    case Question::Kind::kDifferences: return differences(question, library);
    default: return AnalystAnswer{report_or_schedule(question, library), {}};
  }
}

}  // namespace chimera::manager
