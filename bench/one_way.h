// SPDX-License-Identifier: Apache-2.0
// One-way time of 80 B between two processes on two CPUs, for row 4: half of a round trip. The second process returns
// each message; it is this program, started with `--answer NAME`. Transports take turns, repetition by
// repetition; the first is measured twice (A/A). No loop of either side is without an end in time.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/table/group.h"

namespace chimera::bench {

struct Message {
  std::uint64_t number = 0;
  double values[9]{};
};
static_assert(sizeof(Message) == 80);

/// One direction out, one in.
class Transport {
 public:
  virtual ~Transport() = default;
  virtual void send(const Message& message) = 0;
  /// The latest message, when one came since the last call. May block for some milliseconds.
  virtual bool take(Message& message) = 0;
};

/// The register: each side writes its own sealed memory and maps the other's read-only.
class ByRegister : public Transport {
 public:
  ByRegister(MemoryRegion own, MemoryRegion other)
      : own_(std::move(own)),
        other_(std::move(other)),
        writer_(own_.writable(), sizeof(Message)),
        reader_(other_.bytes().data(), sizeof(Message)) {}
  void send(const Message& message) override {
    writer_.write(reinterpret_cast<const std::byte*>(&message), Nanoseconds{1}, 1);
  }
  bool take(Message& message) override {
    chimera_slot header{};
    if (!reader_.try_read(header, reinterpret_cast<std::byte*>(&message)) || header.sequence == seen_) return false;
    seen_ = header.sequence;
    return true;
  }

