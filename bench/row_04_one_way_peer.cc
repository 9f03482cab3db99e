// SPDX-License-Identifier: Apache-2.0
// Row 4 beside its installed peers, in the same run: 80 B one way to another process through the register, iceoryx
// 2.0.3 (queue of 1, both sides spin, as ours does) and Cyclone DDS 0.10.2 (keep last 1, reliable, over the loopback
// interface; both sides sleep in a waitset, at real-time priority). A peer that is not installed is named as missing.
#include "bench/one_way.h"

#ifdef CHIMERA_ICEORYX
#include <iceoryx_posh/popo/publisher.hpp>
#include <iceoryx_posh/popo/subscriber.hpp>
#include <iceoryx_posh/runtime/posh_runtime.hpp>
#endif
#ifdef CHIMERA_CYCLONE
#include <ddsc/dds.h>

#include "one_way_sample.h"  // made from one_way_sample.idl
#endif

namespace chimera::bench {
namespace {

template <class Condition>
[[maybe_unused]] void await(Condition condition, const char* what) {
  for (int tries = 0; !condition(); ++tries) {
    if (tries > 5000) give_up(what);
    usleep(1000);
  }
}

#ifdef CHIMERA_ICEORYX
class ByIceoryx : public Transport {
 public:
  explicit ByIceoryx(bool is_answering)
      : publisher_(is_answering ? back() : there()), subscriber_(is_answering ? there() : back(), queue_of_one()) {
    await([&] { return publisher_.hasSubscribers() &&
                       subscriber_.getSubscriptionState() == iox::SubscribeState::SUBSCRIBED; },
          "two iceoryx processes do not find each other");
  }
  void send(const Message& message) override {
    publisher_.publishCopyOf(message).or_else([](auto&) { give_up("iceoryx has no memory for a sample"); });
  }
  bool take(Message& message) override {
    auto taken = subscriber_.take();
    if (taken.has_error()) return false;
    message = **taken;
    return true;
  }

