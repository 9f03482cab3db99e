// SPDX-License-Identifier: Apache-2.0
// The manager's loop over the control socket, the questions and ManagerLoop.
#include "chimera/manager/run.h"

#include <algorithm>
#include <filesystem>

#include "chimera/control/control_server.h"
#include "chimera/manager/answer/questions.h"
#include "chimera/manager/manager_backend.h"
#include "chimera/platform/process_state.h"

namespace chimera::manager {

Result<int> run(const Inherited& inherited, std::uint32_t incarnation, std::int32_t keeper_pid) {
  auto started = ManagerLoop::start(inherited, incarnation, keeper_pid);
  if (!started) return started.error();
  if (*started == nullptr) return 0;
  ManagerLoop& loop = **started;
  // Connections wait in the backlog until the inventory is complete and the events of before are read, so that no
  // command meets an incomplete state.
  const Nanoseconds until = now() + ReceiptArchive::kDiskLimit;
  const auto reads = [&] { return now() < until && !std::ranges::all_of(loop.filings(), &Filing::has_read); };
  while (!loop.is_ready() || reads())
    if (!loop.step(now() + milliseconds(10))) return 0;
  const Bundle& bundle = loop.state().bundle;
  std::error_code error;
  Questions questions(
      std::filesystem::read_symlink("/proc/self/exe", error).string(), loop.bundle(),
      [&loop](const std::string& text) { loop.state().tell("note", TaskId{}, RtpuId{}, text, now()); });
  ManagerBackend backend(loop, &questions);
  auto server = control::ControlServer::open(loop.take_listening(), backend, own_user(),
                                           {bundle.observe_group, bundle.operate_group, bundle.configure_group});
  if (!server) return server.error();
  (*server)->report_closings_to(
      [&loop](const std::string& text) { loop.state().tell("closed", TaskId{}, RtpuId{}, text, now()); });
  do {
    (*server)->serve(now());
    questions.serve(now());
  } while (loop.step(std::min((*server)->next_due(), questions.next_due()), (*server)->descriptor(),
                     questions.descriptor()));
  loop.finish();
  return 0;
}

}  // namespace chimera::manager
