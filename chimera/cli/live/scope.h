// SPDX-License-Identifier: Apache-2.0
// The record of `chimera scope`: rows of the tap around a trigger, any number of channels, with every gap counted.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/cli/live/channel.h"
#include "chimera/cli/live/trigger.h"
#include "chimera/draw/plot.h"
#include "chimera/text/json.h"

namespace chimera::cli {

struct ScopeChannel {
  ChannelName name;
  std::string unit = "1";
  bool is_scalar = true;  ///< a list of one is the value itself
};

struct ScopeRequest {
  std::vector<ScopeChannel> channels;
  std::optional<Trigger> trigger;  ///< settled; none: begins with the first row
  bool trigger_is_scalar = true;
  Nanoseconds pre;                 ///< kept from before the trigger
  Nanoseconds duration;            ///< from the trigger on
};

/// Context: setup; may allocate. Keeps what lies in the window and the row before it, which holds until the first of
/// the window; at most kScopeRows rows of a task. It is armed once the rows of every task cover the whole pre-trigger.
/// An earlier edge is counted and does not begin the window.
class Scope {
 public:
  static constexpr std::size_t kScopeRows = 1'000'000;

  explicit Scope(ScopeRequest request) : request_(std::move(request)) {}

  /// Takes the parameters of a `tap` notification (docs/formats/control.md); others are passed over.
  void add(const Json& params);
  /// Takes the parameters of a `values` notification of operator variables, which no tap has: a row for each new value.
  void add_values(const Json& params);
  bool is_triggered() const noexcept { return begin_.has_value(); }
  /// Edges of the trigger that came before there was a whole pre-trigger, and so did not begin it.
  std::uint64_t early_edges() const noexcept { return early_edges_; }
  /// Every channel has been seen up to the end of the window, or a task has more rows than are kept.
  bool is_complete() const;
  bool is_full() const noexcept { return is_full_; }
  /// When it began, CLOCK_MONOTONIC. Requires: is_triggered().
  Nanoseconds begin() const noexcept { return *begin_; }

  std::size_t rows() const;
  std::uint64_t lost_rows() const;
  std::size_t gaps() const;
  /// "251 rows; 2 gaps, 57 rows lost": what there is and what is not.
  std::string summary() const;

  /// A heading "t(s),q[0](rad),...,lost" and a line for each instant at which a task published, from the trigger on
  /// counted. What was not published then holds the value it had; a channel that nothing was seen of yet is empty;
  /// `lost`: rows that are missing just before this one.
  std::string csv() const;
  /// The recording as a picture; every gap is hatched.
  draw::Plot plot(const std::string& title, const std::string& note) const;

 private:
  struct Row {
    Nanoseconds at;
    std::uint64_t sequence = 0;
    std::uint64_t lost = 0;      ///< rows missing before it
    bool is_break = false;       ///< does not follow from the one before
    std::vector<double> values;  ///< of the columns of its stream
  };
  struct Column {
    std::size_t channel = 0;
    std::string part;
  };
  /// The rows that the tap brings of one task.
  struct Stream {
    std::string rtpu, task;
    std::vector<Column> columns;
    std::deque<Row> rows;
    std::optional<std::uint64_t> next;  ///< number of the row that should come
    std::uint64_t sequence = 0;         ///< of the row that came last
    Nanoseconds newest;
    std::optional<Nanoseconds> oldest = {};  ///< row that came first
    bool is_past = false;                    ///< a row behind the window has come
    std::uint64_t lost_after_window = 0;     ///< rows missing just before the first of these
  };

  using Places = std::map<std::pair<std::size_t, std::size_t>, std::size_t>;  // stream, its column -> of the file

  Places places(std::vector<std::string>& heading) const;
  Stream& stream(const std::string& rtpu, const std::string& task);
  void add_row(Stream& stream, const Json& row, const std::vector<std::string>& variables, std::uint64_t lost);
  void check_trigger(const Json& row, const std::vector<std::string>& variables, Nanoseconds at);
  bool is_armed(Nanoseconds at) const;
  bool has_every_channel() const;
  void prune();
  bool is_in_window(Nanoseconds at) const noexcept;
  std::string column_name(const Column& column) const;
  std::vector<draw::PlotPoint> points_of(const Stream& stream, std::size_t column) const;

  ScopeRequest request_;
  std::deque<Stream> streams_;
  std::optional<Nanoseconds> begin_;
  Nanoseconds trigger_seen_;  ///< time of the newest value that the trigger has checked
  std::uint64_t early_edges_ = 0;
  bool is_full_ = false;
};

}  // namespace chimera::cli
