// SPDX-License-Identifier: Apache-2.0
// The loop of the manager: the inventory first, then messages of the keeper, posts of the rtpus, and due steps.
#include "chimera/manager/manager_loop.h"

#include <algorithm>
#include <utility>

#include "chimera/control/state_folder.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/wake.h"

namespace chimera::manager {
namespace {

constexpr Nanoseconds kCountersEvery = milliseconds(100);
constexpr Nanoseconds kServingLimit = milliseconds(500);  // then clients are served, even if an rtpu does not serve yet
constexpr Nanoseconds kLookEvery = milliseconds(2);   // while an rtpu does not serve it yet: no bell rings for that

}  // namespace

/// Memory that stays mapped while ManagerLoop lives. Members refer to those before them.
struct ManagerLoop::Mapped {
  Channel channel;
  FrozenBytes image_bytes, bundle_bytes;
  SharedPages decision;
  MemoryRegion keeper;
  std::optional<ApplicationImage> image;
  std::optional<Bundle> bundle;
  int listening = -1;

  ~Mapped() { const OwnedDescriptor ended(listening); }
  DecisionPage& decision_page() const noexcept { return *reinterpret_cast<DecisionPage*>(decision.bytes().data()); }
  const KeeperPage& keeper_page() const noexcept { return *reinterpret_cast<const KeeperPage*>(keeper.bytes().data()); }

