// SPDX-License-Identifier: Apache-2.0
// Switches the terminal to single keys and the alternate screen, and waits for keys, signals and notifications.
#include "chimera/cli/live/terminal.h"

#include <algorithm>
#include <csignal>
#include <string_view>
#include <utility>

#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"

namespace chimera::cli {

FullScreen::FullScreen() { write_out("\x1b[?1049h\x1b[?25l\x1b[2J"); }

FullScreen::~FullScreen() { write_out("\x1b[0m\x1b[?25h\x1b[?1049l"); }

void FullScreen::show(const std::string& text) { write_out("\x1b[H" + text + "\x1b[0m\x1b[J"); }

InputWait::InputWait(bool keys) : keys_(keys) {
  constexpr int kTaken[] = {SIGINT, SIGTERM, SIGHUP, SIGWINCH};
  auto signals = SignalQueue::open(kTaken);
  if (signals) signals_ = *std::move(signals);
}

InputWait::~InputWait() {
  // A pending signal would act as soon as it is unblocked. The command has obeyed it by ending.
  while (read_signal()) {}
}

std::optional<Wakeup> InputWait::read_signal() {
  SignalQueue::Arrived signal;
  if (!signals_.take(signal)) return std::nullopt;
  Wakeup woken;
  woken.by = signal.number == SIGWINCH ? Wakeup::By::kResize : Wakeup::By::kStop;
  return woken;
}

Wakeup InputWait::read_key() {
  constexpr std::pair<std::string_view, int> kArrows[] = {{"\x1b[A", kKeyUp},      {"\x1bOA", kKeyUp},
                                                          {"\x1b[B", kKeyDown},    {"\x1bOB", kKeyDown},
                                                          {"\x1b[5~", kKeyPageUp}, {"\x1b[6~", kKeyPageDown}};
  Wakeup woken;
  woken.by = Wakeup::By::kKey;
  woken.key = typed_.empty() ? kKeyEnd : static_cast<unsigned char>(typed_[0]);
  std::size_t length = std::min<std::size_t>(typed_.size(), 1);
  for (const auto& [sequence, key] : kArrows)
    if (typed_.starts_with(sequence)) woken.key = key, length = sequence.size();
  typed_.erase(0, length);
  return woken;
}

Wakeup InputWait::wait(control::Client* client, Nanoseconds limit) {
  LinuxClock clock;
  const Nanoseconds until = clock.now() + limit;
  for (;;) {
    if (auto woken = read_signal()) return std::move(*woken);
    if (!typed_.empty()) return read_key();
    Wakeup woken;
    if (client != nullptr) {
      auto note = client->next(Nanoseconds{0});
      if (!note) return woken.by = Wakeup::By::kLost, woken.error = note.error(), woken;
      if (note.value()) return woken.by = Wakeup::By::kNote, woken.note = std::move(*note.value()), woken;
    }
    Watched all[] = {{signals_.descriptor()}, {client == nullptr ? -1 : client->descriptor()},
                     {keys_ ? kStandardInput : -1}};
    const int n = await_ready(all, std::min(until - clock.now(), seconds(60)));
    if (n > 0 && all[2].is_ready) {
      keys_ = read_keys(typed_);
      return read_key();
    }
    if (n == 0 && clock.now() >= until) return woken;
  }
}

}  // namespace chimera::cli
