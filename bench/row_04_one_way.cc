// SPDX-License-Identifier: Apache-2.0
// Row 4, between two processes: 80 B one way through the register in sealed memory that the reader maps read-only,
// beside the same bytes through a pipe and a Unix datagram socket (both sleep until something comes), and beside one
// word in shared memory, below which nothing could go. The installed peers: row_04_one_way_peer.cc.
#include <sys/socket.h>

#include "bench/one_way.h"

namespace chimera::bench {
namespace {

// One shared word per direction.
class ByWord : public Transport {
 public:
  ByWord(MemoryRegion own, MemoryRegion other) : own_(std::move(own)), other_(std::move(other)) {}
  void send(const Message& message) override {
    std::atomic_ref(*reinterpret_cast<std::uint64_t*>(own_.writable().data()))
        .store(message.number, std::memory_order_release);
  }
  bool take(Message& message) override {
    message.number = *reinterpret_cast<const volatile std::uint64_t*>(other_.bytes().data());
    return std::exchange(seen_, message.number) != message.number;
  }

 private:
  MemoryRegion own_, other_;
  std::uint64_t seen_ = 0;
};

std::unique_ptr<Transport> word_side(const Channel& channel, bool) {
  auto own = or_give_up(MemoryRegion::create("row_4", sizeof(Message)), "own memory");
  const int descriptor = exchange(channel, own.descriptor());
  auto other = or_give_up(MemoryRegion::open_read_only(descriptor, sizeof(Message)), "other memory");
  close(descriptor);
  return std::make_unique<ByWord>(std::move(own), std::move(other));
}

// Whatever has a descriptor to write to and one to read from; reading sleeps.
class ByDescriptor : public Transport {
 public:
  ByDescriptor(int out, int in) : out_(out), in_(in) {}
  void send(const Message& message) override {
    if (write(out_, &message, sizeof message) != sizeof message) give_up("write failed");
  }
  bool take(Message& message) override { return read(in_, &message, sizeof message) == sizeof message; }

 private:
  int out_, in_;
};

// Each side reads the end it keeps and hands the other end on.
std::unique_ptr<Transport> descriptor_side(const Channel& channel, const int (&ends)[2]) {
  const int out = exchange(channel, ends[1]);
  close(ends[1]);
  return std::make_unique<ByDescriptor>(out, ends[0]);
}

std::unique_ptr<Transport> pipe_side(const Channel& channel, bool) {
  int ends[2];
  if (pipe(ends) != 0) give_up("no pipe");
  return descriptor_side(channel, ends);
}

std::unique_ptr<Transport> datagram_side(const Channel& channel, bool) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_DGRAM, 0, ends) != 0) give_up("no socket pair");
  return descriptor_side(channel, ends);
}

void report(const OneWay& all, std::size_t other, const std::string& name) {
  Figure figure{.row = 4, .what = "80 B one way to another process, times below a " + name};
  figure.figure = all.cost(0);
  figure.baseline = all.cost(other);
  figure.baseline_name = name;
  figure.limit = all.cost(1);
  figure.ratio = all.ratio(other, 0);
  figure.aa_spread = all.aa_spread();
  figure.n = all.n();
  print(figure);
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) {
  using namespace chimera::bench;
  const Named transports[] = {{"register", register_side},
                              {"word", word_side},
                              {"pipe", pipe_side, true},
                              {"datagram", datagram_side, true}};
  if (const int mine = answering(argc, argv, transports)) return answer(transports[mine - 1], mine);
  if (std::thread::hardware_concurrency() < 2) give_up("one way between two processes needs two CPUs");
  OneWay all(repetitions(argc, argv, 51));
  for (const Named& one : transports) all.add(one);
  const Stage stage;
  all.run();
  report(all, 2, "pipe");
  report(all, 3, "Unix datagram");
}
