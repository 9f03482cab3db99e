// SPDX-License-Identifier: Apache-2.0
// A child of the keeper for its tests. It writes each of its messages as a line to the file CHIMERA_TEST_LOG. It
// carries out the lines of the files PEER.INCARNATION and PEER in the folder CHIMERA_TEST_ORDERS as they come. With the
// arguments `face PARENT` it is the run client.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include "chimera/platform/local_socket.h"
#include "chimera/platform/process.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/rtpu/keeper_message.h"
#include "chimera/runtime/hosted/pages.h"

namespace {

using namespace chimera;  // NOLINT: a main() of this project
using Kind = KeeperMessage::Kind;

std::string me;
volatile std::sig_atomic_t told_to_end = 0;

std::string told(const char* variable) {
  const char* value = std::getenv(variable);
  if (value == nullptr) std::abort();
  return value;
}

void log(const std::string& line) {
  const std::string text = me + " " + line + "\n";
  const int fd = ::open(told("CHIMERA_TEST_LOG").c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
  if (::write(fd, text.data(), text.size()) < 0) std::abort();
  ::close(fd);
}

// The next whole line of orders for `who`; "" if there is none yet.
std::string next_order(const std::string& who, int& done) {
  std::ifstream orders(told("CHIMERA_TEST_ORDERS") + "/" + who);
  std::string line;
  for (int i = 0; std::getline(orders, line) && !orders.eof(); ++i)
    if (i == done) return ++done, line;
  return "";
}

const char* word(Kind kind) {
  switch (kind) {
    case Kind::kPeer: return "peer";
    case Kind::kStarted: return "started";
    case Kind::kEnded: return "ended";
    case Kind::kComplete: return "complete";
    case Kind::kFinish: return "finish";
    default: return "?";
  }
}

std::string described(const KeeperMessage& m, int passed) {
  std::string text = std::string(word(m.kind)) + " " + std::to_string(m.index) + " " + std::to_string(m.incarnation);
  if (m.kind == Kind::kPeer) {
    const auto segment = MemoryRegion::open_read_only(passed, 4096);
    text += segment ? std::string(" ") + reinterpret_cast<const char*>(segment->bytes().data()) : " unreadable";
  }
  if (m.kind == Kind::kEnded) text += (m.by_signal != 0 ? " signal " : " exit ") + std::to_string(m.code);
  if (m.kind == Kind::kStarted) {
    pollfd life{passed, POLLIN, 0};
    text += ::poll(&life, 1, 0) == 0 ? " alive" : " dead";
  }
  return text;
}

int face() {
  me = "face";
  log("begin " + std::to_string(::getpid()));
  bool looked = false;
  for (int done = 0;; ::usleep(1000)) {
    const std::string order = next_order(me, done);
    if (order.starts_with("exit ")) return std::stoi(order.substr(5));
    if (order == "look") {
      (void)signal_parent(::getppid(), SIGUSR1);
      log("looked");
      looked = true;
    }
    if (looked) continue;
    if (told_to_end == 0 || std::getenv("CHIMERA_TEST_DEAF") != nullptr) continue;
    log("finishes");
    return 5;
  }
}

class Child {
 public:
  Child(const char* peer, const char* incarnation) : peer_(peer) { me = peer_ + "." + incarnation; }

  int run() {
    prepare();
    for (int code = -1;;) {
      pollfd events{kChannelDescriptor, POLLIN, 0};
      ::poll(&events, 1, 1);
      if ((code = take()) >= 0) return code;
      if ((code = on_message(next_order(me, own_))) >= 0) return code;
      if ((code = on_message(next_order(peer_, all_))) >= 0) return code;
      if (told_to_end == 0 || stubborn_) continue;
      log("terminated");
      return 0;
    }
  }

 private:
  void prepare() {
    const auto image = FrozenBytes::open(kImageDescriptor);
    decision_ = *SharedPages::open(kDecisionPageDescriptor, sizeof(DecisionPage));
    keeper_ = *MemoryRegion::open_read_only(kKeeperPageDescriptor, sizeof(KeeperPage));
    segment_ = *MemoryRegion::create("test", 4096);
    const auto& page = *reinterpret_cast<const KeeperPage*>(keeper_.bytes().data());
    std::string text = "begin " + std::to_string(::getpid()) + " image " + std::to_string(image->bytes().size()) +
                       " alive " + std::to_string(page.alive[std::stoul(peer_)].load());
    if (std::stoul(peer_) == page.n_rtpus)
      text += " bundle " + std::to_string(FrozenBytes::open(kBundleDescriptor)->bytes().size());
    log(text);
    std::snprintf(reinterpret_cast<char*>(segment_.writable().data()), 64, "by-%s", me.c_str());
    tell({.kind = Kind::kSegment}, segment_.descriptor());
  }

  int take() {
    KeeperMessage message;
    int passed = -1;
    Channel::Got got;
    while ((got = channel_.receive(bytes_of(message), passed)) == Channel::Got::kMessage) {
      log(described(message, passed));
      if (passed >= 0) ::close(passed);
      if (message.kind == Kind::kFinish && !stubborn_) return 0;
    }
    return got == Channel::Got::kClosed ? 8 : -1;
  }

  int on_message(const std::string& order) {
    const std::string what = order.substr(0, order.find(' '));
    const int number = what == order ? 0 : std::stoi(order.substr(what.size()));
    const auto index = static_cast<std::uint32_t>(number);
    if (what == "exit") return number;
    if (what == "crash") ::raise(SIGSEGV);
    if (what == "stubborn") stubborn_ = true;
    if (what == "stubborn") log("is stubborn");
    if (what == "changes")
      log("changes " + std::to_string(reinterpret_cast<DecisionPage*>(decision_.bytes().data())->changes.load()));
    if (what == "start") tell({.kind = Kind::kStart, .index = index});
    if (what == "kill") tell({.kind = Kind::kEndChild, .index = index});
    if (what == "end") tell({.kind = Kind::kEnd, .code = number});
    return -1;
  }

  void tell(const KeeperMessage& message, int passed = -1) {
    if (!channel_.send(bytes_of(message), passed)) log("cannot be heard");
  }

  std::string peer_;
  const Channel channel_{kChannelDescriptor};
  SharedPages decision_;
  MemoryRegion keeper_, segment_;
  bool stubborn_ = false;
  int own_ = 0, all_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGTERM, [](int) { told_to_end = 1; });
  sigset_t held;  // SIGTERM, blocked in a run client until it listens
  ::sigemptyset(&held);
  ::sigaddset(&held, SIGTERM);
  ::sigprocmask(SIG_UNBLOCK, &held, nullptr);
  std::signal(SIGSEGV, SIG_DFL);
  if (argc == 3 && std::strcmp(argv[1], "face") == 0) return follow_parent(std::stoi(argv[2]), SIGKILL) ? face() : 10;
  if (argc != 7 || !follow_parent(std::stoi(argv[6]), SIGTERM)) return 10;
  return Child(argv[2], argv[4]).run();
}
