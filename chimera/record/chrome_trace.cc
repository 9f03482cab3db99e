// SPDX-License-Identifier: Apache-2.0
// Writes rows of the tap as events of the Chrome trace format.
#include "chimera/record/chrome_trace.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/task/signal.h"
#include "chimera/task/state_machine.h"

namespace chimera {
namespace {

constexpr Nanoseconds kHeldBack = seconds(2);
constexpr std::uint32_t kFirst = 1;  // of rtpus and tasks: viewers take process 0 and thread 0 for those of an idle CPU

std::string argument(const char* name, std::int64_t value) {
  return ", \"" + std::string(name) + "\": " + std::to_string(value);
}

std::string release_of(const TapRecord& record) {
  return argument("cycle", record.a) + (record.b > 0 ? argument("deadline_ns", record.b) : "");
}

const char* method_of(const TapRecord& record) {
  return record.a < CHIMERA_METHODS ? method_name(static_cast<Method>(record.a)) : "?";
}

std::string signal_of(const TapRecord& record) {
  return std::string("signal ") + (record.a < CHIMERA_SIGNALS ? signal_name(static_cast<Signal>(record.a)) : "?");
}

std::string state_of(const TapRecord& record) {
  return std::string("state ") + (record.a < std::uint32_t{kStates} ? state_name(static_cast<State>(record.a)) : "?");
}

}  // namespace

std::string microseconds_text(Nanoseconds t) {
  const bool negative = t.count < 0;
  const std::uint64_t n = negative ? -static_cast<std::uint64_t>(t.count) : static_cast<std::uint64_t>(t.count);
  char text[40];
  std::snprintf(text, sizeof text, "%s%llu.%03llu", negative ? "-" : "", static_cast<unsigned long long>(n / 1000),
                static_cast<unsigned long long>(n % 1000));
  return text;
}

ChromeTrace::ChromeTrace(std::FILE* file, std::string subsystem, std::span<const std::string> rtpus,
                         std::span<const std::string> tasks, Nanoseconds origin)
    : file_(file), subsystem_(std::move(subsystem)), origin_(origin) {
  std::fputs("{\"traceEvents\": [\n", file_);
  for (std::size_t r = 0; r < rtpus.size(); ++r) {
    metadata("process_name", kFirst + r, 0, rtpus[r]);
    for (std::size_t t = 0; t < tasks.size(); ++t) metadata("thread_name", kFirst + r, kFirst + t, tasks[t]);
  }
}

void ChromeTrace::metadata(const char* what, std::size_t pid, std::size_t tid, const std::string& name) {
  std::fprintf(file_, "%s{\"ph\": \"M\", \"name\": \"%s\", \"pid\": %zu, \"tid\": %zu, \"args\": {\"name\": %s}}",
               is_first_ ? "" : ",\n", what, pid, tid, backslashed(name).c_str());
  is_first_ = false;
}

void ChromeTrace::event(const TapRecord& record, const char* phase, const std::string& name, const std::string& more) {
  const bool is_of_task = record.task.is_valid();
  const std::uint32_t pid = kFirst + record.rtpu, tid = is_of_task ? kFirst + record.task.index : 0;
  const Nanoseconds at = record.at - origin_;
  const bool is_slice = *phase == 'X';
  // An event of no single task (the flag) spans the whole rtpu; the viewers then ignore its tid.
  const char* scope = is_of_task ? ", \"s\": \"t\"" : ", \"s\": \"p\"";
  const std::string shape = is_slice ? ", \"dur\": " + microseconds_text(Nanoseconds{record.b}) : scope;
  constexpr const char* kEvent =
      "%s{\"ph\": \"%s\", \"name\": %s, \"pid\": %u, \"tid\": %u, \"ts\": %s%s, \"args\": {\"ns\": %lld%s}}";
  std::fprintf(file_, kEvent,
               is_first_ ? "" : ",\n", phase, backslashed(name).c_str(), pid, tid,
               microseconds_text(at).c_str(), shape.c_str(), static_cast<long long>(at.count), more.c_str());
  is_first_ = false;
}

void ChromeTrace::write(const TapRecord& record) {
  switch (record.kind) {
    case TapKind::kRelease: return event(record, "i", "release", release_of(record));
    case TapKind::kRun: return event(record, "X", method_of(record), argument("dur_ns", record.b));
    case TapKind::kPreempt: return event(record, "i", "preempt", "");
    case TapKind::kMiss: return event(record, "i", "miss", argument("late_ns", record.b));
    case TapKind::kDrop: return event(record, "i", "drop", argument("releases", record.a));
    case TapKind::kSignal: return event(record, "i", signal_of(record), argument("accepted", record.b));
    case TapKind::kFault: return event(record, "i", std::string("fault in ") + method_of(record), "");
    case TapKind::kState: return event(record, "i", state_of(record), "");
    case TapKind::kFlag: return event(record, "i", record.a != 0 ? "flag up" : "flag down", "");
    case TapKind::kOverrun: return event(record, "i", "overrun", argument("used_ns", record.b));
    case TapKind::kHang: return event(record, "i", "hang", argument("used_ns", record.b));
    case TapKind::kGroup:
    case TapKind::kValue: return;  // what was published is no event of time
  }
}

void ChromeTrace::hold(const TapRecord& record, Nanoseconds at, bool is_deadline) {
  held_.push_back({at, n_held_++, record, is_deadline});
  std::push_heap(held_.begin(), held_.end(), comes_later);
}

void ChromeTrace::write_until(Nanoseconds instant) {
  while (!held_.empty() && held_.front().at <= instant) {
    std::pop_heap(held_.begin(), held_.end(), comes_later);
    Held next = held_.back();
    held_.pop_back();
    next.record.at = next.at;
    if (next.is_deadline) event(next.record, "i", "deadline", argument("cycle", next.record.a));
    else write(next.record);
  }
}

void ChromeTrace::add(std::span<const TapRecord> records) {
  for (const TapRecord& record : records) {
    if (record.kind == TapKind::kGroup || record.kind == TapKind::kValue) continue;
    hold(record, record.at, false);
    if (record.kind == TapKind::kRelease && record.b > 0) hold(record, record.at + Nanoseconds{record.b}, true);
    write_until(record.at - kHeldBack);
  }
}

bool ChromeTrace::end(std::uint64_t lost, std::uint64_t missed) {
  write_until(kNever);
  std::fprintf(file_,
               "\n], \"displayTimeUnit\": \"ns\", \"otherData\": {\"subsystem\": %s, \"lost_records\": %llu, "
               "\"missed_records\": %llu}}\n",
               backslashed(subsystem_).c_str(), static_cast<unsigned long long>(lost),
               static_cast<unsigned long long>(missed));
  return std::fflush(file_) == 0 && std::ferror(file_) == 0;
}

}  // namespace chimera
