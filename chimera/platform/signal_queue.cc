// SPDX-License-Identifier: Apache-2.0
// Blocks signals and reads them through a signalfd.
#include "chimera/platform/signal_queue.h"

#include <pthread.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "chimera/platform/descriptor.h"

namespace chimera {

struct SignalQueue::Content {
  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    if (is_restored) ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  OwnedDescriptor file;
  sigset_t before{};
  bool is_restored = true;
};

SignalQueue::SignalQueue() noexcept = default;
SignalQueue::SignalQueue(SignalQueue&&) noexcept = default;
SignalQueue& SignalQueue::operator=(SignalQueue&&) noexcept = default;
SignalQueue::~SignalQueue() = default;

Result<SignalQueue> SignalQueue::open(std::span<const int> numbers, std::span<const int> ignored) noexcept {
  sigset_t taken, blocked;
  ::sigemptyset(&taken);
  for (const int number : numbers) ::sigaddset(&taken, number);
  blocked = taken;
  for (const int number : ignored) ::sigaddset(&blocked, number);
  SignalQueue queue;
  queue.content_ = std::make_unique<Content>();
  ::pthread_sigmask(SIG_BLOCK, &blocked, &queue.content_->before);
  queue.content_->file = OwnedDescriptor(::signalfd(-1, &taken, SFD_CLOEXEC | SFD_NONBLOCK));
  if (queue.content_->file.fd < 0) return system_error(Message("signals"), "signalfd");
  return queue;
}

void SignalQueue::stay_blocked() noexcept {
  if (content_ != nullptr) content_->is_restored = false;
}

bool SignalQueue::take(Arrived& arrived) noexcept {
  signalfd_siginfo taken;
  if (content_ == nullptr || ::read(content_->file.fd, &taken, sizeof taken) != sizeof taken) return false;
  arrived = {static_cast<int>(taken.ssi_signo), static_cast<pid_t>(taken.ssi_pid)};
  return true;
}

int SignalQueue::descriptor() const noexcept { return content_ == nullptr ? -1 : content_->file.fd; }

}  // namespace chimera
