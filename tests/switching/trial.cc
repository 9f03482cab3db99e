// SPDX-License-Identifier: Apache-2.0
// Steps rtpus, plays their manager and their keeper, and judges after every step.
#include "tests/switching/trial.h"

#include <algorithm>
#include <optional>

namespace chimera::switching_trial {
namespace {

constexpr Nanoseconds kGrace = milliseconds(150);
constexpr int kTurnsOff = 3;  // of heal()

enum class Mishap : std::uint8_t { kNone, kRtpuDies, kRtpuDiesTelling, kManagerDies, kHoldUp, kCancel, kFlag, kSignal,
                                   kOnFails };

/// Failure in a switch, and its instant.
struct Plan {
  Mishap what = Mishap::kNone;
  std::uint32_t rtpu = 0;
  Nanoseconds at;      // from the announcement
  int call = 0;        // kRtpuDiesTelling: in which call of an rtpu, counted down
  bool is_over = false;
};

/// Journal of the manager, which survives its death.
struct Journal {
  std::uint16_t number = 0;
  bool is_open = false;
  std::uint32_t before = 0, after = 0;
  Nanoseconds until;
};

class Run {
 public:
  Run(std::uint64_t seed, Kind kind)
      : chance_(seed), kind_(kind), n_(kind == Kind::kOfModel || one_in(3) ? 2 : 3), application_(reset(n_)),
        rtpus_(application_.app, [this](std::uint32_t me, SwitchPeers& links) { return between(me, links); }),
        recorder_(rtpus_), held_until_(n_), incarnation_(n_ + 1, 1), back_at_(n_ + 1, kNever) {
    rest(milliseconds(1));
    heal();
  }

  Tally go(std::uint32_t n_switches) {
    while (is_well() && tally_.switches < n_switches && one_more()) {
    }
    tally_.events = recorder_.events();
    return tally_;
  }

 private:
  std::uint32_t draw(std::uint32_t n) { return static_cast<std::uint32_t>(chance_.below(n)); }
  bool one_in(std::uint32_t n) { return draw(n) == 0; }
  static std::uint32_t reset(std::uint32_t n_rtpus) {
    stage = {};
    return n_rtpus;
  }
  std::shared_ptr<SwitchPeers> between(std::uint32_t me, SwitchPeers& links) {
    auto made = std::make_shared<CutLinks>(links, [this, me] { told(me); });
    links_.resize(n_);
    links_[me] = made;
    return made;
  }
  bool is_well() const { return tally_.failure.empty(); }
  void fail(const std::string& what) {
    if (is_well()) tally_.failure = what + ", at " + std::to_string(rtpus_.now.count / 1000) + " us, plan " +
                                    std::to_string(plan().number);
  }
  PlanWord plan() const { return PlanWord::of(rtpus_.decision.switching.plan.load()); }
  SwitchAgreement agreement() { return {rtpus_.decision.switching, rtpus_.keeper.origin}; }
  bool lives(std::uint32_t peer) const { return rtpus_.keeper.alive[peer] != 0; }
  bool all_live() const {
    for (std::uint32_t peer = 0; peer <= n_; ++peer)
      if (!lives(peer)) return false;
    return true;
  }
  std::uint32_t rtpu_of(TaskId task) const { return application_.app.tasks[task.index].rtpu.index; }
  const Task& task(TaskId id) const { return rtpus_.rtpus[rtpu_of(id)]->tasks->tasks()[id.index]; }
  std::size_t n_tasks() const { return application_.app.tasks.size(); }
  bool is_on(TaskId id) const { return lives(rtpu_of(id)) && task(id).state == State::kOn; }
  static bool is_in(const std::vector<TaskId>& set, TaskId id) { return std::ranges::find(set, id) != set.end(); }
  std::vector<TaskId> watches() const {
    return n_ > 2 ? std::vector{kWatch0, kWatch1, kWatch2} : std::vector{kWatch0, kWatch1};
  }
  int outcome_of(std::uint16_t number) {
    const PlanWord now = plan();
    if (number != now.number) return is_committed_[number] ? 1 : -1;
    return now.is_open() ? 0 : now.phase == SwitchPhase::kCommitted ? 1 : -1;
  }

