// SPDX-License-Identifier: Apache-2.0
// Makes the parts of the image in the memory that is left, and prints their results.
#include "firmware/application.h"

#include <array>

#include "chimera/runtime/executive/baked.h"
#include "chimera/runtime/life/refusal_words.h"
#include "firmware/boards/board.h"
#include "firmware/boot/kept.h"
#include "firmware/boot/stacks.h"
#include "firmware/boot/stop.h"
#include "firmware/link_on_uart.h"
#include "firmware/serial_text.h"
#include "firmware/shell/shell_rows.h"

namespace chimera::firmware {
namespace {

const char* end_word(RunEnd end) {
  switch (end) {
    case RunEnd::kTime: return "time";
    case RunEnd::kStopped: return "stopped";
    case RunEnd::kNothingLeft: return "nothing-left";
    case RunEnd::kTaskStopped: return "task-stopped";
  }
  return "unknown";
}

void print_boot(const Boot& boot) {
  TextLine line;
  put_boot(line, boot, baked::kSpec.tasks);
  send_line(Message(line.view()));
}

void print_tasks(const TaskSet& set) {
  for (const Task& task : set.tasks()) {
    const Profile& profile = task.profile;
    Message line;
    line << "task " << task.spec->name << " cycles " << profile.cycles << " missed " << profile.missed << " dropped "
         << profile.dropped << " faults " << task.faults.count << " response "
         << (profile.cycles == 0 ? 0 : profile.response.max.count);
    if (mechanisms::kInterrupts && task.spec->has_events)
      line << " events " << profile.events << " lost " << profile.events_lost;
    send_line(line);
    const Spread &cycle = profile.execution[CHIMERA_CYCLE], &delay = profile.start_delay;
    if (cycle.count == 0) continue;
    send_line(Message() << "profile " << task.spec->name << " samples " << cycle.count << " worst " << cycle.max.count
                        << " mean " << cycle.mean().count << " response "
                        << (profile.cycles == 0 ? 0 : profile.response.max.count) << " jitter "
                        << (delay.count == 0 ? 0 : (delay.max - delay.min).count));
  }
}

std::size_t used_of(const Stack& stack) noexcept {
  StackScan scan(stack);
  (void)scan.go_on(stack.words.size());
  return scan.used_bytes();
}

void print_stacks() {
  const Stack program = program_stack(), handlers = handler_stack();
  send_line(Message() << "stack " << used_of(program) << " of " << program.words.size_bytes() << " handlers "
                      << used_of(handlers) << " of " << handlers.words.size_bytes());
}

/// Bytes that arrive or leave end no wait of setup.
void wait_for(Clock& clock, Nanoseconds instant) {
  while (clock.wait_until(instant) == WaitEnd::kWoken) {
  }
}

int refused(std::string_view words) {
  send_line(Message("refused ") << words);
  send_line(Message("end refused"));
  return 1;
}

}  // namespace

int Image::run() {
  print_boot(boot_);
  if constexpr (mechanisms::kWatchdog)
    board_watchdog().begin(baked::kTarget.clock_hz, baked::kTarget.watchdog, baked::kRun.tick);
  ContextPlace place;
  place.running = &job_word;
  place.at_edge = &boundary_word;
  set_ = &make<TaskSet>(baked::kSpec, place, memory_);
  if (const Result<void> built = set_->build(baked::kComponents); !built) return refused(built.error().message.view());
  make_executive();
  if (!boot_.starts_off && !start()) return 1;
  send_line(Message() << "memory setup " << memory_.used() << " of " << memory_bytes_);
  method_clock_->end_setup();
  clock_->serve(served_);
  // The grid of releases begins at a tick, so that every release is at a tick.
  bare::BareClock& clock = board_clock();
  wait_for(clock, clock.last_tick() + clock.tick());
  if constexpr (mechanisms::kSwitch) receipts_->begin(clock.last_tick());
  executive_->start(clock.last_tick());
  is_in_setup = false;
  const RunEnd why = executive_->run(boot_.starts_off ? kNever : baked::kRun.duration);
  executive_->releases().end(clock.now());
  return end(why);
}

void Image::stop_ram_too_small(std::size_t bytes) noexcept {
  stop(ResetCause::kAssertion, 0,
       (Message("setup needs more than the ") << bytes << " bytes of RAM behind the stacks").view());
}

void Image::make_executive() {
  clock_ = &make<IdleClock>(board_clock());
  method_clock_ = &make<MethodClock>();
  RunOptions options;
  options.policy = baked::kRun.policy;
  options.script = Script(baked::kRun.acts);
  options.tick = baked::kRun.tick;
  if constexpr (mechanisms::kDigest) {
    digest_ = &make<Digest>(baked::kSpec.tasks.size(), make<DigestLinesOut>(baked::kSpec), memory_);
    options.digest = digest_;
  }
  if constexpr (mechanisms::kInterrupts)
    options.events = event_interrupts = &make<EventInterrupts>(baked::kTarget.events, memory_);
  if constexpr (mechanisms::kSwitch) options.receipts = receipts_ = &make<ReceiptLinesOut>(baked::kSpec);
  if constexpr (mechanisms::kShell) options.guest = served_.listener = &make<ShellListener>(*set_, memory_);
  LinkOnUart* link = nullptr;
  if constexpr (mechanisms::kLink)
    options.guest = link = &make<LinkOnUart>(
        *set_, HostLink::Times{baked::kRun.link_period, baked::kRun.link_stale_after, baked::kRun.tick}, memory_);
  executive_ = &make<Executive>(*set_, *clock_, *method_clock_, options);
  static std::array<Stack, 2> stacks;
  stacks = {program_stack(), handler_stack()};
  if constexpr (mechanisms::kWatchdog)
    served_.watchdog = &make<Watchdog>(make<Vitals>(set_->tasks(), stacks, memory_), board_watchdog(), reset_record());
  if constexpr (mechanisms::kShell) {
    served_.shell = &make<Shell>(ShellParts{*set_, executive_->releases(), *served_.listener, stacks, served_.watchdog,
                                            &boot_});
    uart().attach(*served_.shell);
  }
  if constexpr (mechanisms::kLink) uart().attach(*link);
}

bool Image::start() {
  bare::BareClock& clock = board_clock();
  const auto wait = [this, &clock](Nanoseconds at) {
    wait_for(clock, at);
    return method_clock_->now();
  };
  const SignalReport started = set_->life().start(clock.now(), wait);
  if (started) return true;
  Message text;
  put_refusal(*set_, started, [&text](std::string_view piece) { text << piece; });
  refused(text.view());
  return false;
}

int Image::end(RunEnd end) {
  if constexpr (mechanisms::kDigest) digest_->end();
  print_tasks(*set_);
  print_stacks();
  if (mechanisms::kSerial && uart().lost_out() != 0) send_line(Message() << "lost " << uart().lost_out());
  send_line(Message() << "end " << end_word(end));
  return 0;
}

}  // namespace chimera::firmware
