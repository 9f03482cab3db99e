// SPDX-License-Identifier: Apache-2.0
// Follows the taps of rtpus and packs their rows for a subscriber; counts every gap.
#include "chimera/manager/answer/tap_feed.h"

#include <algorithm>

#include "chimera/manager/answer/value_json.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

constexpr std::size_t kAtOnce = 4096;            // records of one read
constexpr std::size_t kValuesOfMessage = 10'000;  // about 200 kB

std::vector<std::uint32_t> payload_sizes(const Peers& peers) {
  std::vector<std::uint32_t> bytes;
  for (std::size_t t = 0; t < peers.spec().tasks.size(); ++t) {
    const PeerLayout& layout = peers.layout(peers.spec().tasks[t].rtpu);
    bytes.push_back(layout.place(layout.outputs(TaskId(t), 0)).payload_bytes);
  }
  return bytes;
}

}  // namespace

TapFeed::TapFeed(ManagerState& state, const std::vector<VariableId>& variables, bool from_oldest)
    : state_(state), from_oldest_(from_oldest && variables.empty()), buffer_(kAtOnce) {
  for (const VariableId variable : variables)
    for (const PortOf& port : state.readings->variables().all()[variable.index].producers)
      add_producer(variable, port);
  for (std::uint32_t r = 0; r < state.peers.n_rtpus(); ++r) {
    const auto is_its = [&](const Rows& rows) { return state.spec().tasks[rows.task.index].rtpu == RtpuId(r); };
    if (!variables.empty() && std::none_of(rows_.begin(), rows_.end(), is_its)) continue;
    rings_.emplace_back().rtpu = RtpuId(r);
    follow(rings_.back());
  }
  for (const Rows& rows : rows_) tap(rows.task, true);
  if (!rows_.empty()) state.announce();
}

TapFeed::~TapFeed() {
  for (const Rows& rows : rows_) tap(rows.task, false);
  if (!rows_.empty()) state_.announce();
}

void TapFeed::add_producer(VariableId variable, const PortOf& port) {
  auto rows = std::find_if(rows_.begin(), rows_.end(), [&](const Rows& r) { return r.task == port.task; });
  if (rows == rows_.end()) {
    rows = rows_.emplace(rows_.end());
    rows->task = port.task;
  }
  const PeerLayout& layout = state_.peers.layout(state_.spec().tasks[port.task.index].rtpu);
  const auto places = layout.variables(layout.outputs(port.task, 0));
  rows->columns.push_back({variable, places[port.index].offset});
}

/// Several subscriptions may want one task: the first turns the tap on, the end of the last turns it off.
void TapFeed::tap(TaskId task, bool up) {
  std::uint32_t& users = state_.tap_users[task.index];
  users += up ? 1 : -1u;
  state_.own.block().set_tapped(task, users > 0);
}

/// Starts with the ring of another incarnation, whose records are all new; false if there is none.
bool TapFeed::follow(Ring& ring) {
  auto present = state_.peers.hold(ring.rtpu);
  if (!present->is_there() || present == ring.segment) return false;
  const bool is_first = ring.segment == nullptr;
  ring.reader = TapReader(present->block().tap(), from_oldest_ || !is_first);
  ring.gone = is_first && from_oldest_ ? ring.reader.position() : 0;
  ring.segment = std::move(present);
  ring.assembler = std::make_unique<TapRows>(payload_sizes(state_.peers));
  ring.lost_before = 0;
  return true;
}

/// Reads at most kAtOnce records of all rings, so that other subscribers get their turn. It begins with the ring after
/// the last one.
void TapFeed::pump(const TapSink& sink) {
  std::size_t left = kAtOnce;
  for (std::size_t n = rings_.size(); n > 0 && left > 0; --n) {
    Ring& ring = rings_[next_++ % rings_.size()];
    while (drain(ring, left, sink) && follow(ring)) {
    }
    flush(ring, 0, sink);
  }
  for (Rows& rows : rows_) flush(rows, sink);
}

/// Reads up to `left` records and subtracts them from `left`. True if the ring is empty.
bool TapFeed::drain(Ring& ring, std::size_t& left, const TapSink& sink) {
  const std::size_t n = ring.reader.read(std::span(buffer_).first(left));
  const std::uint64_t lost = ring.reader.lost() - std::exchange(ring.lost_before, ring.reader.lost()) +
                             std::exchange(ring.gone, 0);
  if (rows_.empty() && lost > 0) flush(ring, lost, sink);
  for (std::size_t i = 0; i < n; ++i) take(ring, buffer_[i], sink);
  left -= n;
  return left > 0;
}

void TapFeed::take(Ring& ring, const TapRecord& record, const TapSink& sink) {
  if (record.kind == TapKind::kGroup || record.kind == TapKind::kValue) {
    if (rows_.empty()) return;
    if (const TapRow* row = ring.assembler->take(record); row != nullptr) take_row(*row, sink);
  } else if (const auto kind = static_cast<std::size_t>(record.kind); rows_.empty() && kind < kTapKinds.size()) {
    const bool has_task = record.task.index < state_.peers.n_tasks();
    ring.waiting.push_back(Json::array({record.at.count, kTapKinds[kind],
                                        has_task ? Json(state_.name(record.task)) : Json(), record.a, record.b}));
    if (ring.waiting.size() > kValuesOfMessage / 5) flush(ring, 0, sink);
  }
}

void TapFeed::take_row(const TapRow& row, const TapSink& sink) {
  const auto rows = std::find_if(rows_.begin(), rows_.end(), [&](const Rows& r) { return r.task == row.task; });
  if (rows == rows_.end()) return;  // another subscription wants it
  if (row.lost > 0 || rows->waiting.size() * row.payload.size() > 8 * kValuesOfMessage) flush(*rows, sink);
  rows->lost += row.lost;
  Json made = Json::array({row.at.count, row.sequence});
  for (const Column& column : rows->columns) {
    ValueForm form = state_.readings->form(column.variable);
    form.is_scalar = false;  // always a list, so that a client need not check
    made.push_back(value_of(form, row.payload.subspan(column.offset, std::size_t{form.count} * form.element_bytes)));
  }
  rows->waiting.push_back(std::move(made));
}

void TapFeed::flush(Rows& rows, const TapSink& sink) {
  if (rows.waiting.empty()) return;
  Json names = Json::array();
  for (const Column& column : rows.columns) names.push_back(state_.readings->configured(column.variable).name);
  const std::uint64_t next = rows.first + rows.lost + rows.waiting.size();
  sink({{"rtpu", state_.name(state_.spec().tasks[rows.task.index].rtpu)},
        {"task", state_.name(rows.task)},
        {"variables", std::move(names)},
        {"first", rows.first},
        {"lost", rows.lost},
        {"rows", std::exchange(rows.waiting, {})}});
  rows.first = next;
  rows.lost = 0;
}

/// Sends the waiting records first: the lost ones came after them.
void TapFeed::flush(Ring& ring, std::uint64_t lost, const TapSink& sink) {
  const auto say = [&](std::vector<Json> records, std::uint64_t gone) {
    const std::uint64_t next = ring.first + records.size() + gone;
    sink({{"rtpu", state_.name(ring.rtpu)}, {"first", ring.first}, {"lost", gone}, {"records", std::move(records)}});
    ring.first = next;
  };
  if (!ring.waiting.empty()) say(std::exchange(ring.waiting, {}), 0);
  if (lost > 0) say({}, lost);
}

}  // namespace chimera::manager