  // Runs in the middle of an edge, before and after each call of rtpu `me` to its peers.
  void told(std::uint32_t me) {
    look(me);
    if (mishap_.what != Mishap::kRtpuDiesTelling || mishap_.is_over || mishap_.rtpu != me) return;
    if (!journal_.is_open || mishap_.call-- > 0) return;
    mishap_.is_over = true;
    links_[me]->cut();
    died(me);
  }
  void look(std::uint32_t who) {
    if (kind_ == Kind::kOfModel) recorder_.look(who);
    const PlanWord now = plan();
    stage.open_plan = now.is_open() ? now.number : 0;
    if (now.phase != SwitchPhase::kCommitted || is_committed_[now.number]) return;
    is_committed_[now.number] = true;
    const TaskId producer = Application::producer(journal_.after);
    if (producer != Application::producer(journal_.before)) readers_.change(agreement().at(now), life_of(producer));
  }
  static std::uint32_t life_of(TaskId producer) {
    auto life = static_cast<std::uint32_t>(stage.lives.size() - 1);
    while (life > 0 && stage.lives[life].task != producer) --life;
    return life;
  }

  void died(std::uint32_t rtpu) {
    if (kind_ == Kind::kOfModel) recorder_.add("died", rtpu);
    ++tally_.rtpu_deaths;
    readers_.let_loose();
    for (const TaskId id : watches())
      if (rtpu_of(id) == rtpu) readers_.forget(id);
    if (kind_ == Kind::kAll) back_at_[rtpu] = rtpus_.now + microseconds(draw(8000));
  }
  void kill_rtpu(std::uint32_t rtpu) {
    if (!lives(rtpu)) return;
    died(rtpu);
    rtpus_.die(rtpu);
  }
  void kill_manager() {
    if (!lives(n_)) return;
    if (kind_ == Kind::kOfModel) recorder_.add("died", n_);
    ++tally_.manager_deaths;
    rtpus_.die(n_);
    back_at_[n_] = rtpus_.now + microseconds(draw(8000));
  }
  // The keeper.
  void bring_back() {
    for (std::uint32_t peer = 0; peer <= n_; ++peer) {
      if (lives(peer) || rtpus_.now < back_at_[peer]) continue;
      back_at_[peer] = kNever;
      for (const TaskId id : watches())
        if (rtpu_of(id) == peer) readers_.forget(id);
      if (peer < n_) rtpus_.start(peer, ++incarnation_[peer]);
      else rtpus_.start_manager(++incarnation_[peer]);
      rtpus_.change();
    }
  }

  void step(std::uint32_t u) {
    if (!lives(u) || rtpus_.now < held_until_[u]) return;
    testing::TestRtpu& rtpu = *rtpus_.rtpus[u];
    const Nanoseconds clock = rtpu.clock.now();
    if (held_until_[u] > Nanoseconds{} && clock < held_until_[u]) rtpu.clock.advance(held_until_[u] - clock);
    rtpu.serve();
    (void)rtpu.executive->run(rtpus_.now - rtpus_.keeper.origin);
    look(u);
    if (links_[u]->is_cut()) rtpus_.die(u);
    judge();
  }
  void pass(Nanoseconds time) {
    rtpus_.now += time;
    bring_back();
    std::vector<std::uint32_t> order;
    for (std::uint32_t u = 0; u < n_; ++u) order.insert(order.begin() + draw(u + 1), u);
    for (const std::uint32_t u : order) step(u);
    rtpus_.collect();
    rtpus_.posts.clear();
  }
  void rest(Nanoseconds time) {
    for (const Nanoseconds end = rtpus_.now + time; rtpus_.now < end && is_well();) pass(microseconds(100));
  }

  void judge() {
    for (const Look& look : stage.looks) {
      ++tally_.looks;
      const Nanoseconds period = application_.app.tasks[look.reader.index].period;
      const auto of_plan = [this](std::uint16_t number) { return outcome_of(number); };
      const std::string wrong = readers_.judge(look, period, of_plan);
      if (!wrong.empty()) fail(wrong);
    }
    stage.looks.clear();
    if (!readers_.is_strict()) return;
    if (rtpus_.flag_is_up()) fail("the flag is up");
    const bool is_changing = journal_.is_open && plan().phase == SwitchPhase::kCommitted;
    std::uint32_t n_producers = 0;
    for (const TaskId id : {kNear, kFar, kThird}) n_producers += id.index < n_tasks() && is_on(id);
    if (!is_changing && n_producers != 1) fail(std::to_string(n_producers) + " producers are ON");
  }

