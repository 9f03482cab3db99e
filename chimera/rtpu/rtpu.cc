// SPDX-License-Identifier: Apache-2.0
// Maps the memory from the keeper, makes the tasks, supervises their thread, and ends in order.
#include "chimera/rtpu/rtpu.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/orphans.h"
#include "chimera/platform/process.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/platform/signal_queue.h"
#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"
#include "chimera/rtpu/board_tasks.h"
#include "chimera/rtpu/components.h"
#include "chimera/rtpu/cycling_thread.h"
#include "chimera/rtpu/guard_link.h"
#include "chimera/rtpu/hang_watch.h"
#include "chimera/rtpu/keeper_message.h"
#include "chimera/rtpu/service_thread.h"
#include "chimera/rtpu/switch_links.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/making.h"
#include "chimera/runtime/task_word.h"

namespace chimera {
namespace {

constexpr int kCouldNotStart = 1, kMethodHangs = 3, kTerminated = 5;
constexpr Nanoseconds kLongBackground = seconds(1);  // shorter background work is not reported
constexpr int kSuperviseEveryMs = 50;
constexpr std::size_t kStackBytes = 256 * 1024;  // locked as a whole, and freed as a whole when the thread ends

/// All parts of an rtpu, in the order in which they are made.
class Rtpu {
 public:
  explicit Rtpu(const RtpuStart& start)
      : start_(start), channel_(start.channel), guard_(start.guard, start.peer, start.incarnation) {}

  Result<void> prepare();
  int run();
  /// Context: after run().
  bool is_without_keeper();

 private:
  Result<void> map();
  Result<void> make_segment();
  Result<void> find_components();
  Result<void> make_tasks();
  void announce();
  void listen(int timeout_ms);
  void attend();
  void read_messages();
  void add_peer(const KeeperMessage& message, int descriptor);
  void end(bool is_alone);
  bool hangs();
  bool loop_hangs();
  bool has_lost_thread();
  bool give_up(std::uint32_t method, Nanoseconds waited, Nanoseconds used = {});
  std::uint64_t jobs_of(TaskId task) const;

  std::atomic<std::uint32_t>& bell() { return decision_->bells[start_.peer].word; }
  const RtpuSpec& self() const { return image_->spec().rtpus[start_.peer]; }

