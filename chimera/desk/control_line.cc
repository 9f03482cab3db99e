// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/control_line.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "chimera/desk/run.h"
#include "chimera/platform/linux_clock.h"

namespace chimera::desk {
namespace {

using control::Answer;
using control::Json;

constexpr Nanoseconds kTryAgain = milliseconds(10);
constexpr Nanoseconds kLastPatience = milliseconds(500);  // once told to end: the keeper itself may be gone

Nanoseconds now() noexcept { return LinuxClock().now(); }

}  // namespace

Result<Json> ControlLine::ask(std::string_view method, const Json& parameters, Nanoseconds patience) {
  const Nanoseconds begun = now(), until = begun + patience;
  do {
    if (!client_)
      if (auto made = control::Client::connect_to(path_, until - now()); made) client_ = *std::move(made);
    if (client_) {
      const Answer answer = client_->call(method, parameters, until - now());
      if (answer.is_good()) return *answer.result;
      if (answer.code != control::kNoConnection)
        return Error{ErrorCode::kRefused, std::string_view(answer.message), std::string_view(answer.detail("where"))};
      client_.reset();
    }
    LinuxClock().wait_until(now() + kTryAgain);
  } while (now() < (stop_is_requested() ? std::min(until, begun + kLastPatience) : until));
  return Error{ErrorCode::kSystem, std::string_view("the manager of the subsystem does not answer"),
               std::string_view(path_)};
}

std::optional<Json> ControlLine::notification(Nanoseconds instant) {
  if (!client_) return std::nullopt;
  const auto note = client_->next(std::max(instant - now(), Nanoseconds{0}));
  if (!note) client_.reset();
  if (!note || !*note) return std::nullopt;
  return *(*note)->parameters;
}

}  // namespace chimera::desk
