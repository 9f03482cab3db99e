// SPDX-License-Identifier: Apache-2.0
// Logs deaths and lost output of the run client.
#include "chimera/manager/watch/face_watch.h"

#include <string>

#include "chimera/base/hosted/wording.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/platform/process.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

std::string last_end(const ManagerState& state) {
  return "ended by " + std::string(signal_text(state.keeper.face_signal.load(std::memory_order_relaxed)).view());
}

}  // namespace

void FaceWatch::look(ManagerState& state, Nanoseconds at) {
  const std::uint32_t deaths = state.keeper.face_deaths.load(std::memory_order_acquire);
  if (deaths > deaths_)
    state.tell("face-died", TaskId{}, RtpuId{},
               "the process that prints and ends the run " + last_end(state) + ", " + counted(deaths, "time") +
                   " in all",
               at);
  deaths_ = deaths;
  const std::int32_t lost = state.keeper.lost_output.load(std::memory_order_acquire);
  if (lost != 0 && lost_ == 0)
    state.tell("output-lost", TaskId{}, RtpuId{},
               std::string("standard output of the run is lost (") + why_lost_text(lost) + "); the run goes on", at);
  lost_ = lost;
}

Json face_json(const ManagerState& state) {
  const std::uint32_t deaths = state.keeper.face_deaths.load(std::memory_order_acquire);
  const std::int32_t lost = state.keeper.lost_output.load(std::memory_order_acquire);
  return {{"deaths", deaths},
          {"last_end", deaths > 0 ? Json(last_end(state)) : Json()},
          {"lost_output", lost != 0 ? Json(why_lost_text(lost)) : Json()}};
}

}  // namespace chimera::manager
