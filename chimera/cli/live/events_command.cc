// SPDX-License-Identifier: Apache-2.0
// Asks for all events, adds those of earlier runs, or reads them from their file.
#include "chimera/cli/live/events_command.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "chimera/cli/live/filed_lines.h"
#include "chimera/cli/print/answer_text.h"
#include "chimera/cli/print/fields.h"
#include "chimera/control/rotated_file.h"
#include "chimera/control/state_folder.h"

namespace chimera::cli {
namespace {

constexpr std::size_t kAtOnce = 1000;      // events in one answer
constexpr std::size_t kOfOneRun = 10'000;  // as many as a manager keeps
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// Events of earlier runs. None unless the file has events of this run too: it may belong to another user's subsystem
/// of the same name.
std::vector<Json> earlier_events(const std::string& subsystem, const Json& events) {
  const std::int64_t origin = whole_of(events[std::size_t{0}], "origin_ns");
  std::vector<Json> earlier;
  bool is_ours = false;
  for (const std::string& line : control::RotatedFile(control::state_folder_of(subsystem), "events").last(kAll)) {
    Json event = Json::parse(line);
    if (whole_of(event, "origin_ns") == origin) is_ours = true;
    else earlier.push_back(std::move(event));
  }
  return is_ours ? earlier : std::vector<Json>();
}

}  // namespace

Result<EventChoice> read_choice(const Call& call, bool is_dated) {
  const std::int64_t now = std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  const auto since = call.has("--since") ? read_since(call.value("--since"), now) : Since{};
  if (!since) return since.error();
  const auto kinds = read_kinds(call.value("--kind"));
  if (!kinds) return kinds.error();
  return EventChoice{*since, EventLines(*kinds, call.has("--each"), since->wall_ns, is_dated || since->is_time())};
}

Json only(const EventLines& lines, Json answer) {
  std::erase_if(answer["events"].elements(), [&](const Json& event) { return !lines.is_wanted(event); });
  return answer;
}

CommandResult events(Session& session, const Call& call, const Screen&) {
  const auto choice = read_choice(call);
  if (!choice) return refused(choice.error(), call.json, kUsage);
  const Since& since = choice->since;
  Json all;
  for (std::int64_t next = since.number; all.is_null() || next > 0;) {
    const control::RpcResponse answer = session.ask("events", {{"since", std::exchange(next, 0)}});
    if (!answer.is_good()) return refused(answer, call.json);
    const Json& got = (*answer.result)["events"];
    if (got.size() >= kAtOnce) next = whole_of(got[got.size() - 1], "number") + 1;
    if (all.is_null()) all = *answer.result;
    else std::ranges::copy(got, std::back_inserter(all["events"].elements()));
  }
  if (since.is_time() && !all["events"].empty()) {
    auto earlier = earlier_events(session.subsystem(), all["events"]);
    auto& elements = all["events"].elements();
    elements.insert(elements.begin(), std::make_move_iterator(earlier.begin()), std::make_move_iterator(earlier.end()));
  }
  return answered(control::RpcResponse::good(only(choice->lines, std::move(all))), call.json,
                  [&](const Json& told) { return events_text(told, since.number, choice->lines); });
}

CommandResult filed_events(const Call& call, const std::string& subsystem, const Error& why) {
  const auto choice = read_choice(call, true);
  if (!choice) return refused(choice.error(), call.json, kUsage);
  if (call.has("--follow")) return refused(why, call.json);
  const Since& since = choice->since;
  const auto filed = filed_lines("events", subsystem, since.is_time() ? kAll : kOfOneRun, why);
  if (!filed) return refused(filed.error(), call.json);
  const Json last = Json::parse(filed->lines.back());
  Json first, chosen = Json::array();
  for (const std::string& line : filed->lines) {
    Json event = Json::parse(line);
    const bool is_of_last_run = event["origin_ns"] == last["origin_ns"];
    if (is_of_last_run && first.is_null()) first = event["number"];
    if (since.is_time() || (is_of_last_run && whole_of(event, "number") >= since.number))
      chosen.push_back(std::move(event));
  }
  const Json answer = only(choice->lines, {{"events", std::move(chosen)}, {"first", first}, {"last", last["number"]},
                                           {"file", filed->path}, {"subsystem", filed->subsystem}});
  if (call.json) return {json_line(answer), "", kOk};
  return {events_text(answer, since.number, choice->lines), filed->source(), kOk};
}

}  // namespace chimera::cli