  // Acts as the manager after a restart of an rtpu, a signal or an error: orders the first set again.
  void heal() {
    readers_.let_loose();
    rest(milliseconds(2));  // the last rtpu has attached to the others
    for (int turn = 0; turn < 40 && is_well(); ++turn) {
      bool is_whole = true;
      for (std::size_t t = 0; t < n_tasks(); ++t) {
        const TaskId id(t);
        const State state = task(id).state;
        const bool wanted = is_in(application_.sets[kFirst], id);
        const Signal signal = state == State::kError ? Signal::kClear
                              : state == State::kNotCreated ? Signal::kSpawn
                              : state == State::kOn ? Signal::kOff : Signal::kOn;
        if (state == (wanted ? State::kOn : State::kOff)) continue;
        if (signal != Signal::kOff && turn < kTurnsOff) continue;  // never two producers
        is_whole = false;
        rtpus_.send(signal, {id});
        rest(microseconds(300));
      }
      if (!is_whole || turn < kTurnsOff) continue;
      rest(milliseconds(3));
      in_force_ = kFirst;
      readers_.begin(life_of(kNear));
      return rest(milliseconds(2));
    }
    fail("the first set does not come back");
  }
  bool needs_healing() const {
    for (std::size_t t = 0; t < n_tasks(); ++t)
      if (task(TaskId(t)).state == State::kError) return true;
    return !readers_.is_strict();
  }

  // False: nothing more can be switched.
  bool one_more() {
    while (is_well() && !all_live() && kind_ == Kind::kAll) rest(milliseconds(1));
    if (kind_ == Kind::kOfModel && !(lives(0) && lives(1))) return false;
    if (kind_ == Kind::kAll && needs_healing()) heal();
    announce();
    for (Nanoseconds limit; journal_.is_open && is_well();) {
      pass(microseconds(10 + draw(one_in(4) ? 400 : 120)));
      have_mishap(rtpus_.now - began_);
      if (lives(n_)) manage();
      limit = std::max(journal_.until, *std::ranges::max_element(held_until_)) + kGrace;
      if (journal_.is_open && rtpus_.now > limit + milliseconds(50)) fail("the switch does not end");
    }
    return is_well();
  }
  void announce() {
    if (!lives(n_)) return;
    const std::uint32_t n_sets = kind_ == Kind::kOfModel ? 2 : static_cast<std::uint32_t>(application_.sets.size());
    std::uint32_t next = draw(n_sets - 1);
    if (next >= in_force_) ++next;
    ++tally_.switches;
    draw_mishap();
    stage.on_takes = microseconds(draw(60));
    rest(microseconds(draw(2000)));
    const Nanoseconds wait = milliseconds(5 + draw(40));
    began_ = rtpus_.now;
    journal_ = {next_plan(plan().number), true, in_force_, next, rtpus_.now + wait};
    if (mishap_.what == Mishap::kManagerDies && mishap_.call == 0) return mishap_.is_over = true, kill_manager();
    stage.open_plan = journal_.number;
    rtpus_.switch_to(next, microseconds(draw(1500)), wait);
    if (kind_ == Kind::kOfModel) recorder_.look(n_);
  }
  void draw_mishap() {
    mishap_ = {};
    if (one_in(2)) return;
    constexpr Mishap kOfModel[] = {Mishap::kRtpuDies, Mishap::kRtpuDiesTelling, Mishap::kRtpuDiesTelling,
                                   Mishap::kManagerDies, Mishap::kHoldUp, Mishap::kCancel};
    mishap_.what = kind_ == Kind::kOfModel ? kOfModel[draw(6)] : static_cast<Mishap>(1 + draw(8));
    mishap_.rtpu = draw(n_);
    mishap_.at = microseconds(draw(one_in(2) ? 1200 : 5000));
    if (mishap_.what == Mishap::kCancel) mishap_.at = microseconds(draw(300));
    mishap_.call = static_cast<int>(draw(8));
    if (kind_ == Kind::kOfModel && tally_.manager_deaths > 0 && mishap_.what == Mishap::kManagerDies) mishap_ = {};
    if (mishap_.what == Mishap::kOnFails) stage.next_on_fails = true;
  }
  void have_mishap(Nanoseconds since) {
    if (mishap_.is_over || since < mishap_.at || !journal_.is_open) return;
    const Mishap what = mishap_.what;
    mishap_.is_over = what != Mishap::kRtpuDiesTelling;
    if (what == Mishap::kRtpuDies) kill_rtpu(mishap_.rtpu);
    if (what == Mishap::kManagerDies) kill_manager();
    if (what == Mishap::kHoldUp) hold_up(mishap_.rtpu);
    if (what == Mishap::kCancel && lives(n_)) abort_plan();
    if (what == Mishap::kFlag) raise(true);
    if (what == Mishap::kSignal) signal();
  }
  void hold_up(std::uint32_t rtpu) {
    ++tally_.hold_ups;
    held_until_[rtpu] = rtpus_.now + microseconds(100 + draw(6000));
    for (const TaskId id : watches())
      if (rtpu_of(id) == rtpu) readers_.excuse(id, held_until_[rtpu] + milliseconds(4));
  }
  void raise(bool up) {
    readers_.let_loose();
    rtpus_.manager->block.head().flag = up ? 1 : 0;
    rtpus_.change();
  }
  void signal() {
    const TaskId members[] = {kNear, kExtra, kShape, kFar};
    const TaskId id = members[draw(4)];
    if (!all_live() || !readers_.is_strict()) return;  // they may not be attached yet
    ++tally_.signals;
    readers_.let_loose();
    rtpus_.send(one_in(3) ? Signal::kKill : Signal::kOff, {id});
  }
  void abort_plan() {
    if (!agreement().abort(journal_.number)) return;
    if (kind_ == Kind::kOfModel) recorder_.look(n_);
    rtpus_.change();
  }

