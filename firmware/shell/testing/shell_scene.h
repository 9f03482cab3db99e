// SPDX-License-Identifier: Apache-2.0
// For tests: the shell of a small application whose executive runs on a stepped clock. Jobs take no time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"
#include "firmware/shell/shell.h"

namespace chimera::firmware::testing {

/// Orders to the components of the running scene.
struct Orders {
  bool gain_faults = false, gain_recovers = false, spare_refuses = false, spare_is_slow = false;
};
inline Orders orders;

struct Wave {
  Out<double> y{"y", "m/s", initial = 0.0};
  void cycle(Cycle c) { *y = 0.25 * static_cast<double>(c.count() % 100); }
};

/// Produces y too.
struct Spare {
  Out<double> y{"y", "m/s", initial = 0.0};
  Out<double> late{"late", "1"};
  Outcome on(Cycle) {
    if (orders.spare_is_slow) return not_yet();
    return orders.spare_refuses ? fault("no current") : ok();
  }
  void cycle(Cycle) { *y = 7; }
};

struct Gain {
  In<double> y{"y", "m/s"};
  In<double> k{"k", "N.s/m"};
  In<std::int64_t> n{"n", "1"};
  Out<double> u{"u", "N", initial = 0.0};
  Out<double[]> list{"list", "rad", "[3]", initial = 0.5};
  Outcome cycle(Cycle) {
    if (orders.gain_faults) return fault("the gain\nis broken", 42);
    *u = *k * *y + static_cast<double>(*n);
    for (std::size_t i = 0; i < 3; ++i) list[i] = 0.5 * static_cast<double>(i);
    return ok();
  }
  bool error(Cycle) { return orders.gain_recovers; }
};

inline constexpr TaskId kWave{0u}, kSpare{1u}, kGain{2u};

/// Two configurations: "normal" is wave and gain, "reserve" is spare and gain.
class ShellScene : private Clock, private JobClock, private DigestLines {
 public:
  ShellScene() {
    orders = {};
    app_.add("wave", chimera::testing::component<Wave>("wave")).rtpu = RtpuId(0u);
    app_.add("spare", chimera::testing::component<Spare>("spare")).rtpu = RtpuId(0u);
    app_.add("gain", chimera::testing::component<Gain>("gain")).rtpu = RtpuId(0u);
    for (std::uint32_t t = 0; t < 3; ++t)
      for (std::uint32_t p = 0; p < app_.components[t]->n_ports; ++p)
        app_.port(t, p).unit = app_.components[t]->ports[p].unit;
    app_.port(2, 4).extent[0].max = 3;
    app_.give(app_.operators, "k", CHIMERA_FLOAT64, chimera::testing::bytes_of(2.0));
    app_.give(app_.operators, "n", CHIMERA_INT64, chimera::testing::bytes_of(std::int64_t{0}));
    app_.make(normal_, false);
    app_.spec.sets = sets_;
    app_.spec.on_order = normal_on_order_;
    set_ = *HeapTaskSet::create(app_.spec, app_.components);
    listener_.emplace(*set_, heap_);
    digest_.emplace(3, static_cast<DigestLines&>(*this), heap_);
    RunOptions options;
    options.guest = &*listener_;
    options.digest = &*digest_;
    executive_.emplace(*set_, static_cast<Clock&>(*this), static_cast<JobClock&>(*this), options);
    EXPECT_TRUE(executive_->start());
  }
  ~ShellScene() { executive_->shut_down(); }

  void use(std::span<const Stack> stacks, const Watchdog* watchdog = nullptr, const Boot* boot = nullptr) {
    shell_.emplace(ShellParts{*set_, executive_->releases(), *listener_, stacks, watchdog, boot});
  }
  /// Adds bytes to the input of the line. They arrive as fast as the shell accepts them.
  void type(std::string_view bytes) { input_.insert(input_.end(), bytes.begin(), bytes.end()); }
  /// Runs for that number of periods of 1 ms. Returns what the shell printed, with '\n' at the ends of lines.
  std::string run(int periods) {
    until_ += milliseconds(periods);
    EXPECT_EQ(executive_->run(until_), RunEnd::kTime);
    std::string said;
    for (const char c : output_)
      if (c != '\r') said += c;
    output_.clear();
    return said;
  }
  /// The lines that a command prints, and its answer.
  std::string ask(std::string_view command) {
    type(std::string(command) + "\n");
    std::string said;
    for (int i = 0; i < 100 && !is_answered(said); ++i) said += run(1);
    return said;
  }
  /// Ends the run and returns its digest.
  std::vector<DigestLine> end() {
    digest_->end();
    return lines_;
  }

