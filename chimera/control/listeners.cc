// SPDX-License-Identifier: Apache-2.0
// Finds in /proc the processes that hold a control socket, and says why none of them answers.
#include "chimera/control/listeners.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "chimera/platform/local_socket.h"
#include "chimera/platform/orphans.h"
#include "chimera/platform/process_state.h"
#include "chimera/text/time_text.h"

namespace chimera::control {
namespace {

namespace fs = std::filesystem;

/// "socket:[4711]", as the descriptors of its holders are called; "" when no process listens there.
std::string link_of(const std::string& path) {
  constexpr unsigned kAccepts = 0x10000;  // __SO_ACCEPTCON
  std::ifstream sockets("/proc/net/unix");
  std::string line;
  std::getline(sockets, line);  // headings
  while (std::getline(sockets, line)) {
    std::istringstream in(line);
    std::string number, count, protocol, type, state, inode, bound;
    unsigned flags = 0;
    in >> number >> count >> protocol >> std::hex >> flags >> type >> state >> inode >> std::ws;
    std::getline(in, bound);
    if ((flags & kAccepts) == 0 || bound.empty() || bound[0] != '/') continue;
    if (bound == path || (fs::path(bound).filename() == fs::path(path).filename() && are_one_file(bound, path)))
      return "socket:[" + inode + "]";
  }
  return {};
}

bool holds(const fs::path& process, const std::string& link) {
  std::error_code error;
  fs::directory_iterator descriptors(process / "fd", error);
  for (; !error && descriptors != fs::directory_iterator(); descriptors.increment(error)) {
    std::error_code gone;
    if (fs::read_symlink(descriptors->path(), gone) == link) return true;
  }
  return false;
}

}  // namespace

Listeners listeners_at(const std::string& path) {
  Listeners found;
  const std::string link = link_of(path);
  for (const pid_t pid : link.empty() ? std::vector<pid_t>() : numbers_in("/proc")) {
    const std::string name = name_of(pid);
    if ((name != "chimera" && name != "chimera-manager") || !holds("/proc/" + std::to_string(pid), link)) continue;
    (name == "chimera" ? found.keeper : found.manager) = pid;
    const char state = process_state(pid).letter;
    if (name != "chimera") found.is_stopped = state == 'T' || state == 't';
  }
  return found;
}

std::string silence_text(const std::string& path, const Listeners& listeners, Nanoseconds limit) {
  const std::string name = "'" + fs::path(path).stem().string() + "'", for_long = " for " + time_text(limit);
  const std::string goes_on = "its rtpus go on without it; ";
  const std::string end =
      listeners.keeper == 0 ? "" : "`kill " + std::to_string(listeners.keeper) + "` ends everything in order";
  if (listeners.manager == 0 && listeners.keeper == 0)
    return "the manager of " + name + " does not answer" + for_long + "; " + goes_on +
           "try again, or tell the user who started it";
  if (listeners.manager == 0)
    return "no manager of " + name + " has answered" + for_long + ", none runs just now; " + goes_on +
           "try again: its keeper starts another; " + end;
  const std::string manager = std::to_string(listeners.manager);
  return "the manager (process " + manager + ") of " + name + " does not answer" + for_long + ": it " +
         (listeners.is_stopped ? "is stopped" : "hangs, or has too much to do") + "; " + goes_on +
         "try again; `kill -KILL " + manager + "` has the keeper start another" + (end.empty() ? "" : ", " + end);
}

}  // namespace chimera::control
