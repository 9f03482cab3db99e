// SPDX-License-Identifier: Apache-2.0
// Runs the baked application on the chip. Its lines on the serial port: docs/formats/image_output.md.
#include <cstddef>
#include <new>
#include <span>

#include "chimera/base/part_if.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/executive/baked.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/life/refusal_words.h"
#include "firmware/boards/board.h"
#include "firmware/boot/stacks.h"
#include "firmware/boot/stop.h"
#include "firmware/digest_lines.h"
#include "firmware/receipt_lines.h"
#include "firmware/serial_text.h"

extern "C" std::byte image_rest_begin[], image_rest_end[];  // from the linker script: RAM without variables and stacks

namespace chimera::firmware {
namespace {

/// An object that lives as long as the image.
template <class T, class... Arguments>
T& make(SetupMemory& memory, Arguments&&... arguments) {
  return *::new (memory.take_bytes(sizeof(T), alignof(T)).data()) T(static_cast<Arguments&&>(arguments)...);
}

const char* end_word(RunEnd end) {
  switch (end) {
    case RunEnd::kTime: return "time";
    case RunEnd::kStopped: return "stopped";
    case RunEnd::kNothingLeft: return "nothing-left";
    case RunEnd::kTaskStopped: return "task-stopped";
  }
  return "unknown";
}

void print_tasks(const TaskSet& set) {
  for (const Task& task : set.tasks()) {
    const Profile& profile = task.profile;
    send_line(Message() << "task " << task.spec->name << " cycles " << profile.cycles << " missed " << profile.missed
                        << " dropped " << profile.dropped << " faults " << task.faults.count << " response "
                        << (profile.cycles == 0 ? 0 : profile.response.max.count));
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

int refused(TaskSet& set, const SignalReport& report) {
  Message text("refused ");
  put_refusal(set, report, [&text](std::string_view piece) { text << piece; });
  send_line(text);
  send_line(Message("end refused"));
  return 1;
}

int run_application() {
  const std::span<std::byte> rest(image_rest_begin, image_rest_end);
  GivenMemory memory(rest);
  TaskSet& set = make<TaskSet>(memory, baked::kSpec, ContextPlace{}, memory);
  if (const Result<void> built = set.build(baked::kComponents); !built) stop(built.error().message.view());
  bare::BareClock& clock = board_clock();
  auto& job_clock = make<ComputingClock>(memory, clock);
  auto& lines = make<DigestLinesOut>(memory, baked::kSpec);
  RunOptions options;
  options.policy = baked::kRun.policy;
  options.script = Script(baked::kRun.acts);
  options.digest = &make<Digest>(memory, baked::kSpec.tasks.size(), lines, memory);
  auto& receipts = make<PartIf<mechanisms::kSwitch, ReceiptLinesOut>>(memory, baked::kSpec);
  options.receipts = receipts.get();
  auto& executive = make<Executive>(memory, set, clock, job_clock, options);
  const auto wait = [&clock](Nanoseconds at) {
    clock.wait_until(at);
    return clock.now();
  };
  if (const SignalReport started = set.life().start(clock.now(), wait); !started) return refused(set, started);
  send_line(Message() << "memory setup " << memory.used() << " of " << rest.size());
  // The grid of releases begins at a tick, so that every release is at a tick.
  clock.wait_until(clock.last_tick() + clock.tick());
  if constexpr (mechanisms::kSwitch) receipts->begin(clock.last_tick());
  executive.start(clock.last_tick());
  const RunEnd end = executive.run(baked::kRun.duration);
  options.digest->end();
  executive.releases().end(clock.now());
  print_tasks(set);
  print_stacks();
  if (uart().lost_out() != 0) send_line(Message() << "lost " << uart().lost_out());
  send_line(Message() << "end " << end_word(end));
  return 0;
}

}  // namespace
}  // namespace chimera::firmware

int main() {
  chimera::firmware::begin_board();
  return chimera::firmware::run_application();
}
