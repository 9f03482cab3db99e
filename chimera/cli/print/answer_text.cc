// SPDX-License-Identifier: Apache-2.0
// Writes answers of the manager as sentences and tables.
#include "chimera/cli/print/answer_text.h"

#include <algorithm>
#include <vector>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/print/columns.h"
#include "chimera/cli/print/fields.h"
#include "chimera/cli/print/figures.h"
#include "chimera/cli/print/status_text.h"
#include "chimera/text/json.h"
#include "chimera/text/nearest.h"
#include "chimera/text/time_text.h"

namespace chimera::cli {
namespace {

std::string origin_text(const Json& reading) {
  const std::string producer = text_of(reading, "producer"), state = text_of(reading, "state");
  std::string text = producer.empty() ? "no producer" : producer;
  if (!state.empty() && state != "ON") text += " is " + state;
  if (whole_of(reading, "sequence") > 0)
    if (const auto age = whole_or_none(reading, "age_ns")) text += ", " + duration_text(*age) + " ago";
  return text;
}

std::string producer_of(const Json& link) {
  const std::string producer = text_of(link, "producer"), component = text_of(link, "component");
  if (producer.empty()) return "no task";
  return component.empty() || component == producer ? producer : producer + " (" + component + ")";
}

std::string figure(const Json& number) { return formatted("%.6g", number.as_double()); }

bool is_well(const Json& link) { return text_of(link, "verdict") == "ok"; }

std::string age_of(const Json& link) {
  return truth_at(link, "valid") && whole_of(link, "published_ns") > 0 ? duration_text(whole_or_none(link, "age_ns"))
                                                                       : "-";
}

/// The head of `why`: the value, its producer, its age and its inputs.
std::string why_head(const Json& link) {
  std::string text = text_of(link, "variable") + " = " + text_of(link, "value") + "\n";
  text += "  produced by  " + producer_of(link);
  if (const std::string rtpu = text_of(link, "rtpu"); !rtpu.empty()) text += " on " + rtpu;
  if (text_of(link, "producer") != "operator") text += ", " + text_of(link, "state");
  text += "\n  published    " + (age_of(link) == "-" ? "never" : age_of(link) + " ago");
  if (const std::int64_t period = whole_of(link, "period_ns"); period > 0) text += ", every " + duration_text(period);
  const std::string inputs = join(texts_of(link, "inputs"), ", ");
  if (const std::string timing = text_of(link, "timing"); !timing.empty()) text += "\n  in time      " + timing;
  return text + "\n  from         " + (inputs.empty() ? "no inputs" : inputs) + "\n";
}

/// "'hand'"; of tasks that are no configuration "other tasks".
std::string target_of(const Json& answer) {
  const std::string to = text_of(answer, "to");
  return to.empty() ? "other tasks" : "'" + to + "'";
}

std::string in_force_text(const Json& answer) {
  const bool is_named = !text_of(answer, "to").empty();
  return (is_named ? target_of(answer) + " is" : "these tasks are") + " in force, nothing to do\n";
}

}  // namespace

std::string json_line(const Json& answer) { return answer.dump() + "\n"; }

std::string readings_text(const Json& answer) {
  std::string text;
  const Json& values = answer["values"];
  for (const auto& [name, reading] : values.items())
    text += plain_line(name) + " = " + text_of(reading, "text") + "  (" + origin_text(reading) + ")\n";
  return text;
}

std::string signal_text(const Json& answer) {
  std::string text;
  for (const Json& task : answer["tasks"]) {
    const std::string before = text_of(task, "before"), after = text_of(task, "after");
    text += text_of(task, "task") + ": " + (before == after ? after : before + " -> " + after) +
            (truth_at(task, "already") ? " already\n" : "\n");
  }
  return text;
}

std::string save_text(const Json& answer) {
  const Json& values = answer["operator"];
  if (!values.is_object() || values.empty()) return "no operator variables\n";
  std::string text = "operator:\n";
  for (const auto& [name, value] : values.items())
    text += "  " + plain_line(name) + ": " + text_of(values, name) + "\n";
  return text;
}

std::string ring_text(const Json& answer) {
  std::string text;
  for (const std::string& task : texts_of(answer, "tasks")) text += task + ": rung\n";
  return text;
}

std::string switch_text(const Json& answer) {
  const std::string to = target_of(answer);
  const std::string end = text_of(answer, "end"), from = text_of(answer, "from");
  if (end == "nothing-to-do") return in_force_text(answer);
  std::string text = "switch " + std::to_string(whole_of(answer, "number")) +
                     (from.empty() ? "" : " from '" + from + "'") + " to " + to + " " + end;
  if (end != "done") return text + ": " + text_of(answer, "why") + "\n";
  std::int64_t arrive = 0, leave = 0, lost = 0;
  for (const Json& task : answer["tasks"]) {
    arrive += text_of(task, "move") == "arrives" ? 1 : 0;
    leave += text_of(task, "move") == "leaves" ? 1 : 0;
    lost += whole_of(task, "lost");
  }
  text += ": " + counted(arrive, "task arrives", "tasks arrive") + ", " + counted(leave, "leaves", "leave") + ", " +
          counted(lost, "cycle lost", "cycles lost") + "\n";
  for (const Json& variable : answer["variables"]) {
    const Json& step = variable["step"];
    if (!step.is_number()) continue;
    const Json& limit = variable["limit"];
    const std::string unit = text_of(variable, "unit") == "1" ? "" : " " + text_of(variable, "unit");
    text += "  " + text_of(variable, "variable") + " moves by " + figure(step) + unit +
            (limit.is_number() ? ", limit " + figure(limit) + unit : "") +
            (truth_at(variable, "beyond") ? ": beyond it\n" : "\n");
  }
  return text;
}

std::string drill_text(const Json& answer) {
  const Json& tasks = answer["tasks"];
  std::string text = tasks.empty() ? "no task that is ON has hardware that could move\n" : "";
  for (const Json& task : tasks) {
    const std::string verdict = text_of(task, "verdict");
    text += text_of(task, "task") + ": ";
    if (verdict == "safe") text += "safe " + time_text(Nanoseconds{whole_of(task, "after_ns")}) + " after the flag\n";
    else if (verdict == "cannot-tell") text += "cannot tell: its component has no safe_state output\n";
    else if (verdict == "left") text += "left service before it was safe\n";
    else text += "not safe\n";
  }
  const Json& killed = answer["killed"];
  if (killed.is_object()) {
    const std::int64_t written = whole_of(killed, "written"), lost = whole_of(killed, "lost");
    text += text_of(killed, "rtpu") + ": killed, ";
    if (!truth_at(killed, "is_told"))
      text += "and the guard has not told what it wrote\n";
    else if (written + lost == 0) text += "and it had no safe frame\n";
    else text += std::to_string(written) + " of " + std::to_string(written + lost) + " safe frames written";
    if (written > 0) text += " " + time_text(Nanoseconds{whole_of(killed, "after_ns")}) + " after the kill";
    if (written + lost > 0) text += "\n";
  }
  return text + "flag up for " + time_text(Nanoseconds{whole_of(answer, "flag_ns")}) + "\n";
}

std::string plan_text(const Json& answer) {
  const std::string to = target_of(answer);
  const std::string end = text_of(answer, "end"), from = text_of(answer, "from");
  if (end == "nothing-to-do") return in_force_text(answer);
  const std::string begin = "switch" + (from.empty() ? "" : " from '" + from + "'") + " to " + to;
  if (end == "refused") {
    const std::string remedy = text_of(answer, "remedy");
    return begin + " would be refused: " + text_of(answer, "why") + (remedy.empty() ? "" : "; " + remedy) + "\n";
  }
  const bool is_slow = text_of(answer, "way") == "slow";
  const std::string expected = duration_text(whole_of(answer, "expected_ns"));
  std::string text = begin + " would begin, " +
                     (is_slow ? "the slow way, for " + text_of(answer, "slow_why") : std::string("the fast way")) +
                     "; it is expected to take " + expected + "\n";
  for (const char* move : {"arrives", "leaves", "stays"}) {
    const std::string names = join(texts_of(answer, move), ", ");
    if (!names.empty()) text += "  " + std::string(move) + ": " + names + "\n";
  }
  for (const Json& variable : answer["variables"]) {
    const std::string producer = text_of(variable, "from");
    text += "  " + text_of(variable, "variable") + ": from " + (producer.empty() ? "no task" : producer) + " to " +
            text_of(variable, "to") + "\n";
  }
  if (const Json& off = answer["late_off"]; off.is_object())
    text += "  off of " + text_of(off, "task") + " is taken to need " +
            duration_text(whole_of(off, "needs_ns")) +
            "; no gap is as long, so it runs 100 ms after the change and may delay cycles\n";
  return text;
}

std::string flag_text(const Json& answer) { return flag_words(answer) + "\n"; }

std::string why_text(const Json& answer, std::size_t height) {
  const Json& chain = answer["chain"];
  if (!chain.is_array() || chain.empty()) return text_of(answer, "verdict") + "\n";
  std::vector<const Json*> links;
  for (std::size_t i = 1; i < chain.size(); ++i) links.push_back(&chain[i]);
  std::stable_partition(links.begin(), links.end(), [](const Json* link) { return !is_well(*link); });
  // 4 or 5 lines of head, an empty one, the heading of the table, an empty one, the verdict.
  const std::size_t taken = text_of(chain[0], "timing").empty() ? 9 : 10;
  const std::size_t room = height > taken + 1 ? height - taken : 1;
  Columns table({"ancestor", "verdict", "producer", "state", ">age", ">period", ">late", "value"});
  for (std::size_t i = 0; i < std::min(room, links.size()); ++i) {
    const Json& link = *links[i];
    const std::int64_t period = whole_of(link, "period_ns");
    table.add({std::string(static_cast<std::size_t>(std::clamp<std::int64_t>(whole_of(link, "depth"), 1, 9) - 1), ' ') +
                   text_of(link, "variable"),
               text_of(link, "verdict"), producer_of(link), text_of(link, "state"), age_of(link),
               period > 0 ? duration_text(period) : "-", text_of(link, "late").empty() ? "0" : "1",
               fitted(text_of(link, "value"), 24)});
  }
  std::string text = why_head(chain[0]);
  if (!table.empty()) text += "\n" + table.text();
  if (links.size() > room) text += "... and " + std::to_string(links.size() - room) + " more\n";
  return text + "\n" + text_of(answer, "verdict") + "\n";
}

std::string refusal_text(const std::string& message, const Json& data) {
  const std::string where = text_of(data, "where"), nearest = text_of(data, "nearest");
  const std::string remedy = text_of(data, "remedy");
  std::string text = plain_line(message);
  const auto says = [&](const std::string& words) { return text.find(words) != std::string::npos; };
  if (!where.empty() && !says(where)) text = where + ": " + text;
  if (!remedy.empty() && !says(remedy)) text += "; " + remedy;
  if (!says(in_quotes(nearest))) text += did_you_mean(nearest);
  return text;
}

}  // namespace chimera::cli
