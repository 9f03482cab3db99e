// SPDX-License-Identifier: Apache-2.0
// Writes the trace file and the timelines of a run from the records of the tap.
#include "apps/chimera/record_files.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "chimera/draw/timeline.h"
#include "chimera/record/chrome_trace.h"

using chimera::Nanoseconds;

struct RecordFiles::Trace {
  std::FILE* file = nullptr;
  std::unique_ptr<chimera::ChromeTrace> writer;
};

RecordFiles::RecordFiles(const std::string& trace, Nanoseconds unit, Nanoseconds duration)
    : unit_(unit), duration_(duration) {
  if (trace.empty()) return;
  trace_ = std::make_unique<Trace>();
  trace_->file = std::fopen(trace.c_str(), "w");
  if (trace_->file == nullptr) why_ = std::strerror(errno);
}

RecordFiles::~RecordFiles() {
  if (trace_ != nullptr && trace_->file != nullptr) std::fclose(trace_->file);
}

void RecordFiles::begin(const chimera::ApplicationSpec& spec, Nanoseconds origin, Nanoseconds start) {
  start_ = start;
  for (const chimera::TaskSpec& task : spec.tasks) names_.emplace_back(task.name);
  for (const chimera::RtpuSpec& rtpu : spec.rtpus) rtpus_.emplace_back(rtpu.name);
  if (trace_ != nullptr)
    trace_->writer =
        std::make_unique<chimera::ChromeTrace>(trace_->file, std::string(spec.name), rtpus_, names_, origin);
}

void RecordFiles::on_records(std::span<const chimera::TapRecord> records) {
  if (trace_ != nullptr) trace_->writer->add(records);
  if (unit_.count == 0) return;
  for (const chimera::TapRecord& record : records) {
    if (record.kind == chimera::TapKind::kRun) kept_.push_back(record);
    if (record.kind == chimera::TapKind::kRelease) first_release_ = std::min(first_release_, record.at);
  }
}

void RecordFiles::end(std::uint64_t lost, std::uint64_t missed) {
  lost_ = lost;
  missed_ = missed;
  if (trace_ != nullptr && !trace_->writer->end(lost, missed)) write_error_ = errno;
}

// One for each rtpu: each has a processor of its own.
void RecordFiles::print_timelines(std::FILE* out) const {
  const Nanoseconds first = std::min(start_, first_release_), start = first == chimera::kNever ? Nanoseconds{} : first;
  for (std::size_t rtpu = 0; rtpu < rtpus_.size(); ++rtpu) {
    std::vector<chimera::TapRecord> mine;
    for (const chimera::TapRecord& record : kept_)
      if (record.rtpu == rtpu) mine.push_back(record);
    if (rtpus_.size() > 1) std::fprintf(out, "%s:\n", rtpus_[rtpu].c_str());
    std::fputs(chimera::draw::text(chimera::draw::timeline(mine, names_, start, unit_, duration_)).c_str(), out);
  }
}

bool RecordFiles::finish(std::FILE* out, std::FILE* err) {
  bool good = lost_ == 0;
  if (!good)
    std::fprintf(err, "%llu records were lost: the trace has a gap\n", static_cast<unsigned long long>(lost_));
  if (missed_ > 0)
    std::fprintf(err,
                 "the first %llu records were overwritten before they could be read: the trace begins after them\n",
                 static_cast<unsigned long long>(missed_));
  if (unit_.count > 0) print_timelines(out);
  if (trace_ != nullptr) {
    if (std::fclose(trace_->file) != 0 && write_error_ == 0) write_error_ = errno;
    trace_->file = nullptr;
    if (write_error_ != 0)
      std::fprintf(err, "the trace could not be written whole: %s\n", std::strerror(write_error_));
    good = good && write_error_ == 0;
  }
  return good;
}
