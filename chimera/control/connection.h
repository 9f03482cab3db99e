// SPDX-License-Identifier: Apache-2.0
// One connection of the control server: the user at its other end with its role (docs/formats/control.md, "Rights");
// lines in, lines out, within the limits. Knows no method.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "chimera/control/allowance.h"
#include "chimera/control/limits.h"
#include "chimera/control/pieces.h"
#include "chimera/control/request.h"
#include "chimera/control/rpc_response.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/process_state.h"

namespace chimera::control {

/// Groups whose members get a role; none by default.
struct RoleGroups {
  std::optional<gid_t> observe, operate, configure;
};

struct PeerIdentity {
  uid_t user = static_cast<uid_t>(-1);
  Role role = Role::kNone;
  pid_t process = 0;  ///< that connected; 0: not known
};

/// The highest role of a peer with that user and those groups; `owner` is the user of the keeper. Context: any.
Role role_of(uid_t user, std::span<const gid_t> groups, uid_t owner, const RoleGroups& rules) noexcept;
/// Asks the kernel for the user and process that connected (SO_PEERCRED, SO_PEERGROUPS). Context: setup.
PeerIdentity identify(int descriptor, uid_t owner, const RoleGroups& rules);

/// Context: setup; never blocks.
class Connection {
 public:
  Connection(std::uint64_t number, OwnedDescriptor socket, PeerIdentity peer, Nanoseconds now)
      : active_at(now), number_(number), socket_(std::move(socket)), peer_(peer), moved_(now), taken_at_(now) {}

  std::uint64_t number() const noexcept { return number_; }
  int descriptor() const noexcept { return socket_.fd; }
  const PeerIdentity& peer() const noexcept { return peer_; }

  /// Takes what has come, at most a line of the greatest length and one read more.
  void receive(Nanoseconds now);
  /// When the first byte came of a line that has no end yet; kNever: there is none.
  Nanoseconds half_since() const noexcept { return half_since_; }
  /// The server did not read from the peer until now: the time of a half line begins anew.
  void restart_line_timer(Nanoseconds now) noexcept { half_since_ = half_since_ == kNever ? kNever : now; }
  /// The peer says nothing more; it may still listen.
  bool has_ended() const noexcept { return has_ended_; }
  /// The next whole line, without its end. A line longer than the limit comes cut behind it, or whole.
  bool take_line(std::string& line);
  /// Something is left to do: a line, or `next`.
  bool has_line() const noexcept;
  /// The next line is whole, and shorter than kLongLine: quickly read.
  bool has_short_line() const noexcept;

  /// Queues a line that has its end.
  void queue(const std::string& line, Nanoseconds now);
  /// Queues a line that begins with `begin`, goes on with `pieces` and ends with `end`. go_on() makes it, as the peer
  /// takes it; lines queued before it is finished go behind it.
  void queue_in_pieces(const std::string& begin, std::shared_ptr<Pieces> pieces, const std::string& end,
                       Nanoseconds now);
  /// Makes the next piece of such a line and sends what can be sent. False: there is none, or no room for it.
  bool go_on(Nanoseconds now);
  /// go_on() has something to make.
  bool can_go_on() const noexcept { return !behind_.empty() && output_.size() - sent_ < kAhead; }
  /// Sends what can be sent. False when the connection is over: the peer is gone, took nothing for too long, or
  /// everything was sent and it is closing.
  bool flush(Nanoseconds now);
  bool has_output() const noexcept { return has_bytes() || !behind_.empty(); }
  /// The peer takes what it is sent, and no line is made piece by piece: more may be read from it and made for it.
  bool has_room() const noexcept { return behind_.empty() && output_.size() - sent_ < kMaxOutput; }
  /// Has the peer read all that was sent, or some of it within the last kStalledPeerLimit?
  bool is_read(Nanoseconds now);
  /// When flush() will find that the peer took nothing for too long; kNever: nothing waits.
  Nanoseconds send_timeout() const noexcept { return has_bytes() ? moved_ + kStalledPeerLimit : kNever; }
  /// After what is queued the connection ends.
  void close_after() noexcept { is_closing_ = true; }
  bool is_closing() const noexcept { return is_closing_; }

  Allowance requests{kRequestsPerSecond, kRequestBurst}, acts{kActsPerSecond, kActBurst};
  Nanoseconds active_at;       ///< when the peer last said a line or was answered, kept by the server
  std::size_t open_calls = 0;  ///< whose answers are still to come
  std::size_t open_acts = 0;   ///< those of them that change something
  bool is_gone = false;        ///< the peer closed and reads nothing more
  std::uint32_t watched = 0;   ///< what the server asks its DescriptorSet for
  /// The request that is read and not carried out yet: what it is decides whether it waits. Null: none.
  std::unique_ptr<const Request> next;

 private:
  static constexpr std::size_t kAhead = 4 * kPiece;  // bytes that wait before the next piece is made

  bool has_bytes() const noexcept { return sent_ < output_.size(); }
  bool is_done() const noexcept { return is_closing_ && behind_.empty(); }
  bool send(Nanoseconds now);

  std::uint64_t number_;
  OwnedDescriptor socket_;
  PeerIdentity peer_;
  std::string input_, output_;
  std::size_t taken_ = 0, looked_ = 0;  // of the input: handed out; known to hold no line end
  std::size_t sent_ = 0;
  std::deque<std::shared_ptr<Pieces>> behind_;  // the output, but not made yet; the first is under way
  Nanoseconds moved_;  // when output last went, or the first of it was queued
  Nanoseconds half_since_ = kNever;
  int unread_ = 0;        // sent bytes that the kernel held at the last check, in the kernel's measure
  Nanoseconds taken_at_;  // when the peer was last seen to have read
  bool is_closing_ = false;
  bool has_ended_ = false;
};

/// By number.
using Connections = std::map<std::uint64_t, std::unique_ptr<Connection>>;

}  // namespace chimera::control