 private:
  MemoryRegion own_, other_;
  GroupWriter writer_;
  GroupReader reader_;
  std::uint64_t seen_ = 0;
};

[[noreturn]] inline void give_up(const std::string& what) {
  std::fprintf(stderr, "row 4: %s\n", what.c_str());
  std::exit(1);
}

template <class T>
T or_give_up(Result<T> result, const char* what) {
  if (!result.has_value()) give_up(std::string(what) + ": " + result.error().message.c_str());
  return std::move(*result);
}

/// Sends a descriptor and waits for the other side's.
inline int exchange(const Channel& channel, int passed) {
  const std::byte token[1]{};
  if (!channel.send(token, passed)) give_up("the other process is gone");
  for (int tries = 0; tries < 5000; ++tries) {
    std::byte got[1];
    int received = -1;
    if (channel.receive(got, received) == Channel::Got::kMessage) return received;
    usleep(1000);
  }
  give_up("the other process does not answer");
}

inline std::unique_ptr<Transport> register_side(const Channel& channel, bool) {
  auto own = or_give_up(MemoryRegion::create("row_4", group_bytes(sizeof(Message))), "own memory");
  GroupWriter(own.writable(), sizeof(Message)).publish(Nanoseconds{1}, 1);
  const int descriptor = exchange(channel, own.descriptor());
  auto other = or_give_up(MemoryRegion::open_read_only(descriptor, group_bytes(sizeof(Message))), "other memory");
  close(descriptor);
  return std::make_unique<ByRegister>(std::move(own), std::move(other));
}

/// Word that both processes read: the process whose turn it is. 0: neither.
using Turn = std::atomic<int>;
constexpr int kEnd = -1;

inline Turn& turn_of(const SharedPages& pages) { return *reinterpret_cast<Turn*>(pages.bytes().data()); }

struct Named {
  std::string name;
  std::unique_ptr<Transport> (*make)(const Channel& channel, bool is_answering);
  bool blocks = false;  // a wait sleeps: such a side may have real-time priority on both CPUs
};

/// A side that sleeps in each wait gets the rights of `Stage`. A side that spins must leave CPU 0 to others.
inline void settle_answering(bool blocks) {
  if (blocks) {
    Stage settled(0);
    return;
  }
  const sched_param none{.sched_priority = 0};  // the first process may have handed its own on
  sched_setscheduler(0, SCHED_OTHER, &none);
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(0, &one);
  sched_setaffinity(0, sizeof one, &one);
  setpriority(PRIO_PROCESS, 0, -20);
}

/// The second process. Ends at kEnd, or with its parent.
inline int answer(const Named& named, int number) {
  if (!follow_parent(getppid(), SIGKILL)) return 1;
  const Channel channel(3);
  const SharedPages pages = or_give_up(SharedPages::open(4, sizeof(Turn)), "control page");
  const Turn& turn = turn_of(pages);
  settle_answering(named.blocks);
  const auto transport = named.make(channel, true);
  Message message;
  for (int now = turn.load(); now != kEnd; now = turn.load(std::memory_order_relaxed)) {
    if (now != number && !named.blocks) usleep(50);
    else if (transport->take(message)) transport->send(message);
  }
  return 0;
}

/// This process's side of all transports, and the processes that answer.
class OneWay {
 public:
  explicit OneWay(int repetitions)
      : repetitions_(repetitions),
        pages_(or_give_up(SharedPages::create("row_4_turn", sizeof(Turn)), "control page")) {}
  ~OneWay() {
    turn_of(pages_) = kEnd;
    for (auto& side : sides_) {
      ProcessEnd end;
      side.transport->send({});  // wakes one that sleeps
      if (side.process.wait(end, 2'000'000'000)) continue;
      side.process.signal(SIGKILL);
      side.process.wait(end, 2'000'000'000);
    }
  }
  OneWay(const OneWay&) = delete;
  OneWay& operator=(const OneWay&) = delete;

  void add(const Named& named) {
    auto ends = or_give_up(Channel::pair(), "channel");
    const std::array<const char*, 3> arguments{"row_4", "--answer", named.name.c_str()};
    const std::array descriptors{ends.second.descriptor(), pages_.descriptor()};
    auto process = or_give_up(Process::start("/proc/self/exe", arguments, descriptors), "second process");
    auto transport = named.make(ends.first, false);
    sides_.push_back({named, std::move(ends.first), std::move(process), std::move(transport), {}});
  }

  void run() {
    for (int k = 0; k < repetitions_; ++k) {
      for (std::size_t i = 0; i < sides_.size(); ++i) measure((i + static_cast<std::size_t>(k)) % sides_.size());
      const double before = sides_.front().medians.back();
      measure(0);
      again_.push_back(sides_.front().medians.back() / before);
      sides_.front().medians.back() = before;
    }
  }

  double cost(std::size_t side) const { return median(sides_[side].medians); }
  double ratio(std::size_t side, std::size_t other) const {
    std::vector<double> ratios;
    for (std::size_t k = 0; k < sides_[side].medians.size(); ++k)
      ratios.push_back(sides_[side].medians[k] / sides_[other].medians[k]);
    return median(ratios);
  }
  double aa_spread() const {
    return std::max(std::abs(median(again_) - 1), (quantile(again_, 0.75) - quantile(again_, 0.25)) / 2);
  }
  std::uint64_t n() const { return static_cast<std::uint64_t>(repetitions_) * kTrips; }

 private:
  static constexpr int kTrips = 200;
  static constexpr int kTogether = 10;     // between two readings of the clock, so that these weigh nothing
  static constexpr double kLimitNs = 2e9;  // of one measurement

  struct Side {
    Named named;
    Channel channel;
    Process process;
    std::unique_ptr<Transport> transport;
    std::vector<double> medians;  // one way, ns
  };

  void measure(std::size_t index) {
    Side& side = sides_[index];
    turn_of(pages_) = static_cast<int>(index) + 1;
    const double until = now_ns() + kLimitNs;
    std::vector<double> trips;
    for (int k = -2; k < kTrips / kTogether; ++k) {
      const double begin = now_ns();
      for (int i = 0; i < kTogether; ++i) trip(side, until);
      if (k >= 0) trips.push_back((now_ns() - begin) / (2 * kTogether));
    }
    turn_of(pages_) = 0;
    side.medians.push_back(median(trips));
    usleep(2000);  // the kernel's share of this CPU
  }

  void trip(Side& side, double until) {
    Message message{++number_, {}}, back;
    side.transport->send(message);
    for (std::uint64_t polls = 1;; ++polls) {
      if (side.transport->take(back) && back.number == number_) return;
      if (polls % 1024 == 0 || side.named.blocks)
        if (now_ns() > until) give_up(side.named.name + ": no answer within 2 s");
    }
  }

  int repetitions_;
  SharedPages pages_;
  std::uint64_t number_ = 0;
  std::vector<Side> sides_;
  std::vector<double> again_;
};

/// The number of the transport this process is to answer, from 1; 0: it is the first process.
inline int answering(int argc, char** argv, std::span<const Named> all) {
  if (argc < 3 || std::string(argv[1]) != "--answer") return 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].name == argv[2]) return static_cast<int>(i) + 1;
  give_up("no transport " + std::string(argv[2]));
}

}  // namespace chimera::bench
