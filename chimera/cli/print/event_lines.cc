// SPDX-License-Identifier: Apache-2.0
// Writes events as lines, and joins deadlines that were missed one after the other.
#include "chimera/cli/print/event_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <optional>
#include <utility>

#include "chimera/base/hosted/wording.h"
#include "chimera/base/time.h"
#include "chimera/cli/print/columns.h"
#include "chimera/cli/print/fields.h"
#include "chimera/cli/print/figures.h"
#include "chimera/text/json.h"
#include "chimera/text/nearest.h"
#include "chimera/units/quantity.h"

namespace chimera::cli {
namespace {

constexpr std::array<std::string_view, 33> kKinds = {
    "started",         "state", "fault", "refused", "signal",  "flag", "rtpu-ended", "rtpu-restarted", "rtpu-given-up",
    "manager-started", "miss",  "blame", "hang",    "demoted", "note", "overrun",    "stale",          "lost",
    "command",         "set",   "stop",  "ending",  "closed", "not-off",
    "memory",          "rights", "face-died", "output-lost", "switch", "bump", "drill", "safe",
    "takeover"};

/// Kinds of events that one incident causes: the late task, the cause, the cycles over budget.
constexpr std::array<std::string_view, 3> kOfAMiss = {"miss", "blame", "overrun"};
constexpr std::int64_t kPause = milliseconds(100).count;  // that does not end an incident

bool is_of_a_miss(std::string_view kind) { return std::ranges::find(kOfAMiss, kind) != kOfAMiss.end(); }

constexpr std::int64_t kSecond = 1'000'000'000;

std::string clock_text(std::int64_t wall_ns, bool is_dated) {
  const std::time_t seconds = wall_ns / kSecond;
  std::tm parts{};
  localtime_r(&seconds, &parts);
  char text[48];
  const std::size_t end = std::strftime(text, sizeof text, is_dated ? "%F %T" : "%T", &parts);
  std::snprintf(text + end, sizeof text - end, ".%03d", static_cast<int>(wall_ns / 1'000'000 % 1000));
  return text;
}

/// The instant of "2026-11-28 14:05:30", without seconds, or without a time of day; or the last "14:05" before `now`.
std::optional<std::int64_t> instant_of(std::string text, std::time_t now) {
  std::ranges::replace(text, 'T', ' ');
  for (const char* const form : {"%Y-%m-%d %H:%M:%S", "%Y-%m-%d %H:%M", "%Y-%m-%d", "%H:%M:%S", "%H:%M"}) {
    const bool has_day = form[1] == 'Y';
    std::tm parts{};
    if (!has_day) localtime_r(&now, &parts), parts.tm_sec = 0;
    const char* const end = ::strptime(text.c_str(), form, &parts);
    if (end == nullptr || *end != '\0') continue;
    parts.tm_isdst = -1;
    std::tm typed = parts;
    std::time_t at = std::mktime(&parts);
    if (parts.tm_mday != typed.tm_mday) return std::nullopt;  // such as 30 February
    if (!has_day && at > now) --typed.tm_mday, at = std::mktime(&typed);
    return std::clamp<std::int64_t>(at, -9 * kSecond, 9 * kSecond) * kSecond;
  }
  return std::nullopt;
}

}  // namespace

Result<Since> read_since(const std::string& text, std::int64_t now_ns) {
  Since since;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), since.number);
  const bool is_number = error == std::errc() && end == text.data() + text.size() && since.number >= 0;
  if (is_number) return since;
  since.number = 0;
  if (const auto ago = parse_duration(text)) since.wall_ns = now_ns - ago->count;
  else if (const auto at = instant_of(text, now_ns / kSecond)) since.wall_ns = *at;
  if (since.is_time()) return since;
  return Error{ErrorCode::kBadInput,
               {"--since: found '" + text + "', expected the number of an event, a time ago such as '10 min', or a " +
                "time such as '14:05' or '2026-11-28 14:05'"},
               {}};
}