  const RtpuStart start_;
  Channel channel_;
  GuardLink guard_;
  ThreadStack stacks_{start_.parent != 0 ? kStackBytes : 0};  // of all threads that start from here on
  SignalQueue signals_;
  WakeEvent over_;  // rung when the main thread must check for an end or a hang
  FrozenBytes image_bytes_;
  SharedPages decision_pages_;
  MemoryRegion keeper_pages_;
  std::unique_ptr<ApplicationImage> image_;
  DecisionPage* decision_ = nullptr;
  const KeeperPage* keeper_ = nullptr;
  std::unique_ptr<MappedPeers> peers_;
  MemoryRegion segment_;
  BlockOwner block_;
  std::vector<const chimera_component*> components_;
  std::unique_ptr<BoardTasks> board_;
  std::unique_ptr<ServiceThread> service_;
  std::unique_ptr<PeerLinks> others_;
  BackgroundWriter writer_;
  std::unique_ptr<HeapTaskSet> tasks_;
  std::unique_ptr<RtpuControl> edge_;
  std::unique_ptr<SwitchLinks> switching_;
  std::unique_ptr<HangWatch> hang_watch_;
  std::unique_ptr<CyclingThread> cycling_;
  bool is_ending_ = false;
  bool keeper_is_gone_ = false;
  bool ends_alone_ = false;    // the other rtpus go on
  bool is_giving_up_ = false;  // because a job does not end
  LinuxClock wall_;
};

Result<void> Rtpu::prepare() {
  if (start_.parent != 0) {
    for (const int fd :
         {start_.channel, start_.image, start_.decision_page, start_.keeper_page, start_.objects, start_.guard})
      if (fd >= 0) close_at_exec(fd);  // programs that a component starts by exec inherit none of them
    constexpr int kTaken[] = {SIGTERM};  // the keeper answers SIGINT and SIGHUP of the terminal
    auto signals = SignalQueue::open(kTaken);
    if (!signals) return signals.error();
    signals_ = *std::move(signals);
    signals_.stay_blocked();  // a signal after the end has begun has no effect
    if (!follow_parent(start_.parent, SIGTERM)) return Error{ErrorCode::kRefused, {"the keeper is gone"}, {}};
    start_memory_holder();  // if it fails, only the detection of a death takes longer
  }
  auto over = WakeEvent::open(Message("rtpu"));
  if (!over) return over.error();
  over_ = *std::move(over);
  if (auto mapped = map(); !mapped) return mapped;
  if (auto made = make_segment(); !made) return made;
  announce();  // from here on the manager sees which object or method runs
  if (auto made = make_tasks(); !made) {
    publish_phase(block_.head(), made.error().message.view(), PeerPhase::kEnded);
    return made;
  }
  return {};
}

Result<void> Rtpu::map() {
  auto image_bytes = FrozenBytes::open(start_.image);
  if (!image_bytes) return image_bytes.error();
  image_bytes_ = *std::move(image_bytes);
  auto image = ApplicationImage::decode(image_bytes_.bytes());
  if (!image) return image.error();
  image_ = std::make_unique<ApplicationImage>(*std::move(image));
  if (start_.peer >= image_->spec().rtpus.size()) return Error{ErrorCode::kBadInput, {"no such rtpu"}, {}};
  auto decision = SharedPages::open(start_.decision_page, sizeof(DecisionPage));
  if (!decision) return decision.error();
  decision_pages_ = *std::move(decision);
  decision_ = reinterpret_cast<DecisionPage*>(decision_pages_.bytes().data());
  show_made(decision_->making[start_.peer]);  // shows in which object or method its predecessor died
  auto keeper = MemoryRegion::open_read_only(start_.keeper_page, sizeof(KeeperPage));
  if (!keeper) return keeper.error();
  keeper_pages_ = *std::move(keeper);
  keeper_ = reinterpret_cast<const KeeperPage*>(keeper_pages_.bytes().data());
  auto peers = MappedPeers::create(image_->spec());
  if (!peers) return peers.error();
  peers_ = *std::move(peers);
  return {};
}

Result<void> Rtpu::make_segment() {
  const auto n_tasks = static_cast<std::uint32_t>(image_->spec().tasks.size());
  const TableLayout& table = peers_->layout(start_.peer).table();
  auto made = MemoryRegion::create("chimera-rtpu", peer_segment_bytes(table, n_tasks));
  if (!made) return made.error();
  segment_ = *std::move(made);
  // A child of a component must not use the memory of this rtpu.
  if (start_.parent != 0) (void)segment_.keep_from_children();
  if (auto owner = SegmentOwner::format(segment_.writable(), table); !owner) return owner.error();
  std::byte* at = segment_.writable().data() + block_offset(table);
  block_ = BlockOwner(at, start_.peer, start_.incarnation, n_tasks, peers_->count());
  if (start_.parent != 0) block_.head().pid = own_process_id();
  return {};
}

// The stand-ins for the tasks of a board, and the line to the board.
Result<void> Rtpu::find_components() {
  if (self().link.is_there()) {
    board_ = std::make_unique<BoardTasks>(image_->spec(), RtpuId(start_.peer));
    components_ = board_->components();
    return {};
  }
  const auto object_bytes = FrozenBytes::open(start_.objects);
  if (!object_bytes) return object_bytes.error();
  const auto objects = SealedObjects::open(object_bytes->bytes());
  if (!objects) return objects.error();
  auto components = load_components(*image_, *objects, RtpuId(start_.peer), block_.head().serving,
                                    decision_->making[start_.peer]);
  if (!components) return components.error();
  components_ = *std::move(components);
  return {};
}

Result<void> Rtpu::make_tasks() {
  BlockHead& head = block_.head();
  std::atomic<std::uint32_t>& making = decision_->making[start_.peer];
  if (auto found = find_components(); !found) return found;
  const ApplicationSpec& spec = board_ ? board_->spec() : image_->spec();
  service_ = std::make_unique<ServiceThread>(spec.tasks.size(), Doorbell(bell()));
  others_ = std::make_unique<PeerLinks>(spec, start_.peer, segment_.writable(), block_, *decision_, *keeper_, *peers_);
  ContextPlace place;
  place.rtpu = RtpuId(start_.peer);
  place.table = segment_.writable().subspan(sizeof(SegmentHeader));
  place.others = others_.get();
  place.service = service_.get();
  if (guard_.is_there()) place.safe_frames = &guard_;
  place.running = &head.running;
  place.serving = &head.serving;
  place.preemptive = self().preemptive;
  place.at_edge = &head.at_edge;
  place.making = &making;
  place.incarnation = start_.incarnation;
  auto tasks = HeapTaskSet::create(spec, components_, place);
  if (!tasks) return tasks.error();
  tasks_ = *std::move(tasks);
  edge_ = std::make_unique<RtpuControl>(spec, *tasks_, *others_, *service_, *decision_, start_.peer,
                                 image_->settings().method_limit);
  edge_->hanging().set_supervisor(over_.descriptor());
  hang_watch_ = std::make_unique<HangWatch>(image_->settings().method_limit);
  switching_ = std::make_unique<SwitchLinks>(*tasks_, *others_, *peers_, *decision_, start_.peer);
  const CyclingPlace cycling{spec,        start_.peer, image_->settings().priority, *tasks_, *edge_, *others_,
                           *switching_, writer_,     keeper_->origin,             bell(),  over_.descriptor(),
                           peers_->room()};
  cycling_ = std::make_unique<CyclingThread>(cycling);
  return {};
}

void Rtpu::announce() {
  KeeperMessage message;
  message.kind = KeeperMessage::Kind::kSegment;
  message.index = start_.peer;
  message.incarnation = start_.incarnation;
  (void)channel_.send(bytes_of(message), segment_.descriptor());
  if (guard_.is_there()) guard_.show(segment_.descriptor(), block_);
}

int Rtpu::run() {
  if (board_) board_->line().start(over_);
  service_->start(*tasks_);
  cycling_->start();
  while (!cycling_->has_ended()) {
    listen(kSuperviseEveryMs);
    attend();
    if (has_lost_thread()) return kThreadLost;
    if (board_ && !is_ending_ && board_->line().has_ended()) return kBoardLost;
    if (hangs()) return kMethodHangs;
    if (!is_ending_ && edge_->hanging().any()) {
      is_giving_up_ = give_up(edge_->hanging().job(), edge_->hanging().age(), edge_->hanging().used());
      end(true);
    }
    // Now all tasks are killed except the one whose job hangs.
    if (is_giving_up_ && edge_->rtpu_end().is_over()) return kMethodHangs;
  }
  cycling_->join();
  service_->stop();
  return is_giving_up_ ? kMethodHangs : ends_alone_ ? kTerminated : 0;
}

// True if a component ended a thread of this process, in a method or for its next system call. Tasks cannot be turned
// off then.
bool Rtpu::has_lost_thread() {
  const bool is_loop = cycling_->is_gone();
  if (!is_loop && !service_->is_gone()) return false;
  const BlockHead& head = block_.head();
  return give_up(!is_loop ? head.serving : self().preemptive ? head.at_edge : head.running, {});
}

// True if a method does not return. Only the end of the process can end such a method.
bool Rtpu::hangs() {
  const Nanoseconds now = wall_.now(), limit = hang_watch_->limit();
  const BlockHead& head = block_.head();
  const std::uint32_t running = head.running, serving = is_ending_ ? head.serving.load() : 0;
  const std::uint32_t acting = edge_->supervised().acting() != 0 ? edge_->supervised().acting() : serving;
  const bool is_same_task = TaskWord::found(running).task() == TaskWord::found(acting).task();
  if (hang_watch_->method_hangs(acting, edge_->supervised().progress(), now))
    // `running` is then `error`, called after the method in `acting`.
    return give_up(is_same_task ? running : acting, limit);
  if (loop_hangs()) return give_up(running, limit, hang_watch_->job_used());
  const bool end_hangs = is_ending_ && hang_watch_->end_hangs(edge_->supervised().progress(), now);
  return end_hangs && give_up(running != 0 ? running : serving, limit);
}

// Writes the hung method and its limit to the block; always true.
bool Rtpu::give_up(std::uint32_t method, Nanoseconds waited, Nanoseconds used) {
  block_.head().hung_limit = waited.count;
  block_.head().hung_used = used.count;
  block_.head().hung = method;
  return true;
}

// Writes signs of life to BlockHead for the manager, which watches this process.
void Rtpu::attend() {
  BlockHead& head = block_.head();
  head.jobs.store(static_cast<std::uint32_t>(jobs_of(TaskWord::found(head.running).task())), std::memory_order_relaxed);
  head.background.store(writer_.longest(kLongBackground), std::memory_order_relaxed);
  head.attended.fetch_add(1, std::memory_order_release);
}

void Rtpu::listen(int timeout_ms) {
  Watched watched[] = {{channel_.descriptor()}, {over_.descriptor()}, {signals_.descriptor()}};
  if (await_ready(watched, milliseconds(timeout_ms)) <= 0) return peers_->clear();
  for (const Watched& one : watched)
    if (one.is_lost) end_without_descriptor();
  over_.reset();
  if (watched[0].is_ready) read_messages();
  for (SignalQueue::Arrived signal; watched[2].is_ready && signals_.take(signal);)
    end(keeper_->ending.load(std::memory_order_acquire) == 0 && parent_process_id() == start_.parent);
}

void Rtpu::read_messages() {
  KeeperMessage message;
  for (int descriptor = -1;;) {
    const Channel::Got got = channel_.receive(bytes_of(message), descriptor);
    if (got == Channel::Got::kNothing) return;
    if (got == Channel::Got::kClosed) {
      channel_ = Channel();
      keeper_is_gone_ = true;
      return end(false);
    }
    if (message.kind == KeeperMessage::Kind::kFinish) end(false);
    if (message.kind == KeeperMessage::Kind::kPeer) add_peer(message, descriptor);
    if (descriptor >= 0) ::close(descriptor);
  }
}

// Ignores a segment that does not match the application: its owner is not the peer that the keeper assumes. If memory
// is short, the rtpu goes on without the segment.
void Rtpu::add_peer(const KeeperMessage& message, int descriptor) {
  if (message.index == start_.peer) return;
  if (const auto offered = peers_->offer(message.index, message.incarnation, descriptor); offered)
    return Doorbell(bell()).ring();
  else if (start_.parent != 0)
    std::fprintf(stderr, "chimera-rtpu %s: goes on without the memory of peer %u: %s\n",
                 std::string(self().name).c_str(), message.index, offered.error().message.c_str());
}

// Ends this rtpu alone after a plain SIGTERM or for a job that hangs. If the keeper is gone or ends the run, all rtpus
// end; that also changes an end alone that has begun.
void Rtpu::end(bool is_alone) {
  if (is_ending_ && (is_alone || !ends_alone_)) return;
  if (!is_ending_) hang_watch_->begin_end(wall_.now());
  is_ending_ = true;
  if (board_) board_->line().end_waits();
  ends_alone_ = is_alone;
  edge_->rtpu_end().tell(is_alone);
  Doorbell(bell()).ring();
}

// Number of ended jobs of the task, as the loop's own thread has counted. Relaxed, pairs with nothing: only the growth
// of the number matters.
std::uint64_t Rtpu::jobs_of(TaskId task) const {
  if (task.index >= tasks_->tasks().size()) return 0;
  return __atomic_load_n(&tasks_->tasks()[task.index].profile.execution[CHIMERA_CYCLE].count, __ATOMIC_RELAXED);
}

// Always false on a preemptive rtpu: that executor has its own supervisor.
bool Rtpu::loop_hangs() {
  if (self().preemptive) return false;
  const TaskWord word = TaskWord::found(block_.head().running);
  const std::uint64_t beats = block_.head().beats + jobs_of(word.task());
  const bool is_cycle = word.has_method() && word.method() == Method::kCycle;
  const Nanoseconds used = is_cycle ? used_by(cycling_->thread()) : kNever;  // kNever also if that thread is gone
  if (used == kNever) return hang_watch_->loop_hangs(word.word(), beats, wall_.now());
  return hang_watch_->job_hangs(image_->spec().tasks[word.task().index], word.word(), beats, used, wall_.now());
}

// True if the keeper is gone. A process that ends closes its channels first and loses its children a little later. A
// small rtpu may have ended before that, so the parent id alone proves nothing.
bool Rtpu::is_without_keeper() {
  if (start_.parent == 0) return false;
  read_messages();
  return keeper_is_gone_ || parent_process_id() != start_.parent;
}

// Ends the processes that components left behind. The keeper does this as long as it lives.
void end_children_of_this_rtpu() {
  if (const char* mine = std::getenv(kOriginVariable); mine != nullptr) (void)end_all_from(mine, seconds(1));
}

}  // namespace

int run_rtpu(const RtpuStart& start) {
  Rtpu rtpu(start);
  if (auto ready = rtpu.prepare(); !ready) {
    if (start.parent != 0) std::fprintf(stderr, "chimera-rtpu: %s\n", plain_line(ready.error().message.view()).c_str());
    return kCouldNotStart;
  }
  const int code = rtpu.run();
  if (rtpu.is_without_keeper()) end_children_of_this_rtpu();
  // A process other than the keeper sent SIGTERM. The keeper then sees this signal as the cause of the death.
  if (code == kTerminated) end_by_signal(SIGTERM);
  // Threads may run component code: no destructor.
  if (code == kMethodHangs || code == kThreadLost || code == kBoardLost) std::_Exit(code);
  return code;
}

}  // namespace chimera
