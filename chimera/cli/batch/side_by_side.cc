// SPDX-License-Identifier: Apache-2.0
// Forks a child for each piece of work, reads their answers, and ends those that take too long.
#include "chimera/cli/batch/side_by_side.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <thread>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/run/own_process.h"
#include "chimera/cli/run/run.h"
#include "chimera/cli/run/under_way.h"
#include "chimera/platform/process.h"

namespace chimera::cli {
namespace {

constexpr int kLookEvery = 100;            // ms, for the limit and for the operator
constexpr std::size_t kLongestWord = 200;  // of what a child said last

Nanoseconds wall() { return Nanoseconds{std::chrono::steady_clock::now().time_since_epoch().count()}; }

void write_all(int to, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(to, text.data() + done, text.size() - done);
    if (n < 0 && errno != EINTR) return;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
}

/// A piece under way.
struct Child {
  std::size_t piece = 0;
  pid_t pid = -1;
  int answer = -1, errors = -1;
  Nanoseconds began;
  PieceEnd end;
  bool is_late = false;
  UnderWay* place = nullptr;  ///< null: no memory for it
};

[[noreturn]] void live(const SideBySide& plan, std::size_t piece, pid_t parent, int answer, int errors,
                       UnderWay* place) {
  if (place != nullptr) write_under_way_to(*place);
  if (!follow_parent(parent, SIGKILL)) ::_exit(1);  // the parent was killed before
  std::signal(SIGINT, SIG_IGN);  // of a terminal: the parent ends all children
  std::signal(SIGTERM, SIG_DFL);
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  ::dup2(nowhere, STDIN_FILENO);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(errors, STDERR_FILENO);
  const std::string said = plan.work(piece);
  if (place != nullptr) place->has_returned = true;
  write_all(answer, said);
  ::_exit(0);
}

/// The last line of what the child wrote to standard error.
std::string last_line(int errors) {
  const off_t size = ::lseek(errors, 0, SEEK_END);
  std::string text(static_cast<std::size_t>(std::clamp<off_t>(size, 0, 8192)), '\0');
  if (::pread(errors, text.data(), text.size(), size - static_cast<off_t>(text.size())) < 0) return {};
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  text.erase(0, text.rfind('\n') + 1);
  return text.substr(0, kLongestWord);
}

class Crowd {
 public:
  explicit Crowd(const SideBySide& plan) : plan_(plan), ends_(plan.pieces) {}

  std::vector<PieceEnd> run() {
    while (next_ < plan_.pieces || !children_.empty()) {
      if (stop_is_requested()) return stopped();
      while (next_ < plan_.pieces && children_.size() < std::max<std::size_t>(plan_.jobs, 1) && start()) {
      }
      listen();
    }
    return std::move(ends_);
  }

 private:
  /// False when the system has no process for it now, and one of ours will end.
  bool start() {
    int answer[2] = {-1, -1};
    const int errors = ::memfd_create("chimera-piece", MFD_CLOEXEC);
    UnderWay* place = make_shared_under_way();
    const bool has_pipe = errors >= 0 && ::pipe2(answer, O_CLOEXEC) == 0;
    const pid_t parent = ::getpid();
    const pid_t pid = has_pipe ? ::fork() : -1;
    if (pid == 0) live(plan_, next_, parent, answer[1], errors, place);
    const int why = errno;
    if (has_pipe) ::close(answer[1]);
    if (pid > 0) {
      children_.push_back({next_++, pid, answer[0], errors, wall(), {}, false, place});
      return true;
    }
    release(place);
    for (const int descriptor : {errors, answer[0]})
      if (descriptor >= 0) ::close(descriptor);
    if (!children_.empty()) return false;
    ends_[next_++].failure = std::string("no process could be started: ") + std::strerror(why);
    plan_.on_done(++done_);
    return true;
  }

  void listen() {
    std::vector<pollfd> waits;
    for (const Child& child : children_) waits.push_back({child.answer, POLLIN, 0});
    if (::poll(waits.data(), waits.size(), kLookEvery) < 0) return;  // a signal: checked next
    for (std::size_t i = waits.size(); i-- > 0;) {
      if (waits[i].revents != 0)
        collect(i);
      else if (wall() - children_[i].began > plan_.limit && !children_[i].is_late) {
        children_[i].is_late = true;
        ::kill(children_[i].pid, SIGKILL);  // still ours: not reaped
      }
    }
  }

  void collect(std::size_t index) {
    Child& child = children_[index];
    char part[4096];
    const ssize_t n = ::read(child.answer, part, sizeof part);
    if (n > 0) child.end.said.append(part, static_cast<std::size_t>(n));
    if (n > 0 || (n < 0 && errno == EINTR)) return;
    finish(child);
    children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(index));
    plan_.on_done(++done_);
  }

  void finish(Child& child) {
    int status = 0;
    while (::waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {  // still ours: not reaped
    }
    const bool has_returned = child.place == nullptr || child.place->has_returned;
    std::string& why = child.end.failure;
    if (child.is_late) why = formatted("did not end within %.6g s", to_seconds(plan_.limit));
    else if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !has_returned) why = end_text(status);
    const std::string what = why.empty() || child.place == nullptr ? "" : child.place->text();
    if (!what.empty()) why += " " + what;
    if (const std::string last = why.empty() ? "" : last_line(child.errors); !last.empty()) why += ": " + last;
    release(child.place);
    child.end.wall = wall() - child.began;
    ::close(child.answer);
    ::close(child.errors);
    ends_[child.piece] = std::move(child.end);
  }

  std::vector<PieceEnd> stopped() {
    for (const Child& child : children_) ::kill(child.pid, SIGKILL);  // still ours: not reaped
    for (Child& child : children_) {
      finish(child);
      ends_[child.piece].failure = "ended by the operator";
    }
    for (; next_ < plan_.pieces; ++next_) ends_[next_].failure = "ended by the operator";
    return std::move(ends_);
  }

  const SideBySide& plan_;
  std::vector<PieceEnd> ends_;
  std::vector<Child> children_;
  std::size_t next_ = 0, done_ = 0;
};

}  // namespace

std::vector<PieceEnd> side_by_side(const SideBySide& plan) {
  std::fflush(nullptr);  // or the children would write it again
  return Crowd(plan).run();
}

std::size_t processors() { return std::max(1u, std::thread::hardware_concurrency()); }

}  // namespace chimera::cli
