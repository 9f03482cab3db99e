// SPDX-License-Identifier: Apache-2.0
// Reads memory and scheduling rights of rtpus from the system and logs changes for the worse.
#include "chimera/manager/watch/rtpu_health.h"

#include <charconv>
#include <cstring>
#include <fstream>

#include "chimera/base/hosted/wording.h"
#include "chimera/platform/process_state.h"
#include "chimera/platform/realtime.h"

namespace chimera::manager {
namespace {

constexpr Nanoseconds kEvery = milliseconds(500);
constexpr Nanoseconds kSettled = seconds(1);  // after it came up: its tasks have allocated their memory
constexpr std::uint64_t kMegabyte = 1'000'000, kMuch = 64 * kMegabyte;

std::string folder_of(pid_t pid) { return "/proc/" + std::to_string(pid) + "/"; }

std::uint64_t resident_bytes(pid_t pid) {
  std::uint64_t total = 0, resident = 0;
  std::ifstream(folder_of(pid) + "statm") >> total >> resident;
  return resident * page_bytes();
}

bool has_locked_memory(pid_t pid) {
  std::ifstream status(folder_of(pid) + "status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmLck:")) return std::strtoull(line.c_str() + std::strlen("VmLck:"), nullptr, 10) > 0;
  return true;  // the process has just ended
}

std::string policy_text(int policy, int level) {
  if (policy == kPolicyFifo || policy == kPolicyRoundRobin)
    return (policy == kPolicyFifo ? "SCHED_FIFO " : "SCHED_RR ") + std::to_string(level);
  if (policy == kPolicyOther) return "SCHED_OTHER";
  return "policy " + std::to_string(policy);
}

/// The number after `word` in `report`; `none` if there is none.
int number_behind(std::string_view report, std::string_view word, int none) {
  const std::size_t at = report.find(word);
  if (at == report.npos) return none;
  int value = none;
  const char* begin = report.data() + at + word.size();
  const auto [end, error] = std::from_chars(begin, report.data() + report.size(), value);
  const bool is_refused = std::string_view(end, report.data() + report.size()).starts_with(kRefusedWords);
  return error == std::errc() && !is_refused ? value : none;
}

std::string memory_text(std::uint64_t bytes) { return std::to_string(bytes / kMegabyte) + " MB"; }

bool has_its_level(const GrantedRights& granted, bool preemptive, const ThreadRights& now) {
  if (preemptive) return now.policy == kPolicyOther || (now.policy == kPolicyFifo && now.level <= granted.level);
  return granted.level == 0 ? now.policy == kPolicyOther : now.policy == kPolicyFifo && now.level == granted.level;
}

}  // namespace

GrantedRights GrantedRights::of(std::string_view report) {
  GrantedRights granted;
  granted.level = number_behind(report, kLevelWords, 0);
  granted.cpu = number_behind(report, kPinnedWords, -1);
  granted.is_locked = report.find(kLockedWords) != report.npos;
  return granted;
}

std::string lost_rights(const GrantedRights& granted, bool preemptive, const std::vector<ThreadRights>& threads,
                        bool is_locked) {
  std::string text;
  const auto add = [&text](const std::string& part) { append_joined(text, ", ", part); };
  const std::string due = granted.level > 0 ? policy_text(kPolicyFifo, granted.level) : policy_text(kPolicyOther, 0);
  for (const ThreadRights& now : threads) {
    const std::string who = "thread " + std::to_string(now.thread);
    if (!has_its_level(granted, preemptive, now))
      add(who + " runs at " + policy_text(now.policy, now.level) + " instead of " + due);
    if (granted.cpu >= 0 && now.only_cpu != granted.cpu)
      add(who + " is not bound to CPU " + std::to_string(granted.cpu) + " any more");
  }
  if (granted.is_locked && !is_locked) add("memory is not locked any more");
  return text;
}

void RtpuHealth::look(Nanoseconds now) {
  const bool is_due = now >= due_;
  if (is_due) due_ = now + kEvery;
  for (std::size_t index = 0; index < seen_.size(); ++index) {
    RtpuRecord& rtpu = state_.rtpus[index];
    if (!rtpu.is_alive) rtpu.resident_bytes = 0;
    if (!rtpu.is_alive || !rtpu.is_up) continue;
    if (seen_[index].incarnation != rtpu.incarnation)
      meet(index, now);
    else if (!is_due)
      continue;
    weigh(index, now);
    compare(index, now);
  }
}

void RtpuHealth::meet(std::size_t index, Nanoseconds now) {
  RtpuRecord& rtpu = state_.rtpus[index];
  rtpu.lost_rights.clear();
  seen_[index] = {rtpu.incarnation, {}, now, 0, {}};
  for (const pid_t thread : numbers_in(folder_of(rtpu.pid) + "task")) {
    ThreadRights rights;
    const bool is_special = look_up_rights(thread, rights) && (rights.policy != kPolicyOther || rights.only_cpu >= 0);
    if (is_special) seen_[index].threads.push_back(thread);
  }
}

void RtpuHealth::weigh(std::size_t index, Nanoseconds now) {
  RtpuRecord& rtpu = state_.rtpus[index];
  Seen& seen = seen_[index];
  rtpu.resident_bytes = resident_bytes(rtpu.pid);
  const std::uint64_t bytes = rtpu.resident_bytes;
  const bool is_on = state_.own.block().memory().started_at != 0 && now - seen.up_at > kSettled;
  if (seen.told_bytes == 0 && is_on) seen.told_bytes = rtpu.first_resident_bytes = bytes;
  if (seen.told_bytes == 0 || bytes < 2 * seen.told_bytes || bytes < seen.told_bytes + kMuch) return;
  const RtpuId id(static_cast<std::uint32_t>(index));
  state_.tell("memory", TaskId{}, id,
              state_.name(id) + " has grown to " + memory_text(bytes) + " resident, from " +
                  memory_text(rtpu.first_resident_bytes) + " when it was ON: does one of its components leak?",
              now);
  seen.told_bytes = bytes;
}

/// Logs a difference only if two checks in a row find it, because a thread may be changing its own level.
void RtpuHealth::compare(std::size_t index, Nanoseconds now) {
  RtpuRecord& rtpu = state_.rtpus[index];
  Seen& seen = seen_[index];
  const RtpuId id(static_cast<std::uint32_t>(index));
  const BlockHead& head = state_.peers[id].block().head();
  std::vector<ThreadRights> threads;
  for (const pid_t thread : seen.threads)
    if (ThreadRights rights; look_up_rights(thread, rights)) threads.push_back(rights);
  const auto granted = GrantedRights::of({head.grant, ::strnlen(head.grant, sizeof head.grant)});
  const bool is_preemptive = state_.spec().rtpus[index].preemptive;
  const std::string lost = lost_rights(granted, is_preemptive, threads, has_locked_memory(rtpu.pid));
  const bool is_sure = lost == seen.suspected;
  seen.suspected = lost;
  if (!is_sure || lost == rtpu.lost_rights) return;
  rtpu.lost_rights = lost;
  state_.tell("rights", TaskId{}, id,
              lost.empty() ? state_.name(id) + " has its real-time rights again"
                           : state_.name(id) + " gave up real-time rights: " + lost,
              now);
}

}  // namespace chimera::manager
