// SPDX-License-Identifier: Apache-2.0
// Judges whether the time stamp counter of this machine is sound, and measures its rate against CLOCK_MONOTONIC.
#include "chimera/platform/cycle_counter.h"

#include <ctime>
#include <string_view>

#include "chimera/base/message.h"
#include "chimera/platform/file.h"

namespace chimera {
namespace {

Nanoseconds monotonic() noexcept {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return {t.tv_sec * 1'000'000'000 + t.tv_nsec};
}

#if defined(__x86_64__)

bool has_flag(std::string_view cpuinfo, std::string_view flag) noexcept {
  const std::size_t flags = cpuinfo.find("\nflags");
  if (flags == std::string_view::npos) return false;
  const std::string_view line = cpuinfo.substr(flags + 1, cpuinfo.find('\n', flags + 1) - flags - 1);
  for (std::size_t at = line.find(flag); at != std::string_view::npos; at = line.find(flag, at + 1)) {
    const std::size_t end = at + flag.size();
    if (line[at - 1] == ' ' && (end == line.size() || line[end] == ' ')) return true;
  }
  return false;
}

// The reason not to use the counter; empty if the counter is sound.
Message objection() noexcept {
  const FileStart source("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  std::string_view name = source.view();
  if (name.ends_with('\n')) name.remove_suffix(1);
  if (name != "tsc" && name != "kvm-clock")
    return Message() << "clock source is " << (name.empty() ? "unknown" : name) << ", not tsc";
  const FileStart cpuinfo("/proc/cpuinfo");
  for (const char* flag : {"constant_tsc", "nonstop_tsc", "rdtscp"})
    if (!has_flag(cpuinfo.view(), flag)) return Message() << "processor lacks " << flag;
  return {};
}

struct CounterReading {
  std::uint64_t ticks = 0;
  Nanoseconds at;
};

// Reads counter and clock together, at most `tries` times, and keeps the try with the fewest ticks between its two
// counter reads; stops early when these are `close_enough`. A preemption between the reads would make the result wrong
// by half of its length.
CounterReading read_both(int tries, std::uint64_t close_enough) noexcept {
  CounterReading best;
  std::uint64_t least = UINT64_MAX;
  for (int i = 0; i < tries && least > close_enough; ++i) {
    unsigned cpu;
    const std::uint64_t before = __rdtscp(&cpu);
    const Nanoseconds at = monotonic();
    const std::uint64_t after = __rdtscp(&cpu);
    if (after - before >= least) continue;
    least = after - before;
    best = {before + least / 2, at};
  }
  return best;
}

#endif

}  // namespace

Nanoseconds CycleCounter::read_clock() noexcept { return monotonic(); }

CycleCounter CycleCounter::calibrate() noexcept {
#if defined(__x86_64__)
  const Message why_not = objection();
  if (why_not.empty()) {
    const CounterReading first = read_both(20, 0);
    const timespec span{0, 10'000'000};
    ::clock_nanosleep(CLOCK_MONOTONIC, 0, &span, nullptr);
    const CounterReading last = read_both(20, 0);
    const std::uint64_t ticks = last.ticks - first.ticks;
    const auto ns = static_cast<std::uint64_t>((last.at - first.at).count);
    __extension__ using Wide = unsigned __int128;
    const auto rate = static_cast<std::uint64_t>((static_cast<Wide>(ns) << 32) / ticks);
    const Message text = Message() << "cycle counter at " << (ticks * 1000 + ns / 2) / ns << " MHz";
    return CycleCounter(Source::kCycleCounter, TickScale(last.ticks, last.at, rate), FixedString<120>(text.view()));
  }
  const Message text = Message() << "clock_gettime (" << why_not.view() << ")";
#else
  const Message text = Message() << "clock_gettime (no cycle counter known for this processor)";
#endif
  return CycleCounter(Source::kClockGettime, TickScale(0, {}, 0), FixedString<120>(text.view()));
}

void CycleCounter::compare() noexcept {
#if defined(__x86_64__)
  if (source_ != Source::kCycleCounter) return;
  const CounterReading both = read_both(4, 2000);
  scale_.compare(both.ticks, both.at);
#endif
}

}  // namespace chimera
