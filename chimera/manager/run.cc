// SPDX-License-Identifier: Apache-2.0
// The manager's loop over the control socket, the questions and ManagerLoop.
#include "chimera/manager/run.h"

#include <algorithm>
#include <filesystem>

#include "chimera/control/control_server.h"
#include "chimera/manager/manager_backend.h"
#include "chimera/manager/questions.h"
#include "chimera/platform/process_state.h"

namespace chimera::manager {

Result<int> run(const Inherited& inherited, std::uint32_t incarnation, std::int32_t keeper_pid) {
  auto started = ManagerLoop::start(inherited, incarnation, keeper_pid);
  if (!started) return started.error();
  if (*started == nullptr) return 0;
  ManagerLoop& driver = **started;
  // Connections wait in the backlog until the inventory is complete, so that no command meets an incomplete state.
  while (!driver.is_ready())
    if (!driver.step()) return 0;
  const Bundle& bundle = driver.world().bundle;
  std::error_code error;
  Questions questions(
      std::filesystem::read_symlink("/proc/self/exe", error).string(), driver.bundle(),
      [&driver](const std::string& text) { driver.world().tell("note", TaskId{}, RtpuId{}, text, now()); });
  ManagerBackend backend(driver, &questions);
  auto door = control::ControlServer::open(driver.take_listening(), backend, own_user(),
                                           {bundle.observe_group, bundle.operate_group, bundle.configure_group});
  if (!door) return door.error();
  (*door)->report_closings_to(
      [&driver](const std::string& text) { driver.world().tell("closed", TaskId{}, RtpuId{}, text, now()); });
  do {
    (*door)->serve(now());
    questions.serve(now());
  } while (
      driver.step(std::min((*door)->next_due(), questions.next_due()), (*door)->descriptor(), questions.descriptor()));
  driver.finish();
  return 0;
}

}  // namespace chimera::manager
