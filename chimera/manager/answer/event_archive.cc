// SPDX-License-Identifier: Apache-2.0
// Writes each event as a line of JSON, and reads such lines back into the log.
#include "chimera/manager/answer/event_archive.h"

#include <utility>

#include "chimera/manager/answer/status_json.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

/// The index of `name` in `all`; invalid if it has no such name.
template <class Id, class Specs>
Id id_of(const Specs& all, const std::string& name) {
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return Id(i);
  return Id{};
}

LoggedEvent event_of(const ApplicationSpec& spec, const Json& json) {
  return {static_cast<std::uint64_t>(whole_at(json, "number")),
          Nanoseconds{whole_at(json, "at_ns")},
          whole_at(json, "wall_ns"),
          text_at(json, "kind"),
          id_of<TaskId>(spec.tasks, text_at(json, "task")),
          id_of<RtpuId>(spec.rtpus, text_at(json, "rtpu")),
          text_at(json, "text"),
          text_at(json, "by")};
}

}  // namespace

EventArchive::EventArchive(ManagerState& state, std::unique_ptr<Filing> filing)
    : state_(state),
      journal_(state.own.block().event_journal()),
      filing_(std::move(filing)),
      left_(filing_->unfiled().begin(), filing_->unfiled().end()) {
  state_.keep = [this](const LoggedEvent& event) {
    const std::string line = event_json(state_, event).dump(Json::Style::kSpaced);
    (void)journal_.put(event.number, line);  // no room: the disk accepts nothing, and only this manager has it
    filing_->add(event.number, line, now());
  };
}

Result<std::unique_ptr<EventArchive>> EventArchive::start(ManagerState& state, const std::string& folder) {
  const std::string run = "\"origin_ns\": " + std::to_string(state.keeper.origin.count) + ", ";
  auto filing = Filing::start(state, LineJournal(state.own.block().event_journal()),
                              {.folder = folder, .stem = "events", .n_found = kEventsKept, .run = run});
  if (!filing) return filing.error();
  return std::unique_ptr<EventArchive>(new EventArchive(state, *std::move(filing)));
}

/// Found lines come first. A left line that is among them was filed just before the predecessor died.
void EventArchive::recall(std::vector<std::string> found, Nanoseconds now) {
  std::vector<LoggedEvent> events;
  for (const std::string& line : found) events.push_back(event_of(state_.spec(), Json::parse(line)));
  const std::uint64_t last = events.empty() ? 0 : events.back().number;
  for (const Filing::Line& line : std::exchange(left_, {}))
    if (const auto json = Json::parse_or_none(line.text); json && line.number > last)
      events.push_back(event_of(state_.spec(), *json));
  EventLog& log = state_.log;
  log.recall(std::move(events));
  if (const std::uint64_t first = log.first(); first > 1 && log.last() - first + 1 < kEventsKept)
    state_.tell("note", TaskId{}, RtpuId{}, "events 1 to " + std::to_string(first - 1) + " are lost", now);
}

void EventArchive::look(Nanoseconds now) {
  filing_->look(now);
  if (auto found = filing_->take_found()) recall(*std::move(found), now);
}

}  // namespace chimera::manager
