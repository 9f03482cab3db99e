// SPDX-License-Identifier: Apache-2.0
// Turns answers of the control protocol into results.
#include "chimera/cli/run/control_line.h"

#include <algorithm>

#include "chimera/platform/clock.h"
#include "chimera/text/json.h"

namespace chimera::cli {

using control::RpcResponse;

Result<Json> ControlLine::ask(std::string_view method, const Json& parameters, Nanoseconds limit) {
  const RpcResponse answer = client_.call(method, parameters, limit);
  if (answer.is_good()) return *answer.result;
  const bool is_lost = answer.code == control::kNoConnection || answer.code == control::kNoAnswer;
  const std::string where = is_lost ? client_.path() : answer.detail("where");
  return Error{is_lost ? ErrorCode::kSystem : ErrorCode::kRefused, std::string_view(answer.message),
               std::string_view(where)};
}

std::optional<Json> ControlLine::notification(Nanoseconds instant) {
  if (!is_connected()) return std::nullopt;
  const auto note = client_.next(std::max(instant - LinuxClock().now(), Nanoseconds{0}));
  if (!note || !*note) return std::nullopt;
  return *(*note)->parameters;
}

}  // namespace chimera::cli
