// SPDX-License-Identifier: Apache-2.0
// The interface behind ControlServer: the subsystem, as the manager knows it; in tests a model of one.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "chimera/control/methods.h"
#include "chimera/control/rpc_response.h"

namespace chimera::control {

/// The connection and user that a call comes from.
struct Caller {
  Role role = Role::kNone;
  std::uint64_t connection = 0;  ///< number of the connection; never used again for another one
  std::uint32_t user = 0;        ///< its number in the system
};

/// Called by ControlServer::serve() only, on its thread. An implementation must not throw, and must not call
/// ControlServer except through its Reply. Context: setup.
class ControlBackend {
 public:
  /// Carries out a call whose role and parameters have been checked; `reply` takes its one answer, now or later.
  virtual void call(const MethodRule& method, const Json& parameters, const Caller& caller, Reply reply) = 0;
  /// The connection is over, so its questions need no answer. Acts that it asked for are still carried out.
  virtual void forget(std::uint64_t /*connection*/) {}
  /// Opens a subscription, or refuses if it is not possible. `parameters` as those of `subscribe`.
  virtual RpcResponse open(std::uint64_t subscription, const Json& parameters) = 0;
  virtual void close(std::uint64_t subscription) = 0;
  /// Parameters of the notification to send now (without `subscription`); null: nothing new. Called at each period
  /// (status, values), or whenever the peer has room (events, tap). A slow peer causes fewer calls; the result then
  /// counts what was lost between them.
  virtual std::shared_ptr<const Json> pull(std::uint64_t subscription) = 0;
  /// Asked before pull(): the parameters of a notification that is too large to be made at once, `subscription` among
  /// them. Null: pull() is to be asked.
  virtual std::shared_ptr<Pieces> pull_pieces(std::uint64_t /*subscription*/) { return nullptr; }

 protected:
  ~ControlBackend() = default;
};

}  // namespace chimera::control
