// SPDX-License-Identifier: Apache-2.0
// Asks for receipts, or reads them from their file, and makes a table of them.
#include "chimera/cli/live/receipts_command.h"

#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/live/filed_lines.h"
#include "chimera/cli/print/answer_text.h"
#include "chimera/cli/print/columns.h"
#include "chimera/cli/print/fields.h"
#include "chimera/cli/print/figures.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

/// How many receipts are asked for.
std::uint64_t last_of(const Call& call) { return call.has("--last") ? std::stoull(call.value("--last")) : 20; }

std::string asked_at(const Json& receipt) {
  const auto at = static_cast<std::time_t>(whole_of(receipt, "wall_ns") / 1'000'000'000);
  std::tm local{};
  char text[32];
  if (::localtime_r(&at, &local) == nullptr || std::strftime(text, sizeof text, "%F %T", &local) == 0) return "?";
  return text;
}

std::string asked_by(const Json& receipt) {
  const Json& by = receipt["asked_by"];
  const std::string role = text_of(by, "role"), reaction = text_of(by, "reaction"), task = text_of(by, "task");
  if (!role.empty()) return role + ":" + text_of(by, "user");
  if (!reaction.empty()) return reaction + " of " + task;
  return task.empty() ? text_of(by, "script") : "task " + task;
}

std::string short_figure(const Json& number) { return formatted("%.4g", number.as_double()); }

/// "wanted 2 of 3 m/s, tau 0.1 N.m": the limit where there is one.
std::string moves(const Json& receipt) {
  std::string text;
  for (const Json& variable : receipt["variables"]) {
    const Json &step = variable["step"], &limit = variable["limit"];
    if (!step.is_number()) continue;
    const std::string move = short_figure(step) + (limit.is_number() ? " of " + short_figure(limit) : "");
    append_joined(text, ", ", text_of(variable, "variable") + " " + with_unit(move, text_of(variable, "unit")) +
                                  (truth_at(variable, "beyond") ? " (beyond)" : ""));
  }
  return text;
}

}  // namespace

std::string receipts_text(const Json& answer) {
  Columns table({">number", "asked", "by", "from", "to", "end", ">change", ">lost", "moves"});
  std::string whys;
  for (const Json& receipt : answer["receipts"]) {
    const std::string number = std::to_string(whole_of(receipt, "number")), end = text_of(receipt, "end");
    const auto at = whole_or_none(receipt, "at_ns");
    std::int64_t lost = 0;
    for (const Json& task : receipt["tasks"]) lost += whole_of(task, "lost");
    const std::string from = text_of(receipt, "from"), to = text_of(receipt, "to");
    table.add({number, asked_at(receipt), asked_by(receipt), from.empty() ? "-" : from, to.empty() ? "-" : to, end,
               at ? duration_text(*at - whole_of(receipt, "asked_ns")) : "-",
               end == "refused" ? "-" : std::to_string(lost), end == "done" ? moves(receipt) : ""});
    const std::string what = text_of(receipt, "way") == "takeover" ? "takeover " : "switch ";
    if (end != "done") whys += what + number + ": " + text_of(receipt, "why") + "\n";
  }
  std::string text = table.empty() ? "no receipts\n" : table.text();
  const std::int64_t unfiled = whole_of(answer, "unfiled");
  if (const std::string fault = text_of(answer, "fault"); !fault.empty())
    whys += std::to_string(unfiled) + (unfiled == 1 ? " is" : " are") + " not filed: " + fault + "\n";
  return text + (whys.empty() ? "" : "\n" + whys);
}

CommandResult receipts(Session& session, const Call& call, const Screen&) {
  const std::string named = call.operand(0);
  if (!named.empty() && named.find('/') == std::string::npos && named != session.subsystem()) {
    const std::string why = "has no receipts here";
    return filed_receipts(call, named, {ErrorCode::kNotFound, std::string_view(why), std::string_view(named)});
  }
  return answered(session.ask("receipts", {{"last", last_of(call)}}), call.json, receipts_text);
}

CommandResult filed_receipts(const Call& call, const std::string& subsystem, const Error& why) {
  const auto filed = filed_lines("receipts", subsystem, last_of(call), why);
  if (!filed) return refused(filed.error(), call.json);
  Json receipts = Json::array();
  for (const std::string& line : filed->lines) receipts.push_back(Json::parse(line));
  const Json answer = {{"receipts", std::move(receipts)}, {"file", filed->path}, {"unfiled", 0}, {"fault", Json()},
                       {"subsystem", filed->subsystem}};
  if (call.json) return {json_line(answer), "", kOk};
  return {receipts_text(answer), filed->source(), kOk};
}

}  // namespace chimera::cli
