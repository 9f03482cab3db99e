// SPDX-License-Identifier: Apache-2.0
// The interface to a subsystem: serves the control protocol on a listening Unix socket, within its limits and rights.
// docs/formats/control.md. Single-threaded, never blocks; driven by the loop of its owner.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "chimera/base/result.h"
#include "chimera/control/closings.h"
#include "chimera/control/connection.h"
#include "chimera/control/control_backend.h"
#include "chimera/control/dispatcher.h"
#include "chimera/control/places.h"
#include "chimera/control/subscriptions.h"
#include "chimera/platform/descriptor.h"

namespace chimera::control {

/// Context: setup.
class ControlServer {
 public:
  /// Takes over `listening` (-1: connections only come by enter()). `owner` is the user of the keeper; `backend`
  /// outlives the server.
  static Result<std::unique_ptr<ControlServer>> open(int listening, ControlBackend& backend, uid_t owner,
                                                     const RoleGroups& groups);
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  /// Readable when serve() has something to do: for the owner's poll or epoll.
  int descriptor() const noexcept { return watched_.descriptor(); }
  /// Accepts, reads, answers, notifies, sends. `now` never goes back.
  void serve(Nanoseconds now);
  /// When serve() is due though nothing came; kNever: not before something comes. Never later than `now` of the last
  /// serve() when an answer has been given since.
  Nanoseconds next_due() const noexcept;
  /// `tell` gets a sentence for people about every connection that the server closes and not its peer.
  void report_closings_to(Closings::Tell tell) { closings_.report_to(std::move(tell)); }
  /// Takes over a connected socket whose other end is known; refuses it with words when it has no role or finds no
  /// place. Another one may have to give way to it.
  void enter(OwnedDescriptor connected, const PeerIdentity& peer, Nanoseconds now);
  std::size_t connections() const noexcept { return connections_.size(); }

 private:
  ControlServer(ControlBackend& backend, uid_t owner, const RoleGroups& groups)
      : backend_(backend),
        subscriptions_(backend),
        dispatcher_(backend, subscriptions_, connections_),
        owner_(owner),
        groups_(groups) {}
  void accept(Nanoseconds now);
  RpcResponse admit(const PeerIdentity& peer, Nanoseconds now);
  Activity activity(Connection& connection, Nanoseconds now) const;
  std::string idle_text(Connection& connection, Nanoseconds now) const;
  void evict(Connection& connection, const std::string& why, Nanoseconds now);
  const char* fault_of(Connection& connection, Nanoseconds now) const;
  bool is_over(Connection& connection, Nanoseconds now);
  void settle(Nanoseconds now);
  void end(std::uint64_t connection);

  ControlBackend& backend_;
  Connections connections_;
  Subscriptions subscriptions_;
  Dispatcher dispatcher_;
  uid_t owner_;
  RoleGroups groups_;
  OwnedDescriptor listening_;
  DescriptorSet watched_;
  std::uint64_t last_connection_ = 0;
  Closings closings_;
  Nanoseconds now_;                     // of the last serve()
  Nanoseconds accepts_again_ = kNever;  // time of the next accept(), after descriptors ran out
  bool has_more_ = false;               // to do at once
};

}  // namespace chimera::control
