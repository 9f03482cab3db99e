// SPDX-License-Identifier: Apache-2.0
// The one door to a subsystem: serves the control protocol on a listening Unix socket, within its limits and rights.
// docs/formats/control.md. Single-threaded, never blocks; driven by the loop of its owner.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "chimera/base/result.h"
#include "chimera/control/session.h"
#include "chimera/control/subject.h"

namespace chimera::control {

/// Context: setup.
class Door {
 public:
  /// Takes over `listening`. `owner` is the user of the keeper; `subject` outlives the door.
  static Result<std::unique_ptr<Door>> open(int listening, Subject& subject, uid_t owner, const RoleGroups& groups);
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;
  ~Door();

  /// Readable when serve() has something to do: for the owner's poll or epoll.
  int descriptor() const noexcept { return epoll_.fd; }
  /// Lets in somebody who did not come by the listening socket, or tells why not. Context: setup.
  void enter(OwnedDescriptor socket, const PeerIdentity& peer, Nanoseconds now);
  /// Accepts, reads, answers, notifies, sends. `now` never goes back.
  void serve(Nanoseconds now);
  /// When serve() is due though nothing came; kNever: not before something comes.
  Nanoseconds next_due() const noexcept;
  std::size_t connections() const noexcept { return sessions_.size(); }

 private:
  struct Subscription {
    std::uint64_t session = 0;
    std::string to;
    Nanoseconds period;  ///< 0: whenever there is something new
    Nanoseconds due;
  };

  Door(Subject& subject, uid_t owner, const RoleGroups& groups) : subject_(subject), owner_(owner), groups_(groups) {}
  void accept(Nanoseconds now);
  bool may_enter(const PeerIdentity& peer) const;
  void read(Session& session, Nanoseconds now);
  void take(Session& session, const std::string& line, Nanoseconds now);
  Answer judge(Session& session, const std::string& method, const MethodRule* rule, const Json& parameters,
               Nanoseconds now);
  void answer(std::uint64_t session, const Json& id, const Answer& answer);
  Answer subscribe(Session& session, const Json& parameters, Nanoseconds now);
  Answer unsubscribe(Session& session, const Json& parameters);
  void notify(Nanoseconds now);
  void flush(Nanoseconds now);
  void end(std::uint64_t session);

  Subject& subject_;
  uid_t owner_;
  RoleGroups groups_;
  OwnedDescriptor listening_, epoll_;
  std::map<std::uint64_t, std::unique_ptr<Session>> sessions_;
  std::map<std::uint64_t, Subscription> subscriptions_;
  std::uint64_t last_session_ = 0, last_subscription_ = 0;
  std::shared_ptr<bool> is_alive_ = std::make_shared<bool>(true);  // for replies that come after the end
};

}  // namespace chimera::control
