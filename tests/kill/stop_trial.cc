// SPDX-License-Identifier: Apache-2.0
#include "tests/kill/stop_trial.h"

#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <new>
#include <random>
#include <span>

#include "chimera/platform/shared_memory.h"
#include "chimera/table/group.h"
#include "tests/kill/forked.h"
#include "tests/kill/publication.h"

namespace chimera {
namespace {

constexpr std::size_t kWriters = 2;
constexpr std::size_t kReaders = 2;
constexpr int kLateWrites = 3;  // of a writer without readers

struct alignas(64) WriterScore {
  std::atomic<std::uint64_t> begun, finished;
};

struct alignas(64) ReaderScore {
  std::atomic<std::uint64_t> reads, torn, backwards, refused;
  std::atomic<std::uint64_t> phase_seen;  // latest phase in which a whole read was made
};

// Shared by all processes of the trial, beside the groups. Phase 2k + 1: the writer that was read is stopped and the
// other one is read. Phase 2k + 2: the stopped writer goes on.
struct Score {
  std::atomic<std::uint64_t> phase;
  std::atomic<bool> stop;
  std::array<WriterScore, kWriters> writers;
  std::array<ReaderScore, kReaders> readers;
};

constexpr std::size_t writer_read_in(std::uint64_t phase) { return (phase + 1) / 2 % kWriters; }

template <class Memory>
Memory group_of(Memory memory, std::size_t writer) {
  return memory.subspan(writer * group_bytes(kTrialPayload), group_bytes(kTrialPayload));
}

// Without end; after it was replaced it writes a little more, as one does that knows of nothing.
[[noreturn]] void write_for_ever(std::span<std::byte> memory, std::size_t me, bool planted_defect, Score& score) {
  GroupWriter writer(group_of(memory, planted_defect ? 0 : me), kTrialPayload);
  WriterScore& mine = score.writers[me];
  for (int late = 0;;) {
    const bool is_read = writer_read_in(score.phase) == me;
    late = is_read ? 0 : late + 1;
    if (late > kLateWrites) {
      nap(20);
      continue;
    }
    mine.begun.fetch_add(1);
    const std::uint64_t n = writer.sequence() + 1;
    fill(writer.staging(), me, n);
    writer.publish(Nanoseconds{static_cast<std::int64_t>(n)}, 1);
    mine.finished.fetch_add(1);
  }
}

[[noreturn]] void read_until_stopped(int descriptor, bool planted_defect, Score& score, ReaderScore& mine) {
  const Result<MemoryRegion> region =
      MemoryRegion::open_read_only(descriptor, kWriters * group_bytes(kTrialPayload));
  if (!region) ::_exit(1);
  std::array<std::uint64_t, kWriters> last{};
  chimera_slot header{};
  TrialWords words;
  for (std::uint64_t n = 1; !score.stop; ++n) {
    const std::uint64_t phase = score.phase;
    const std::size_t writer = writer_read_in(phase);
    const GroupReader reader(group_of(region->bytes(), planted_defect ? 0 : writer).data(), kTrialPayload);
    ++mine.reads;
    if (!reader.try_read(header, reinterpret_cast<std::byte*>(words.data()))) {
      ++mine.refused;
    } else {
      if (!is_whole(header, words, writer)) ++mine.torn;
      if (header.sequence < last[writer]) ++mine.backwards;
      last[writer] = header.sequence;
      mine.phase_seen = phase;
    }
    if (n % 50 == 0) nap(20);  // lets the others run where there is one CPU only
  }
  ::_exit(0);
}

class Trial {
 public:
  explicit Trial(const StopTrial& trial) : trial_(trial), random_(trial.seed) {}

  StopReport run() {
    Result<MemoryRegion> region = MemoryRegion::create("stop_trial", kWriters * group_bytes(kTrialPayload));
    void* shared = ::mmap(nullptr, sizeof(Score), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (!region || shared == MAP_FAILED) return StopReport{.failure = "no shared memory"};
    score_ = new (shared) Score{};
    const bool defect = trial_.planted_defect;
    for (std::size_t i = 0; i < kWriters; ++i)
      writers_[i] = start_forked([&] { write_for_ever(region->writable(), i, defect, *score_); });
    for (std::size_t i = 0; i < kReaders; ++i)
      readers_[i] =
          start_forked([&] { read_until_stopped(region->descriptor(), defect, *score_, score_->readers[i]); });
    const double end = seconds_now() + trial_.seconds;
    StopReport report;
    for (const pid_t pid : {writers_[0], writers_[1], readers_[0], readers_[1]})
      if (pid < 0) report.failure = "fork failed";
    while (report.failure.empty() && report.stops < trial_.stops && seconds_now() < end) stop_one(report);
    end_all(report);
    ::munmap(shared, sizeof(Score));
    return report;
  }

 private:
  void stop_one(StopReport& report) {
    const std::size_t old = writer_read_in(score_->phase);
    WriterScore& stopped = score_->writers[old];
    const std::uint64_t begun = stopped.begun;
    if (!wait_for([&] { return stopped.begun != begun; })) report.failure = "a writer does not write";
    nap(static_cast<long>(random_() % 100));
    ::kill(writers_[old], SIGSTOP);  // still ours
    ::waitpid(writers_[old], nullptr, WUNTRACED);
    const std::uint64_t finished = stopped.finished;
    if (stopped.begun != finished) ++report.mid_write;
    ++score_->phase;
    let_readers_look(report);
    ::kill(writers_[old], SIGCONT);  // still ours
    if (!wait_for([&] { return stopped.finished > finished; })) report.failure = "a writer does not go on";
    ++score_->phase;
    let_readers_look(report);
    ++report.stops;
  }

  void let_readers_look(StopReport& report) {
    const bool looked = wait_for([&] {
      for (const ReaderScore& reader : score_->readers)
        if (reader.phase_seen != score_->phase) return false;
      return true;
    });
    if (!looked) report.failure = "a reader got no read in 60 s";
  }

  void end_all(StopReport& report) {
    score_->stop = true;
    for (const pid_t writer : writers_) {
      if (writer < 0) continue;
      ::kill(writer, SIGKILL);  // still ours
      ::waitpid(writer, nullptr, 0);
    }
    for (std::size_t i = 0; i < kReaders; ++i) {
      if (readers_[i] < 0) continue;
      int status = 0;
      ::waitpid(readers_[i], &status, 0);
      if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) report.failure = "a reader did not end well";
      const ReaderScore& reader = score_->readers[i];
      report.reads += reader.reads;
      report.torn += reader.torn;
      report.backwards += reader.backwards;
      report.refused += reader.refused;
    }
  }

  StopTrial trial_;
  std::mt19937_64 random_;
  Score* score_ = nullptr;
  std::array<pid_t, kWriters> writers_{};
  std::array<pid_t, kReaders> readers_{};
};

}  // namespace

StopReport run_stop_trial(const StopTrial& trial) { return Trial(trial).run(); }

}  // namespace chimera
