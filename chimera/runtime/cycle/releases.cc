// SPDX-License-Identifier: Apache-2.0
// Builds the common half of an executor and handles the cycle boundaries of its context.
#include "chimera/runtime/cycle/releases.h"

#include "chimera/base/assert.h"

namespace chimera {
namespace {

// How long before its deadline a job of the task must start. `abort` refuses a start at the deadline itself.
Nanoseconds start_margin(const TaskSpec& spec) noexcept {
  if (spec.min_time > Nanoseconds{}) return spec.min_time;
  return spec.on_miss == OnMiss::kAbort ? Nanoseconds{1} : Nanoseconds{INT64_MIN / 2};
}

bool is_built(OnMiss reaction, bool can_demote, bool can_switch) noexcept {
  return (can_switch || reaction != OnMiss::kSwitch) && (can_demote || reaction != OnMiss::kDemote);
}

MissCause* cause_for(const BoundaryListener* guest, PartIf<mechanisms::kBlame, std::optional<MissCause>>& heard,
                     TaskSet& set, JobThreads& threads) {
  if constexpr (mechanisms::kBlame)
    if (guest != nullptr) return &heard->emplace(set.tasks(), threads, set.setup_memory());
  return nullptr;
}

QueueStorage storage_for(std::span<const TaskSpec> tasks, SetupMemory& memory) {
  const std::size_t n = tasks.size(), n_classes = TaskClasses::count(tasks);
  const std::size_t n_beside = mechanisms::kPreemptive ? n : 0, n_loose = mechanisms::kLooseJobs ? n : 0;
  return {{memory.take<ClassMember>(n), memory.take<TaskClass>(n_classes), memory.take<std::uint32_t>(n)},
          memory.take<QueueTask>(n_beside),
          memory.take<LooseJob>(n_loose),
          memory.take<std::uint32_t>(n_classes),
          memory.take<std::uint32_t>(n_classes)};
}

void follow(EventTasks& events, BoundarySignals& signals, Nanoseconds now) noexcept {
  if (events.are_none()) return;
  events.follow(now);
  signals.look_ahead_to(events.due());
}

}  // namespace

bool may_request(const ApplicationSpec& spec) noexcept {
  const auto reacts = [](const TaskSpec& task) {
    return task.on_miss == OnMiss::kSwitch || task.on_overrun == OnMiss::kSwitch ||
           task.on_fault_set != UINT16_MAX;
  };
  const bool has_choice = spec.sets.size() > 1 || (!spec.sets.empty() && spec.tasks.size() > 1);
  return has_choice || std::any_of(spec.tasks.begin(), spec.tasks.end(), reacts);
}

std::size_t kept_of_unscripted(const ApplicationSpec& spec) noexcept {
  return may_request(spec) || !spec.standbys.empty() ? 16 : 0;
}

Releases::Releases(TaskSet& set, JobClock& clock, const RunOptions& options)
    : set_(set), guest_(options.guest), stop_(options.stop != nullptr ? options.stop : &kNoStop),
      records_(set.setup_memory().take<JobRecord>(set.tasks().size())),
      tap_(set.tasks(), options.tap, options.rtpu, options.threads != nullptr, set.setup_memory(),
           options.digest),
      digest_(options.digest), in_loop_(set.tasks(), &queue_, options.preemptive),
      threads_(options.threads != nullptr ? *options.threads : in_loop_),
      cause_(cause_for(guest_, heard_, set, threads_)),
      queue_(options.policy, set.spec().tasks, storage_for(set.spec().tasks, set.setup_memory())),
      misses_(set.tasks(), records_, tap_, cause_, clock),
      jobs_(records_, tap_, misses_, cause_, clock, tap_.is_on() || digest_ != nullptr || guest_ != nullptr),
      events_({records_, queue_, set.sent(), options.events, options.tick}),
      members_(set.tasks(), records_, queue_, events_, tap_, guest_),
      settlement_({set, records_, tap_, members_, misses_, cause_, guest_}),
      switching_(Switching::Parts{set, queue_, threads_, members_, settlement_, tap_, misses_, clock}),
      signals_(set, options, tap_, settlement_, threads_, switching_.get()),
      recovery_(Recovery::Parts{set, settlement_, switching_.get(), signals_, queue_, threads_, guest_}) {
  const bool is_alone = set.others() == nullptr;
  const bool may_switch = mechanisms::kSwitch && (is_alone || options.switch_peers != nullptr);
  const bool takes_requests = may_switch && may_request(set.spec());
  SwitchPeers* peers = options.switch_peers;
  if constexpr (mechanisms::kSwitch) {
    const std::size_t n_switches = options.script.count(ScriptAct::Kind::kSwitch);
    CHIMERA_ASSERT(is_alone ? peers == nullptr : n_switches == 0);
    const std::size_t n_kept = n_switches + kept_of_unscripted(set.spec());
    const std::size_t n_receipts = options.receipts != nullptr ? std::min<std::size_t>(n_kept, 1) : n_kept;
    if (is_alone && n_receipts > 0) {
      LocalSwitches& switches = switches_->emplace();
      switches.prepare(set.spec(), 1, n_receipts, options.asked, set.setup_memory());
      if (options.receipts != nullptr) switches.read_by(*options.receipts);
      switches.join(0, set, !threads_.preempt());
      signals_.order_by(switches);
      peers = &switches.of(0);
    }
    switching_->prepare(peers);
    const bool takes_lists = options.asked != nullptr || options.switch_peers != nullptr;
    if (takes_requests)
      set.sent().allow_requests(set.setup_memory().take<TaskLists>(takes_lists ? set.tasks().size() : 0));
  }
  if constexpr (mechanisms::kRecovery) recovery_->prepare(peers);
  for (Task& task : set.tasks()) {
    const TaskSpec& spec = *task.spec;
    const bool can = options.preemptive || !set.is_mine(task.id);
    const bool switches = takes_requests || !set.is_mine(task.id);
    CHIMERA_ASSERT(mechanisms::kVerified ||
                   (is_built(spec.on_miss, can, switches) && is_built(spec.on_overrun, can, switches)));
    CHIMERA_ASSERT(mechanisms::kVerified || switches || spec.on_fault_set == UINT16_MAX);
    JobRecord& record = records_[task.id.index];
    record.task = &task;
    if (digest_ != nullptr && set.is_mine(task.id)) task.is_tapped = true;
    record.start_margin = start_margin(spec);
    record.is_plain = spec.tolerated_of == 0;
    record.budget = spec.budget > Nanoseconds{} ? spec.budget : kNever;
  }
  const auto has_events = [&](const Task& task) {
    return mechanisms::kEvents && task.spec->has_events && !options.preemptive && set.is_mine(task.id);
  };
  const auto n_events = std::count_if(set.tasks().begin(), set.tasks().end(), has_events);
  events_.prepare(static_cast<std::size_t>(n_events), set.setup_memory());
  for (Task& task : set.tasks())
    if (has_events(task)) events_.add(task);
  set.methods().run_by({&clock, options.threads, options.writer});
}

void Releases::begin(Nanoseconds origin) noexcept {
  origin_ = origin;
  if (mechanisms::kDigest && digest_ != nullptr) digest_->begin(origin);
  queue_.set_origin(origin);
  if constexpr (mechanisms::kSwitch) {
    if (*switches_) (*switches_)->begin(origin);
    switching_->begin(origin);
  }
  signals_.begin(origin);
  if constexpr (mechanisms::kEvents) events_.begin(origin);
  members_.follow_all(origin);
  follow(events_, signals_, origin);
}

void Releases::take_edge(Nanoseconds now, bool puts_off) noexcept {
  const bool is_in_row = puts_off && !queue_.is_empty() && queue_.next_release() > now;
  follow(events_, signals_, now);
  if (!events_.are_none() && !edge_is_due(now)) return;  // nothing else was due
  const bool is_for_others = signals_.next_act_in_row() <= now || set_.sent().has_pending() ||
                             (guest_ != nullptr && guest_->is_due(now));
  if (is_in_row && !is_for_others) return;
  signals_.act(now);
  if (guest_ != nullptr) {
    guest_->take(signals_, now);
    signals_.step(now);  // take() heard the bell for changes since the step in act(): it does not ring again
  }
  signals_.carry_out_pending(now);
  Nanoseconds due = kNever, wake = kNever;
  if constexpr (mechanisms::kRecovery) {
    recovery_->act(now);
    due = recovery_->due(), wake = recovery_->wake();
  }
  signals_.look_ahead(due, wake);
  members_.follow_all(now);
  follow(events_, signals_, now);
  settlement_.publish();
}

bool Releases::decide_start(const Job& job, Nanoseconds now) noexcept {
  const bool starts = misses_.decide_start(job, now);
  if (settlement_.is_unsettled(job.task)) settle_job(job.task, now);
  return starts;
}

void Releases::settle_job(TaskId task, Nanoseconds now) noexcept {
  look_again();
  settlement_.settle_job(task, now);
  if (events_.are_none()) return;
  events_.finish(task);
  signals_.look_ahead_to(events_.due());
}

}  // namespace chimera