std::string EventLines::line(const Event& first, const std::string& kind, const std::string& text) const {
  char head[32];
  std::snprintf(head, sizeof head, "%6lld", static_cast<long long>(first.number));
  return std::string(head) + "  " + clock_text(first.wall_ns, is_dated_) + "  " + fitted(kind, 15) + "  " + text + "\n";
}

EventLines::Event EventLines::read(const Json& event) {
  const std::string task = text_of(event, "task");
  return {whole_of(event, "number"),
          whole_of(event, "at_ns"),
          whole_of(event, "wall_ns"),
          text_of(event, "kind"),
          task.empty() ? text_of(event, "rtpu") : task,
          text_of(event, "text") + (text_of(event, "by").empty() ? "" : ", by " + text_of(event, "by"))};
}

std::string EventLines::line_of(const Event& event) const {
  return line(event, event.kind, (event.who.empty() ? "" : event.who + ": ") + event.text);
}

// "miss x4": the tasks, the first cause, and how far it goes.
std::string EventLines::line_of(const std::vector<Event>& incident) const {
  std::vector<std::string> tasks;
  for (const Event& event : incident)
    if (!event.who.empty() && std::ranges::find(tasks, event.who) == tasks.end()) tasks.push_back(event.who);
  const auto cause = std::ranges::find(incident, "blame", &Event::kind);
  const Event &first = incident.front(), &last = incident.back();
  const std::string text = join(tasks, ", ") + ": " + (cause == incident.end() ? first : *cause).text + "; " +
                           std::to_string(incident.size()) + " events to number " + std::to_string(last.number) +
                           ", within " + duration_text(last.at_ns - first.at_ns);
  return line(first, "miss x" + std::to_string(incident.size()), text);
}

std::span<const std::string_view> event_kinds() noexcept { return kKinds; }

Result<std::vector<std::string>> read_kinds(std::string_view text) {
  const std::vector<std::string> known(event_kinds().begin(), event_kinds().end());
  std::vector<std::string> kinds;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    kinds.emplace_back(text.substr(at, end - at));
    at = end + 1;
    if (std::ranges::find(known, kinds.back()) != known.end()) continue;
    const bool has_near = !nearest(kinds.back(), known).empty();
    const std::string there_are = has_near ? "" : "; there are " + join(known, ", ");
    return Error{ErrorCode::kBadInput, {"--kind: " + no_such("kind", kinds.back(), known) + there_are}, {}};
  }
  return kinds;
}

bool EventLines::is_wanted(const Json& event) const {
  if (whole_of(event, "wall_ns") < from_ns_) return false;
  return kinds_.empty() || std::ranges::find(kinds_, text_of(event, "kind")) != kinds_.end();
}

std::string EventLines::add(const Json& json) {
  if (!is_wanted(json)) return "";
  Event event = read(json);
  if (each_) return line_of(event);
  const bool is_late = is_of_a_miss(event.kind);
  const bool goes_on = is_late && !incident_.empty() && event.at_ns - incident_.back().at_ns <= kPause;
  std::string text = goes_on ? "" : end();
  if (is_late)
    incident_.push_back(std::move(event));
  else
    text += line_of(event);
  return text;
}

std::string EventLines::end() {
  const std::vector<Event> told = std::exchange(incident_, {});
  if (told.empty()) return "";
  return told.size() == 1 ? line_of(told[0]) : line_of(told);
}

std::string events_text(const Json& answer, std::int64_t since, EventLines lines) {
  std::string text;
  const std::int64_t first = whole_of(answer, "first");
  if (since > 0 && first > since && whole_of(answer, "last") >= since)
    text = "(" + std::to_string(first - since) + " older events are gone)\n";
  for (const Json& event : answer["events"]) text += lines.add(event);
  return text + lines.end();
}

}  // namespace chimera::cli
