// SPDX-License-Identifier: Apache-2.0
// The interface to a subsystem: serves the control protocol on a listening Unix socket, within its limits and rights.
// docs/formats/control.md. Single-threaded, never blocks; driven by the loop of its owner.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "chimera/base/result.h"
#include "chimera/control/closings.h"
#include "chimera/control/connection.h"
#include "chimera/control/control_backend.h"
#include "chimera/control/places.h"
#include "chimera/control/request.h"
#include "chimera/control/subscriptions.h"
#include "chimera/platform/descriptor_set.h"

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
  ~ControlServer();

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
  struct Call;

  ControlServer(ControlBackend& backend, uid_t owner, const RoleGroups& groups)
      : backend_(backend), subscriptions_(backend), owner_(owner), groups_(groups) {}
  void accept(Nanoseconds now);
  RpcResponse admit(const PeerIdentity& peer, Nanoseconds now);
  Standing standing(Connection& connection, Nanoseconds now) const;
  std::string idle_text(Connection& connection, Nanoseconds now) const;
  void evict(Connection& connection, const std::string& why, Nanoseconds now);
  // control_server_turn.cc
  void run_turn(Nanoseconds now);
  bool act(Nanoseconds now);
  bool act_of(Connection& connection, Nanoseconds now);
  bool ask(Nanoseconds now);
  void answer_first(Connection& connection, Nanoseconds now);
  void carry_out_next(Connection& connection, Nanoseconds now);
  // control_server.cc
  void on_line(Connection& connection, const std::string& line, Nanoseconds now);
  void carry_out(Connection& connection, const Request& request, Nanoseconds now);
  RpcResponse judge(Connection& connection, const Request& request, const MethodRule* rule, Nanoseconds now);
  RpcResponse subscribe(Connection& connection, const Json& parameters, Nanoseconds now);
  void answer(Connection& connection, const Request& request, const RpcResponse& answer);
  const char* fault_of(Connection& connection, Nanoseconds now) const;
  bool is_over(Connection& connection, Nanoseconds now);
  void settle(Nanoseconds now);
  void end(std::uint64_t connection);

  ControlBackend& backend_;
  Subscriptions subscriptions_;
  uid_t owner_;
  RoleGroups groups_;
  OwnedDescriptor listening_;
  DescriptorSet watched_;
  std::map<std::uint64_t, std::unique_ptr<Connection>> connections_;
  std::uint64_t last_connection_ = 0;
  Closings closings_;
  std::uint64_t last_asked_ = 0;                                   // whose question was answered last
  Nanoseconds now_;                                                // of the last serve()
  Nanoseconds accepts_again_ = kNever;                             // while nobody can be let in for lack of descriptors
  bool has_more_ = false;                                          // to do at once
  std::shared_ptr<bool> is_alive_ = std::make_shared<bool>(true);  // for replies that come after the end
};

}  // namespace chimera::control
