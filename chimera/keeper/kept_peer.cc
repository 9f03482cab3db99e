// SPDX-License-Identifier: Apache-2.0
// Starts the process of a peer, exchanges messages with it, and keeps its last start or end.
#include "chimera/keeper/kept_peer.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <vector>

#include "chimera/platform/orphans.h"
#include "chimera/platform/process_state.h"
#include "chimera/rtpu/guard_message.h"

namespace chimera {

using Kind = KeeperMessage::Kind;

namespace {

/// While it lives, new processes inherit `origin`. Use it in one thread only: the environment belongs to the whole
/// process.
class StartsFrom {
 public:
  explicit StartsFrom(const std::string& origin) {
    const char* before = std::getenv(kOriginVariable);
    has_before_ = before != nullptr;
    if (has_before_) before_ = before;
    ::setenv(kOriginVariable, origin.c_str(), 1);
  }
  ~StartsFrom() {
    if (has_before_)
      ::setenv(kOriginVariable, before_.c_str(), 1);
    else
      ::unsetenv(kOriginVariable);
  }
  StartsFrom(const StartsFrom&) = delete;
  StartsFrom& operator=(const StartsFrom&) = delete;

 private:
  bool has_before_;
  std::string before_;
};

}  // namespace

Result<void> KeptPeer::start(const PeerStart& start, Nanoseconds now) {
  const std::uint32_t incarnation = last_.incarnation + 1;
  const auto refuse = [&](const Error& why) {
    last_.incarnation = incarnation;
    note_end({.by_signal = false, .code = 127}, now);
    return why;
  };
  auto ends = Channel::pair();
  if (!ends) return refuse(ends.error());
  const std::string numbers[] = {std::to_string(last_.index), std::to_string(incarnation),
                                 std::to_string(own_process_id())};
  const std::string line = std::to_string(kRtpuGuardDescriptor);
  std::vector<const char*> words = {start.program.c_str(), "--peer",   numbers[0].c_str(), "--incarnation",
                                    numbers[1].c_str(),    "--parent", numbers[2].c_str()};
  if (start.has_guard) words.insert(words.end(), {"--guard", line.c_str()});
  std::vector<int> passed = {ends->second.descriptor()};
  passed.insert(passed.end(), start.passed.begin(), start.passed.end());
  origin_ = start.origin_prefix + numbers[0] + "." + numbers[1];
  const StartsFrom origin(origin_);
  auto process = Process::start(start.program.c_str(), words, passed);
  if (!process) return refuse(process.error());
  process_ = *std::move(process);
  channel_ = std::move(ends->first);
  last_ = {.kind = Kind::kStarted, .index = last_.index, .incarnation = incarnation, .pid = process_.pid(), .at = now};
  return {};
}

void KeptPeer::send(const KeeperMessage& message, int passed) const {
  if (channel_.is_open() && !channel_.send(bytes_of(message), passed) && errno == EAGAIN) process_.signal(SIGKILL);
}

void KeptPeer::pass_segment_to(const KeptPeer& other) const {
  if (segment_.fd < 0) return;
  other.send({.kind = Kind::kPeer, .index = last_.index, .incarnation = segment_incarnation_}, segment_.fd);
}

KeptPeer::Said KeptPeer::receive(KeeperMessage& message) {
  int passed = -1;
  const Channel::Got got = channel_.is_open() ? channel_.receive(bytes_of(message), passed) : Channel::Got::kNothing;
  if (got == Channel::Got::kClosed) channel_ = Channel();
  if (got != Channel::Got::kMessage) return Said::kNothing;
  OwnedDescriptor segment(passed);
  if (message.kind != Kind::kSegment || segment.fd < 0) return Said::kMessage;
  segment_ = std::move(segment);
  segment_incarnation_ = last_.incarnation;
  return Said::kSegment;
}

void KeptPeer::note_end(const ProcessEnd& how, Nanoseconds now) {
  channel_ = Channel();
  last_ = {.kind = Kind::kEnded,
           .index = last_.index,
           .incarnation = last_.incarnation,
           .code = how.code,
           .by_signal = how.by_signal,
           .core_dumped = how.core_dumped,
           .at = now};
}

void KeptPeer::wait(Nanoseconds limit) {
  ProcessEnd how;
  process_.wait(how, std::max(limit, Nanoseconds{0}).count);
}

}  // namespace chimera