  Shell& shell() { return *shell_; }
  TaskSet& set() { return *set_; }
  Executive& executive() { return *executive_; }
  ShellListener& listener() { return *listener_; }
  State state(TaskId task) { return set_->tasks()[task.index].state; }
  double value(std::string_view name) {
    for (std::size_t v = 0; v < app_.spec.variables.size(); ++v) {
      if (app_.spec.variables[v].name != name) continue;
      double number = 0;
      std::memcpy(&number, set_->sources().view(VariableId(v)).value, sizeof number);
      return number;
    }
    ADD_FAILURE() << "no variable " << name;
    return 0;
  }
  std::uint64_t steps() const { return steps_; }
  std::size_t most_bytes_sent() const { return most_sent_; }

 private:
  static bool is_answered(const std::string& said) {
    const std::size_t last = said.size() < 2 ? std::string::npos : said.rfind('\n', said.size() - 2);
    const std::string line = last == std::string::npos ? said : said.substr(last + 1);
    return line == "ok\n" || line.starts_with("no: ");
  }
  Nanoseconds now() noexcept override { return now_; }
  void spend(Nanoseconds time) noexcept override { now_ += time; }
  // As the clock of an image: the shell works until there is nothing to do, or until a cycle boundary is due.
  WaitEnd wait_until(Nanoseconds instant) noexcept override {
    listener_->look(now_);
    if (!shell_) use({});
    while (!listener_->is_due(now_)) {
      const bool has_input = receive();
      send();
      if (shell_->has_work()) step();
      else if (!has_input) break;
    }
    if (listener_->is_due(now_)) return WaitEnd::kWoken;
    now_ = std::max(now_, instant);
    return WaitEnd::kReached;
  }
  // Bytes arrive while the shell has nothing to do, or at any time if `is_hasty`.
  bool receive() {
    if (input_.empty() || (!is_hasty && shell_->has_work())) return false;
    const std::size_t n = std::min<std::size_t>(is_hasty ? 512 : 40, input_.size());
    for (std::size_t i = 0; i < n; ++i) {
      shell_->receive(static_cast<std::uint8_t>(input_.front()));
      input_.pop_front();
    }
    return true;
  }
  void step() {
    shell_->step(now_);
    ++steps_;
    most_sent_ = std::max(most_sent_, send());
  }
  std::size_t send() {
    std::size_t sent = 0;
    for (int byte = 0; sends && (byte = shell_->next_byte()) >= 0; ++sent) output_ += static_cast<char>(byte);
    return sent;
  }
  void take(const DigestLine& line) noexcept override { lines_.push_back(line); }

  std::vector<TaskId> normal_{kWave, kGain}, reserve_{kSpare, kGain}, normal_on_order_{kWave, kSpare, kGain};
  NamedSet sets_[2] = {{"normal", normal_}, {"reserve", reserve_}};
  chimera::testing::TestApplication app_;
  HeapMemory heap_;
  std::unique_ptr<HeapTaskSet> set_;
  std::optional<ShellListener> listener_;
  std::optional<Digest> digest_;
  std::optional<Executive> executive_;
  std::optional<Shell> shell_;
  std::deque<char> input_;
  std::string output_;
  std::vector<DigestLine> lines_;
  Nanoseconds now_, until_;
  std::uint64_t steps_ = 0;
  std::size_t most_sent_ = 0;

 public:
  bool is_hasty = false;  ///< bytes arrive while the shell works
  bool sends = true;      ///< the line accepts bytes
};

}  // namespace chimera::firmware::testing