  // The manager, or its successor, which knows the journal.
  void manage() {
    if (!journal_.is_open) return;
    if (plan().number != journal_.number) {  // the manager died before the announcement
      journal_.is_open = false;
      return;
    }
    if (rtpus_.now > journal_.until + milliseconds(100)) abort_plan();
    if (plan().is_open() || !is_over()) return;
    file();
  }
  bool is_over() const { return rtpus_.is_over(journal_.number); }
  void file() {
    if (kind_ == Kind::kOfModel) recorder_.add("filed", n_);
    journal_.is_open = false;
    const bool is_done = plan().phase == SwitchPhase::kCommitted;
    ++(is_done ? tally_.done : tally_.aborted);
    in_force_ = is_done ? journal_.after : journal_.before;
    judge_end(is_done);
    stage.next_on_fails = false;
    if (mishap_.what == Mishap::kFlag && mishap_.is_over) raise(false);
  }
  void judge_end(bool is_done) {
    for (std::uint32_t u = 0; u < n_; ++u) {
      if (!lives(u)) continue;
      const SwitchPart& part = rtpus_.part(u);
      if (part.number != journal_.number) fail("an rtpu has no part in the receipt");
      const bool was_there = incarnation_[u] == 1 || part.n_tasks > 0;
      if (was_there && (part.end == SwitchEnd::kDone) != is_done) fail("the end in a part differs from the plan");
      if (is_done && readers_.is_strict() && held_until_[u] + milliseconds(4) < began_) judge_losses(part);
    }
    for (std::size_t t = 0; t < n_tasks(); ++t) {
      const TaskId id(t);
      if (!lives(rtpu_of(id))) continue;
      if (task(id).owes_off) fail("task " + std::to_string(t) + " is armed for nothing");
      if (readers_.is_strict() && is_on(id) != is_in(application_.sets[in_force_], id))
        fail("task " + std::to_string(t) + (is_on(id) ? " is ON" : " is not ON"));
    }
  }
  void judge_losses(const SwitchPart& part) {
    for (std::uint32_t i = 0; i < part.n_tasks; ++i)
      if (part.tasks[i].lost != 0) fail("task " + std::to_string(part.tasks[i].task.index) + " lost a cycle");
  }

  simulated::Chance chance_;
  Kind kind_;
  std::uint32_t n_;
  Application application_;
  std::vector<std::shared_ptr<CutLinks>> links_;
  testing::TestRtpus rtpus_;
  Recorder recorder_;
  Readers readers_;
  Journal journal_;
  Nanoseconds began_;
  Plan mishap_;
  std::uint32_t in_force_ = kFirst;
  std::array<bool, 65536> is_committed_{};
  std::vector<Nanoseconds> held_until_;
  std::vector<std::uint32_t> incarnation_;
  std::vector<Nanoseconds> back_at_;
  Tally tally_;
};

}  // namespace

Tally run_trial(std::uint64_t seed, std::uint32_t n_switches, Kind kind) {
  return std::make_unique<Run>(seed, kind)->go(n_switches);
}

}  // namespace chimera::switching_trial
