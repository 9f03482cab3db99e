// SPDX-License-Identifier: Apache-2.0
// The simulated manager: gives events to a real Subsystem and carries its actions out, until it dies between two of
// them and another one takes over.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "tests/subsystem/world.h"

namespace chimera::simulated {

class ManagerLoop {
 public:
  explicit ManagerLoop(ManagerState& world);

  void start();
  void die(const char* point);
  /// Dies while it carries out what the next event leads to.
  void doom() noexcept { is_doomed_ = true; }
  bool is_doomed() const noexcept { return is_doomed_; }

  bool is_alive() const noexcept { return subsystem_ != nullptr; }
  std::uint32_t life() const noexcept { return life_; }
  bool is_in_inventory() const noexcept { return is_alive() && !is_complete_; }
  const subsystem::Subsystem& subsystem() const noexcept { return *subsystem_; }

  /// Something is there to be read.
  void poke();
  void serves(RtpuId rtpu, std::uint32_t incarnation, std::uint32_t manager);
  void ended(RtpuId rtpu, std::uint32_t incarnation);

 private:
  struct Message {
    enum class Kind { kServes, kEnded, kComplete } kind;
    RtpuId rtpu;
    std::uint32_t incarnation = 0;
  };
  void poll();
  bool take(const Message& message);
  bool take_ended(const Message& message);
  bool is_readable(RtpuId rtpu) const;
  bool tell_words(RtpuId rtpu);
  bool tell_word(TaskId task);
  bool take_notes(RtpuId rtpu);
  bool take_commands();
  bool feed(const subsystem::Event& event);
  std::size_t cut(std::size_t n_actions);
  void carry_out(const subsystem::Action& action);
  void send(const subsystem::Send& send);
  void answer(const subsystem::CommandAnswer& answer);
  void tell(const subsystem::LogEvent& tell);
  void plan_tick();

  ManagerState& world_;
  std::unique_ptr<subsystem::Subsystem> subsystem_;
  std::uint32_t life_ = 0;
  bool is_complete_ = false;
  bool is_doomed_ = false;
  bool poll_is_due_ = false;
  bool tells_of_mute_ = false;    // the words of a process that does not serve it yet, too
  std::vector<bool> is_served_;
  std::deque<Message> messages_;
  std::vector<std::optional<TaskStatus>> told_;
  std::vector<std::size_t> taken_;  // notes, by rtpu
  std::vector<std::pair<std::uint64_t, std::size_t>> asked_;  // command, face
  std::deque<subsystem::Event> believed_;  // what a defect makes it believe
  std::uint64_t commands_ = 0;
  Nanoseconds tick_{kNever};
};

}  // namespace chimera::simulated