 private:
  static iox::capro::ServiceDescription there() { return {"chimera", "row_4", "there"}; }
  static iox::capro::ServiceDescription back() { return {"chimera", "row_4", "back"}; }
  static iox::popo::SubscriberOptions queue_of_one() {
    iox::popo::SubscriberOptions options;
    options.queueCapacity = 1;
    options.historyRequest = 0;
    return options;
  }
  iox::popo::Publisher<Message> publisher_;
  iox::popo::Subscriber<Message> subscriber_;
};

std::unique_ptr<Transport> iceoryx_side(const Channel&, bool is_answering) {
  const iox::RuntimeName_t there("chimera_row_4_there"), back("chimera_row_4_back");
  iox::runtime::PoshRuntime::initRuntime(is_answering ? back : there);
  return std::make_unique<ByIceoryx>(is_answering);
}

// Runs this program again beside the daemon that every iceoryx process needs. When the daemon ends, it ends the
// processes that still use it.
int beside_daemon() {
  const std::array<const char*, 5> words{"iox-roudi", "--monitoring-mode", "off", "--log-level", "fatal"};
  Process daemon = or_give_up(Process::start("/usr/bin/iox-roudi", words, {}), "iox-roudi");
  ProcessEnd end;
  if (daemon.wait(end, 500'000'000)) give_up("iox-roudi ended at once: another one runs?");
  const std::array<const char*, 2> again{"row_4", "--measure"};
  Process measuring = or_give_up(Process::start("/proc/self/exe", again, {}), "measuring");
  int code = 1;
  if (measuring.wait(end, 60'000'000'000)) code = end.by_signal ? 1 : end.code;
  else measuring.signal(SIGKILL);
  daemon.signal(SIGTERM);
  if (!daemon.wait(end, 5'000'000'000)) {
    daemon.signal(SIGKILL);
    daemon.wait(end, 1'000'000'000);
  }
  return code;
}
#endif

#ifdef CHIMERA_CYCLONE
dds_entity_t made(dds_entity_t entity, const char* what) {
  if (entity < 0) give_up(std::string("Cyclone DDS: ") + what + ": " + dds_strretcode(-entity));
  return entity;
}

class ByCyclone : public Transport {
 public:
  explicit ByCyclone(bool is_answering)
      : participant_(made(dds_create_participant(0, nullptr, nullptr), "participant")) {
    dds_qos_t* quality = dds_create_qos();
    dds_qset_reliability(quality, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
    dds_qset_history(quality, DDS_HISTORY_KEEP_LAST, 1);
    const auto topic = [&](bool is_back) {
      const char* name = is_back ? "row_4_back" : "row_4_there";
      return made(dds_create_topic(participant_, &one_way_Sample_desc, name, quality, nullptr), "topic");
    };
    writer_ = made(dds_create_writer(participant_, topic(is_answering), quality, nullptr), "writer");
    reader_ = made(dds_create_reader(participant_, topic(!is_answering), quality, nullptr), "reader");
    dds_delete_qos(quality);
    waitset_ = made(dds_create_waitset(participant_), "waitset");
    made(dds_waitset_attach(waitset_, made(dds_create_readcondition(reader_, DDS_ANY_STATE), "condition"), 0), "wait");
    await([&] { return is_matched(); }, "two Cyclone DDS processes do not find each other");
  }
  ~ByCyclone() override { dds_delete(participant_); }
  void send(const Message& message) override {
    one_way_Sample sample;
    std::memcpy(sample.bytes, &message, sizeof message);
    made(dds_write(writer_, &sample), "write");
  }
  bool take(Message& message) override {
    dds_attach_t woken[1];
    if (dds_waitset_wait(waitset_, woken, 1, DDS_MSECS(10)) <= 0) return false;
    one_way_Sample sample;
    void* samples[1] = {&sample};
    dds_sample_info_t info[1];
    if (dds_take(reader_, samples, info, 1, 1) <= 0 || !info[0].valid_data) return false;
    std::memcpy(&message, sample.bytes, sizeof message);
    return true;
  }

 private:
  bool is_matched() const {
    dds_publication_matched_status_t out{};
    dds_subscription_matched_status_t in{};
    dds_get_publication_matched_status(writer_, &out);
    dds_get_subscription_matched_status(reader_, &in);
    return out.current_count > 0 && in.current_count > 0;
  }
  dds_entity_t participant_, writer_ = 0, reader_ = 0, waitset_ = 0;
};

std::unique_ptr<Transport> cyclone_side(const Channel&, bool is_answering) {
  return std::make_unique<ByCyclone>(is_answering);
}
#endif

// A peer of this row; `make` is null where it is not installed.
struct Peer {
  Named named;
  double goal;
  std::string package;
};

std::vector<Peer> peers() {
  std::vector<Peer> all{{{"iceoryx", nullptr}, 5, "iceoryx and libiceoryx-posh-dev"},
                        {{"Cyclone DDS", nullptr, true}, 30, "cyclonedds-dev and cyclonedds-tools"}};
#ifdef CHIMERA_ICEORYX
  all[0].named.make = iceoryx_side;
#endif
#ifdef CHIMERA_CYCLONE
  all[1].named.make = cyclone_side;
#endif
  return all;
}

void report(const OneWay& all, std::size_t other, const Peer& peer) {
  Figure figure{.row = 4, .what = "80 B one way to another process, times below " + peer.named.name};
  figure.figure = all.cost(0);
  figure.baseline = all.cost(other);
  figure.baseline_name = peer.named.name;
  figure.ratio = all.ratio(other, 0);
  figure.goal = ratio_at_least(peer.goal);
  figure.aa_spread = all.aa_spread();
  figure.n = all.n();
  print(figure);
}

int measure(const std::vector<Peer>& all) {
  const Stage stage;  // before the peers make threads of their own: these are real-time too then
  OneWay sides(51);
  sides.add({"register", register_side});
  for (const Peer& peer : all)
    if (peer.named.make != nullptr) sides.add(peer.named);
  sides.run();
  std::size_t next = 1;
  for (const Peer& peer : all) {
    if (peer.named.make != nullptr) report(sides, next++, peer);
    else print({.row = 4, .what = "80 B one way beside " + peer.named.name + ": skipped, needs " + peer.package});
  }
  return 0;
}

}  // namespace
}  // namespace chimera::bench

int main(int argc, char** argv) {
  using namespace chimera::bench;
  setenv("CYCLONEDDS_URI", "<General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces></General>",
         0);
  const std::vector<Peer> all = peers();
  std::vector<Named> transports{{"register", register_side}};
  for (const Peer& peer : all)
    if (peer.named.make != nullptr) transports.push_back(peer.named);
  if (const int mine = answering(argc, argv, transports)) {
    return answer(transports[static_cast<std::size_t>(mine) - 1], mine);
  }
  if (std::thread::hardware_concurrency() < 2) give_up("one way between two processes needs two CPUs");
#ifdef CHIMERA_ICEORYX
  if (argc < 2 || std::string(argv[1]) != "--measure") return beside_daemon();
#endif
  return measure(all);
}
