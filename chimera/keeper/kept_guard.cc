// SPDX-License-Identifier: Apache-2.0
// Starts the guard, introduces rtpus to it, and passes its news on to the manager.
#include "chimera/keeper/kept_guard.h"

#include <cerrno>
#include <csignal>

#include "chimera/platform/descriptor.h"
#include "chimera/platform/process_state.h"

namespace chimera {

Result<void> KeptGuard::start(const std::string& program, std::span<const std::string> limits, int image,
                              KeeperPages& pages) {
  auto ends = Channel::pair();
  if (!ends) return ends.error();
  const std::string parent = std::to_string(own_process_id());
  std::vector<const char*> words = {program.c_str(), "--parent", parent.c_str()};
  for (const std::string& limit : limits) words.insert(words.end(), {"--silent", limit.c_str()});
  const int passed[] = {ends->second.descriptor(), image, pages.decision_descriptor()};
  auto process = Process::start(program.c_str(), words, passed);
  if (!process) return process.error();
  process_ = *std::move(process);
  channel_ = std::move(ends->first);
  pages_ = &pages;
  pages.show_guard(pid(), GuardState::kWell);
  return {};
}

Channel KeptGuard::make_line(std::uint32_t index, std::uint32_t incarnation) {
  if (!lives()) return {};
  auto ends = Channel::pair();
  if (!ends) {
    pages_->show_unguarded(index, incarnation, errno);
    return {};
  }
  new_line_ = std::move(ends->first);
  return std::move(ends->second);
}

void KeptGuard::watch(std::uint32_t index, std::uint32_t incarnation, int pidfd) {
  if (!new_line_.is_open()) return;
  const auto kRtpu = GuardMessage::Kind::kRtpu, kLine = GuardMessage::Kind::kLine;
  send({.kind = kRtpu, .index = index, .incarnation = incarnation}, pidfd);
  send({.kind = kLine, .index = index, .incarnation = incarnation}, new_line_.descriptor());
  new_line_ = Channel();
}

// Kills a guard that accepts no messages: it would not know the rtpu and would write nothing for it.
void KeptGuard::send(const GuardMessage& message, int passed) const {
  if (channel_.is_open() && !channel_.send(bytes_of(message), passed)) process_.signal(SIGKILL);
}

void KeptGuard::poll(std::vector<KeeperMessage>& news) {
  GuardMessage said;
  int passed = -1;
  while (channel_.is_open() && channel_.receive(bytes_of(said), passed) == Channel::Got::kMessage) {
    const OwnedDescriptor unwanted(passed);
    KeeperMessage message{.index = said.index, .incarnation = said.incarnation};
    if (said.kind == GuardMessage::Kind::kReady && said.good == 0) {
      pages_->show_guard(pid(), GuardState::kLate);
    } else if (said.kind == GuardMessage::Kind::kUnguarded) {
      pages_->show_unguarded(said.index, said.incarnation, static_cast<int>(said.bad));
    } else if (said.kind == GuardMessage::Kind::kWritten) {
      message.kind = KeeperMessage::Kind::kFramesWritten;
      message.code = static_cast<std::int32_t>(said.good);
      message.letter = said.bad;
      message.late = said.late;
      message.at = said.at;
      message.silent = said.died;
      news.push_back(message);
    } else if (said.kind == GuardMessage::Kind::kSilent) {
      message.kind = KeeperMessage::Kind::kSilent;
      message.code = static_cast<std::int32_t>(said.task);
      message.letter = said.good;
      news.push_back(message);
    }
  }
  ProcessEnd how;
  if (!process_.is_held() || !process_.has_ended(how)) return;
  channel_ = Channel();
  pages_->show_guard(0, GuardState::kDead);
}

void KeptGuard::end(Nanoseconds limit) {
  channel_ = Channel();
  ProcessEnd how;
  if (!process_.is_held() || process_.wait(how, limit.count)) return;
  process_.signal(SIGKILL);
  process_.wait(how, limit.count);
}

}  // namespace chimera