  Result<void> open(const Inherited& from) {
    channel = Channel(from.channel);
    listening = from.listening;
    auto frozen_image = FrozenBytes::open(from.image);
    auto frozen_bundle = FrozenBytes::open(from.bundle);
    auto shared = SharedPages::open(from.decision_page, sizeof(DecisionPage));
    auto keepers = MemoryRegion::open_read_only(from.keeper_page, sizeof(KeeperPage));
    for (const int descriptor : {from.image, from.bundle, from.decision_page, from.keeper_page})
      const OwnedDescriptor inherited(descriptor);
    if (!frozen_image) return frozen_image.error();
    if (!frozen_bundle) return frozen_bundle.error();
    if (!shared) return shared.error();
    if (!keepers) return keepers.error();
    image_bytes = *std::move(frozen_image);
    bundle_bytes = *std::move(frozen_bundle);
    decision = *std::move(shared);
    keeper = *std::move(keepers);
    auto decoded = ApplicationImage::decode(image_bytes.bytes());
    if (!decoded) return decoded.error();
    image.emplace(*std::move(decoded));
    const auto text = bundle_bytes.bytes();
    auto read = decode_bundle({reinterpret_cast<const char*>(text.data()), text.size()});
    if (!read) return read.error();
    bundle.emplace(*std::move(read));
    return {};
  }
};

ManagerLoop::ManagerLoop(std::unique_ptr<Mapped> mapped) : mapped_(std::move(mapped)) {}

ManagerLoop::~ManagerLoop() = default;

Result<std::unique_ptr<ManagerLoop>> ManagerLoop::start(const Inherited& inherited, std::uint32_t incarnation,
                                                        std::int32_t keeper_pid) {
  auto mapped = std::make_unique<Mapped>();
  if (const auto opened = mapped->open(inherited); !opened) return opened.error();
  std::unique_ptr<ManagerLoop> loop(new ManagerLoop(std::move(mapped)));
  const auto complete = loop->take_inventory(incarnation, keeper_pid);
  if (!complete) return complete.error();
  if (!*complete) return std::unique_ptr<ManagerLoop>();
  return loop;
}

/// Reads all messages of the keeper before `complete`. Only after them it is known if there is a predecessor.
Result<bool> ManagerLoop::take_inventory(std::uint32_t incarnation, std::int32_t keeper_pid) {
  std::vector<std::pair<KeeperMessage, int>> inventory;
  for (KeeperMessage message; inventory.empty() || message.kind != KeeperMessage::Kind::kComplete;) {
    int passed = -1;
    const Channel::Got got = mapped_->channel.receive(bytes_of(message), passed);
    if (got == Channel::Got::kClosed) return false;
    if (got == Channel::Got::kMessage) {
      inventory.emplace_back(message, passed);
    } else {
      const int descriptors[] = {mapped_->channel.descriptor()};
      await_readable(descriptors, kNever);
    }
  }
  auto peers = Peers::create(mapped_->image->spec());
  if (!peers) return peers.error();
  PeerSegment predecessor;
  for (auto& [message, passed] : inventory) {
    if (message.kind != KeeperMessage::Kind::kPeer || message.index != peers->n_rtpus() || passed < 0) continue;
    const OwnedDescriptor left(std::exchange(passed, -1));
    auto opened =
        PeerSegment::open(left.fd, peers->manager_layout(), peers->n_tasks(), peers->n_rtpus(), message.incarnation);
    if (opened) predecessor = *std::move(opened);
  }
  auto own = OwnSegment::make(*peers, incarnation, predecessor.is_there() ? &predecessor : nullptr, now());
  if (!own) return own.error();
  KeeperMessage made;
  if (!mapped_->channel.send(bytes_of(made), own->descriptor())) return false;
  state_ = std::make_unique<ManagerState>(*std::move(mapped_->bundle), *std::move(peers), *std::move(own),
                                          mapped_->decision_page(), mapped_->keeper_page());
  state_->keeper_pid = keeper_pid;
  rtpu_links_ = std::make_unique<RtpuLinks>(*state_);
  watch_ = std::make_unique<RtpuWatch>(*state_);
  health_ = std::make_unique<RtpuHealth>(*state_);
  auto bell = BellWatch::start(Doorbell(mapped_->decision_page().bells[state_->own.peer()].word));
  if (!bell) return bell.error();
  bell_ = *std::move(bell);
  steps_ = std::make_unique<StepRunner>(*state_, *rtpu_links_, mapped_->channel);
  const std::string folder = control::state_folder_of(std::string(state_->spec().name));
  auto events = EventArchive::start(*state_, folder);
  if (!events) return events.error();
  events_ = *std::move(events);
  auto receipts = ReceiptArchive::start(*state_, folder);
  if (!receipts) return receipts.error();
  receipts_ = *std::move(receipts);
  switches_ = std::make_unique<SwitchCoordinator>(*state_, *receipts_);
  wishes_ = std::make_unique<SwitchWishes>(*state_, *switches_);
  takeovers_ = std::make_unique<TakeoverReceipts>(*state_, *receipts_);
  drill_ = std::make_unique<Drill>(*state_, [this](RtpuId rtpu) { end_rtpu(rtpu); });
  begun_ = counters_due_ = now();
  say_hello();
  steps_->begin();
  for (const auto& [message, passed] : inventory) take(message, passed);
  return true;
}

/// Logs the first event of every manager.
void ManagerLoop::say_hello() {
  std::string text = "manager started";
  if (state_->own.incarnation() > 1) text += " again, incarnation " + std::to_string(state_->own.incarnation());
  state_->tell("manager-started", TaskId{}, RtpuId{}, text, now());
}

bool ManagerLoop::take_messages() {
  KeeperMessage message;
  int passed = -1;
  while (true) {
    switch (mapped_->channel.receive(bytes_of(message), passed)) {
      case Channel::Got::kClosed:
        return false;
      case Channel::Got::kNothing:
        return true;
      case Channel::Got::kMessage:
        take(message, passed);
    }
  }
}

void ManagerLoop::take(const KeeperMessage& message, int passed) {
  using Kind = KeeperMessage::Kind;
  Events events;
  if (message.kind == Kind::kPeer && message.index < state_->peers.n_rtpus()) {
    if (is_ready_) takeovers_->look(now());  // reads the words of the incarnation before, which are unmapped next
    rtpu_links_->mapped(message, std::exchange(passed, -1));
  } else if (message.kind == Kind::kStarted) {
    rtpu_links_->started(message);
  } else if (message.kind == Kind::kEnded) {
    rtpu_links_->ended(message, events);
  } else if (message.kind == Kind::kFinish) {
    is_finished_ = true;
  } else if (message.kind == Kind::kHung) {
    watch_->told(message, now());
  } else {
    drill_->take(message);
    tell_of_guard(*state_, message, now());
  }
  const OwnedDescriptor unused(passed);
  steps_->step(events);
}

void ManagerLoop::look() {
  Events events;
  rtpu_links_->look(events);
  health_->look(now());  // before a task of a new rtpu is ON
  steps_->step(events);
  if (!is_ready_ && (rtpu_links_->all_up() || now() - begun_ > kServingLimit)) become_ready();
}

void ManagerLoop::become_ready() {
  is_ready_ = true;
  steps_->step(subsystem::InventoryComplete{});
}

void ManagerLoop::switch_to(const TaskBits& on, const TaskBits& off, Asker asked_by, Nanoseconds wait, Nanoseconds now,
                            Switched switched) {
  steps_->note_switch(on, off);
  const SwitchRequest asked{set_of(state_->spec(), on), SwitchCause::kScript, {}};
  switches_->ask(asked, on, asked_by, wait, now, std::move(switched));
}

RtpuId ManagerLoop::ring(std::span<const TaskId> tasks) { return rtpu_links_->ring(tasks, now()); }

void ManagerLoop::end(std::int32_t code) { end_wish_ = code; }

void ManagerLoop::pass_end_on() {
  if (!end_wish_) return;
  KeeperMessage message;
  message.kind = KeeperMessage::Kind::kEnd;
  message.code = *std::exchange(end_wish_, std::nullopt);
  // Not sent: the keeper ends the run already.
  [[maybe_unused]] const bool sent = mapped_->channel.send(bytes_of(message));
}

int ManagerLoop::bundle() const noexcept { return mapped_->bundle_bytes.descriptor(); }

int ManagerLoop::take_listening() noexcept { return std::exchange(mapped_->listening, -1); }

void ManagerLoop::look_at_keeper() {
  face_watch_.look(*state_, now());
  guard_watch_.look(*state_, now());
  if (is_ending_ || !state_->is_ending()) return;
  is_ending_ = true;
  receipts_->filing().try_again(now());  // before the run client asks which ones are not filed
  state_->tell("ending", TaskId{}, RtpuId{}, "the subsystem is ending", now());
}

/// Answers each beat of the keeper with one beat, so that the keeper's channel never fills.
void ManagerLoop::watch() {
  KeeperMessage message;
  message.kind = KeeperMessage::Kind::kBeat;
  message.index = state_->own.peer();
  const std::uint64_t beats = state_->keeper.beats.load(std::memory_order_acquire);
  if (beats != keeper_beats_ && mapped_->channel.send(bytes_of(message))) keeper_beats_ = beats;
  if (now() < watch_->due()) return;
  for (const RtpuId rtpu : watch_->look(now())) end_rtpu(rtpu);
}

void ManagerLoop::end_rtpu(RtpuId rtpu) {
  KeeperMessage message;
  message.kind = KeeperMessage::Kind::kEndChild;
  message.index = rtpu.index;
  message.incarnation = state_->rtpus[rtpu.index].incarnation;
  [[maybe_unused]] const bool sent = mapped_->channel.send(bytes_of(message));  // not sent: the keeper hangs
}

Nanoseconds ManagerLoop::next_due() const noexcept {
  Nanoseconds due = std::min(
      {steps_->next_due(), receipts_->next_due(), events_->filing().next_due(), drill_->next_due(), counters_due_,
       watch_->due()});
  if (is_ready_) due = std::min(due, switches_->next_due());
  if (!is_ready_ || !rtpu_links_->all_up()) due = std::min(due, now() + kLookEvery);
  return due;
}

/// Ignores negative descriptors.
void ManagerLoop::wait(Nanoseconds until, int also, int or_else) {
  const int descriptors[] = {mapped_->channel.descriptor(), bell_->descriptor(), receipts_->descriptor(), also,
                             or_else, events_->filing().descriptor()};
  await_readable(descriptors, std::min(until - now(), seconds(1)));
}

bool ManagerLoop::step(Nanoseconds at_most, int also, int or_else) {
  pass_end_on();  // the request for the end has been answered before
  wait(std::min(next_due(), at_most), also, or_else);
  bell_->reset();
  if (!take_messages()) return false;
  look_at_keeper();
  look();
  watch();
  if (now() >= counters_due_) {
    rtpu_links_->look_at_counters(now());
    counters_due_ = now() + kCountersEvery;
  }
  steps_->look(now());
  if (is_ready_) {  // before that, the tasks that are ON are not known
    switches_->look(now());
    for (const RtpuId rtpu : switches_->overdue(now())) end_rtpu(rtpu);
    wishes_->look(now());
    takeovers_->look(now());
  }
  receipts_->look(now());
  events_->look(now());
  drill_->look(now());
  return !is_finished_;
}

void ManagerLoop::finish() {
  const Nanoseconds until = now() + milliseconds(800);
  for (Filing* const filing : filings()) filing->flush(until - now());
}

}  // namespace chimera::manager
