// SPDX-License-Identifier: Apache-2.0
#include "chimera/record/chrome_trace.h"

#include "chimera/task/signal.h"

namespace chimera {
namespace {

/// Text inside a JSON string.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", byte);
      out += code;
    } else {
      out += c;
    }
  }
  return out;
}

/// Microseconds with every nanosecond: -1500 ns is "-1.500".
std::string micros(std::int64_t ns) {
  const bool negative = ns < 0;
  const std::uint64_t size = negative ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  char text[40];
  std::snprintf(text, sizeof text, "%s%llu.%03llu", negative ? "-" : "", static_cast<unsigned long long>(size / 1000),
                static_cast<unsigned long long>(size % 1000));
  return text;
}

std::string field(const char* key, std::int64_t value) {
  return std::string(",\"") + key + "\":" + std::to_string(value);
}

std::string method_text(std::uint32_t method) {
  return method < CHIMERA_METHODS ? method_name(static_cast<Method>(method)) : "method " + std::to_string(method);
}

std::string signal_text(std::uint32_t signal) {
  return signal < CHIMERA_SIGNALS ? signal_name(static_cast<Signal>(signal)) : "signal " + std::to_string(signal);
}

/// What an event is called, and its own arguments.
struct Shown {
  std::string name;
  std::string category;
  std::string args;
};

Shown shown(const TapRecord& r) {
  switch (r.kind) {
    case TapKind::kRelease: return {"release", "schedule", field("cycle", r.a)};
    case TapKind::kRun: return {method_text(r.a), "run", field("dur_ns", r.b)};
    case TapKind::kPreempt: return {"preempt", "schedule", ""};
    case TapKind::kMiss: return {"miss", "failure", field("late_ns", r.b)};
    case TapKind::kDrop: return {"drop", "failure", field("releases", r.a)};
    case TapKind::kSignal:
      return {"signal " + signal_text(r.a), "signal", std::string(",\"accepted\":") + (r.b != 0 ? "true" : "false")};
    case TapKind::kFault: return {"fault in " + method_text(r.a), "failure", ""};
    case TapKind::kState: return {"state", "signal", field("state", r.a)};
    case TapKind::kFlag: return {r.a != 0 ? "flag raised" : "flag lowered", "flag", ""};
  }
  return {"record " + std::to_string(static_cast<unsigned>(r.kind)), "other", ""};
}

}  // namespace

ChromeTrace::ChromeTrace(std::FILE* out, std::span<const std::string> rtpus, std::span<const TraceTask> tasks,
                         Nanoseconds origin)
    : out_(out), tasks_(tasks.begin(), tasks.end()), origin_(origin) {
  failed_ = std::fputs("{\"displayTimeUnit\":\"ns\",\"traceEvents\":[", out_) < 0;
  for (std::size_t i = 0; i < rtpus.size(); ++i) {
    event("{\"ph\":\"M\",\"name\":\"process_name\",\"pid\":" + std::to_string(i) + ",\"tid\":0,\"args\":{\"name\":\"" +
          escaped(rtpus[i]) + "\"}}");
  }
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    event("{\"ph\":\"M\",\"name\":\"thread_name\",\"pid\":" + std::to_string(tasks_[i].rtpu) + ",\"tid\":" +
          std::to_string(i + 1) + ",\"args\":{\"name\":\"" + escaped(tasks_[i].name) + "\"}}");
  }
}

void ChromeTrace::event(const std::string& body) {
  failed_ = std::fprintf(out_, "%s\n%s", is_first_ ? "" : ",", body.c_str()) < 0 || failed_;
  is_first_ = false;
}

void ChromeTrace::write(std::span<const TapRecord> records) {
  for (const TapRecord& record : records) write_record(record);
}

void ChromeTrace::write_record(const TapRecord& record) {
  const Shown what = shown(record);
  const bool is_slice = record.kind == TapKind::kRun;
  const bool has_task = record.task.is_valid();
  std::string body = "{\"ph\":\"" + std::string(is_slice ? "X" : "i") + "\",\"name\":\"" + what.name + "\",\"cat\":\"" +
                     what.category + "\",\"pid\":" + std::to_string(record.rtpu) + ",\"tid\":" +
                     std::to_string(has_task ? std::uint64_t{record.task.index} + 1 : 0);
  const std::int64_t at = (record.at - origin_).count;
  body += ",\"ts\":" + micros(at);
  body += is_slice ? ",\"dur\":" + micros(record.b) : std::string(",\"s\":\"") + (has_task ? "t" : "p") + "\"";
  event(body + ",\"args\":{\"ts_ns\":" + std::to_string(at) + what.args + "}}");
}

bool ChromeTrace::close(std::uint64_t dropped) {
  const std::string end = "\n],\"otherData\":{\"dropped\":" + std::to_string(dropped) + "}}\n";
  failed_ = std::fputs(end.c_str(), out_) < 0 || std::fflush(out_) != 0 || failed_;
  return !failed_;
}

}  // namespace chimera
