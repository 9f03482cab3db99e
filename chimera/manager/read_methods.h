// SPDX-License-Identifier: Apache-2.0
// The methods of the control protocol that change nothing and are answered at once. docs/formats/control.md.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "chimera/control/control_backend.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/text/json.h"

namespace chimera::manager {

/// Context: setup; may block for the time of a copy.
class ReadMethods {
 public:
  /// `state` outlives it.
  explicit ReadMethods(const ManagerState& state) : state_(state) {}

  /// The answer to a call; the row of its method has checked its parameters. None if the method is not one of these.
  std::optional<control::RpcResponse> answer(control::MethodId method, const Json& parameters, control::Role role);

 private:
  control::RpcResponse hello(control::Role role) const;
  control::RpcResponse get(const Json& parameters) const;
  control::RpcResponse events(const Json& parameters) const;
  control::RpcResponse why(const Json& parameters) const;
  control::RpcResponse describe(const Json& parameters);

  const ManagerState& state_;
  // Answers that never change, made at the first request.
  std::shared_ptr<const std::string> library_, text_;
  std::map<std::string, std::shared_ptr<const std::string>> descriptions_;  // by "", "picture" or "picture NAME"
};

}  // namespace chimera::manager
