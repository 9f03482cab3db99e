// SPDX-License-Identifier: Apache-2.0
// What the door opens to: the subsystem, as the manager knows it; or a model of one in tests.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "chimera/control/methods.h"
#include "chimera/control/rpc_response.h"

namespace chimera::control {

/// Who asks.
struct Caller {
  Role role = Role::kNone;
  std::uint64_t connection = 0;  ///< number of the connection; never used again for another one
  std::uint32_t user = 0;        ///< its number in the system
};

/// Called by ControlServer::serve() only, on its thread; must not throw and must not call the door back from within,
/// but for the Reply it is given. Context: setup.
class ControlBackend {
 public:
  /// Carries out a call whose role and parameters have been checked; `reply` takes its one answer, now or later.
  virtual void call(const MethodRule& method, const Json& parameters, const Caller& caller, Reply reply) = 0;
  /// The connection is over: nobody waits for the answers to its questions any more. What it told to do stays told.
  virtual void forget(std::uint64_t /*connection*/) {}
  /// Somebody subscribes; refuses what cannot be. `parameters` as those of `subscribe`.
  virtual RpcResponse open(std::uint64_t subscription, const Json& parameters) = 0;
  virtual void close(std::uint64_t subscription) = 0;
  /// What the subscription is to be sent now, as the parameters of its notification (without `subscription`); null:
  /// nothing new. Asked at each period (status, values), or whenever the peer has room (events, tap): who is slow is
  /// asked less often, and what is gone by then is counted in the answer.
  virtual std::shared_ptr<const Json> pull(std::uint64_t subscription) = 0;
  /// Asked before pull(): the parameters of a notification that is too large to be made at once, `subscription` among
  /// them. Null: pull() is to be asked.
  virtual std::shared_ptr<Pieces> pull_pieces(std::uint64_t /*subscription*/) { return nullptr; }

 protected:
  ~ControlBackend() = default;
};

}  // namespace chimera::control
