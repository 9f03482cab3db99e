// SPDX-License-Identifier: Apache-2.0
// The loop that drives the step function of a subsystem on Linux: it waits for the keeper, the rtpus and the clock. If
// it is killed at any moment, its successor continues from the segments.
#pragma once

#include <array>
#include <memory>

#include "chimera/manager/act/drill.h"
#include "chimera/manager/act/rtpu_links.h"
#include "chimera/manager/act/step_runner.h"
#include "chimera/manager/answer/event_archive.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/manager/switch/receipt_archive.h"
#include "chimera/manager/switch/switch_coordinator.h"
#include "chimera/manager/switch/switch_wishes.h"
#include "chimera/manager/switch/takeover_receipts.h"
#include "chimera/manager/watch/bell_watch.h"
#include "chimera/manager/watch/face_watch.h"
#include "chimera/manager/watch/guard_news.h"
#include "chimera/manager/watch/rtpu_health.h"
#include "chimera/manager/watch/rtpu_watch.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/runtime/hosted/application_image.h"

namespace chimera::manager {

/// Descriptors that the keeper passes on. ManagerLoop owns them.
struct Inherited {
  int channel = kChannelDescriptor;
  int image = kImageDescriptor;
  int decision_page = kDecisionPageDescriptor;
  int keeper_page = kKeeperPageDescriptor;
  int listening = kListeningDescriptor;
  int bundle = kBundleDescriptor;
};

/// Context: setup. Single-threaded except for the bell watch.
class ManagerLoop {
 public:
  /// Maps the inherited memory, waits for the keeper's inventory, makes its own segment and passes it on. Refuses
  /// memory that is not as documented; null if the keeper is gone. May block until the inventory is complete.
  static Result<std::unique_ptr<ManagerLoop>> start(const Inherited& inherited, std::uint32_t incarnation,
                                                    std::int32_t keeper_pid);
  ManagerLoop(const ManagerLoop&) = delete;
  ManagerLoop& operator=(const ManagerLoop&) = delete;
  ~ManagerLoop();

  /// One round: waits until a step is due, for `at_most`, or until `also` or `or_else` is readable; then handles all of
  /// its own input. False when the keeper is gone or has asked it to finish.
  bool step(Nanoseconds at_most = kNever, int also = -1, int or_else = -1);
  /// Requests a signal; calls `answered` when it is over, maybe at once.
  void command(Signal signal, std::vector<TaskId> tasks, Answered answered) {
    steps_->command(signal, std::move(tasks), std::move(answered));
  }
  /// Requests a switch for a person, who named the tasks `off`; as SwitchCoordinator::ask().
  void switch_to(const TaskBits& on, const TaskBits& off, Asker asked_by, Nanoseconds wait, Nanoseconds now,
                 Switched switched);
  /// Rings doorbells, as RtpuLinks::ring.
  RtpuId ring(std::span<const TaskId> tasks);
  /// Call it after step() returned false. Files the remaining receipts and events; may block for most of the second
  /// that the keeper waits.
  void finish();
  /// Has the keeper end the whole run. The next step() sends the request, after the client got its answer.
  void end(std::int32_t code);
  /// Gives the listening socket away, once.
  int take_listening() noexcept;
  /// Descriptor of the bundle, for other processes; ManagerLoop keeps it.
  int bundle() const noexcept;

  ManagerState& state() noexcept { return *state_; }
  SwitchCoordinator& switches() noexcept { return *switches_; }
  const ReceiptArchive& receipts() const noexcept { return *receipts_; }
  Drill& drill() noexcept { return *drill_; }
  /// True if the step function has the whole inventory. Clients are served from then on.
  bool is_ready() const noexcept { return is_ready_; }
  /// The files of receipts and of events.
  std::array<Filing*, 2> filings() const noexcept { return {&receipts_->filing(), &events_->filing()}; }

 private:
  struct Mapped;
  explicit ManagerLoop(std::unique_ptr<Mapped> mapped);
  Result<bool> take_inventory(std::uint32_t incarnation, std::int32_t keeper_pid);
  void say_hello();
  bool take_messages();
  void take(const KeeperMessage& message, int passed);
  void look();
  void become_ready();
  void pass_end_on();
  void look_at_keeper();
  void watch();
  void end_rtpu(RtpuId rtpu);
  Nanoseconds next_due() const noexcept;
  void wait(Nanoseconds until, int also, int or_else);

  std::unique_ptr<Mapped> mapped_;
  std::unique_ptr<ManagerState> state_;
  std::unique_ptr<RtpuLinks> rtpu_links_;
  std::unique_ptr<StepRunner> steps_;
  std::unique_ptr<EventArchive> events_;
  std::unique_ptr<ReceiptArchive> receipts_;
  std::unique_ptr<SwitchCoordinator> switches_;
  std::unique_ptr<SwitchWishes> wishes_;
  std::unique_ptr<TakeoverReceipts> takeovers_;
  std::unique_ptr<Drill> drill_;
  std::unique_ptr<RtpuWatch> watch_;
  std::uint64_t keeper_beats_ = 0;  // number of the keeper's last answered beat
  std::unique_ptr<RtpuHealth> health_;
  std::unique_ptr<BellWatch> bell_;
  Nanoseconds begun_;
  Nanoseconds counters_due_;
  bool is_ready_ = false;
  std::optional<std::int32_t> end_wish_;
  bool is_ending_ = false;
  bool is_finished_ = false;
  FaceWatch face_watch_;
  GuardWatch guard_watch_;
};

}  // namespace chimera::manager
