// SPDX-License-Identifier: Apache-2.0
#include "tests/kill/kill_trial.h"

#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <new>
#include <span>

#include "chimera/platform/shared_memory.h"
#include "chimera/table/group.h"
#include "tests/kill/forked.h"
#include "tests/kill/publication.h"

namespace chimera {
namespace {

constexpr std::size_t kReaders = 2;

struct alignas(64) ReaderScore {
  std::atomic<std::uint64_t> reads, torn, backwards, refused_dead, refused_alive;
  std::atomic<std::uint64_t> dead_phase_seen;  // latest phase in which a whole read was made without a writer
};

// Beside the segment, writable by all: what the processes tell each other about the trial.
struct Score {
  std::atomic<std::uint64_t> begun, finished;  // writes
  std::atomic<std::uint64_t> phase;            // odd: the writer is dead and reaped
  std::atomic<bool> stop;
  std::array<ReaderScore, kReaders> readers;
};

// Never returns; ends by SIGKILL.
[[noreturn]] void write_for_ever(std::span<std::byte> memory, Score& score, bool planted_defect) {
  GroupWriter writer(memory, kTrialPayload);
  const GroupReader published(memory.data(), kTrialPayload);
  for (;;) {
    const std::uint64_t n = writer.sequence() + 1;
    std::byte* place = writer.staging();
    if (planted_defect) place = reinterpret_cast<std::byte*>(const_cast<chimera_slot*>(published.published() + 1));
    score.begun.fetch_add(1, std::memory_order_relaxed);
    fill(place, 0, n);
    writer.publish(Nanoseconds{static_cast<std::int64_t>(n)}, 1);
    score.finished.fetch_add(1, std::memory_order_relaxed);
  }
}

void read_once(const GroupReader& reader, Score& score, ReaderScore& mine, std::uint64_t& last) {
  chimera_slot header{};
  TrialWords words;
  const std::uint64_t before = score.phase.load();
  const bool ok = reader.try_read(header, reinterpret_cast<std::byte*>(words.data()));
  const bool writer_was_dead = before % 2 == 1 && score.phase.load() == before;
  ++mine.reads;
  if (!ok) {
    ++(writer_was_dead ? mine.refused_dead : mine.refused_alive);
  } else {
    if (!is_whole(header, words, 0)) ++mine.torn;
    if (header.sequence < last) ++mine.backwards;
    last = header.sequence;
  }
  if (writer_was_dead) mine.dead_phase_seen = before;
}

[[noreturn]] void read_until_stopped(int descriptor, Score& score, ReaderScore& mine) {
  const Result<MemoryRegion> region = MemoryRegion::open_read_only(descriptor, group_bytes(kTrialPayload));
  if (!region) ::_exit(1);
  const GroupReader reader(region->bytes().data(), kTrialPayload);
  std::uint64_t last = 0;
  while (!score.stop) {
    for (int burst = 0; burst < 50 && !score.stop; ++burst) read_once(reader, score, mine, last);
    nap(20);  // lets the others run where there is one CPU only
  }
  ::_exit(0);
}

class Trial {
 public:
  explicit Trial(const KillTrial& trial) : trial_(trial), random_(trial.seed * 2 + 1) {}

  KillReport run() {
    Result<MemoryRegion> region = MemoryRegion::create("kill_trial", group_bytes(kTrialPayload));
    void* shared = ::mmap(nullptr, sizeof(Score), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (!region || shared == MAP_FAILED) return KillReport{.failure = "no shared memory"};
    score_ = new (shared) Score{};
    for (std::size_t i = 0; i < kReaders; ++i)
      readers_[i] = start_forked([&] { read_until_stopped(region->descriptor(), *score_, score_->readers[i]); });
    const double end = seconds_now() + trial_.seconds;
    KillReport report;
    while (report.failure.empty() && report.kills < trial_.kills && seconds_now() < end)
      kill_one(region->writable(), report);
    stop_readers(report);
    ::munmap(shared, sizeof(Score));
    return report;
  }

 private:
  void kill_one(std::span<std::byte> memory, KillReport& report) {
    const std::uint64_t begun = score_->begun;
    const std::uint64_t sequence = GroupReader(memory.data(), kTrialPayload).published()->sequence;
    const pid_t writer = start_forked([&] { write_for_ever(memory, *score_, trial_.planted_defect); });
    if (writer < 0) {
      report.failure = "fork failed";
      return;
    }
    const bool wrote = wait_for([&] { return score_->begun != begun; });
    nap(static_cast<long>(next_random() % 300));
    ::kill(writer, SIGKILL);  // still ours
    ::waitpid(writer, nullptr, 0);
    ++report.kills;
    if (score_->begun != score_->finished) ++report.mid_write;
    score_->finished = score_->begun.load();
    if (!wrote) report.failure = "a writer did not begin to write";
    if (GroupReader(memory.data(), kTrialPayload).published()->sequence < sequence) ++report.backwards;
    let_readers_look(report);
  }

  // Both readers must have read without a writer before the next one starts.
  void let_readers_look(KillReport& report) {
    const std::uint64_t dead = ++score_->phase;
    const bool looked = wait_for([&] {
      for (const ReaderScore& reader : score_->readers)
        if (reader.dead_phase_seen != dead) return false;
      return true;
    });
    if (!looked) report.failure = "a reader got no read in 60 s without a writer";
    ++score_->phase;
  }

  void stop_readers(KillReport& report) {
    score_->stop = true;
    for (std::size_t i = 0; i < kReaders; ++i) {
      int status = 0;
      ::waitpid(readers_[i], &status, 0);
      if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) report.failure = "a reader did not end well";
      const ReaderScore& reader = score_->readers[i];
      report.reads += reader.reads;
      report.torn += reader.torn;
      report.backwards += reader.backwards;
      report.refused_dead += reader.refused_dead;
      report.refused_alive += reader.refused_alive;
    }
  }

  std::uint64_t next_random() {
    random_ = random_ * 6364136223846793005u + 1442695040888963407u;
    return random_ >> 33;
  }

  KillTrial trial_;
  std::uint64_t random_;
  Score* score_ = nullptr;
  std::array<pid_t, kReaders> readers_{};
};

}  // namespace

KillReport run_kill_trial(const KillTrial& trial) { return Trial(trial).run(); }

}  // namespace chimera
