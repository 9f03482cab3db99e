// SPDX-License-Identifier: Apache-2.0
// The parent of a subsystem's processes: starts them, passes their memory on, waits for their ends, and decides
// nothing. docs/formats/processes.md, "Keeper messages" and "Ending".
#pragma once

#include <string>
#include <vector>

#include "chimera/keeper/kept_face.h"
#include "chimera/keeper/kept_peers.h"
#include "chimera/platform/life_watch.h"
#include "chimera/platform/signal_queue.h"

namespace chimera {

struct KeeperPlan {
  PeerPlan peers;
  std::vector<std::string> face;          ///< program and arguments of the run client; empty: none
  Nanoseconds face_limit = seconds(2);    ///< to take its last values after SIGTERM; and to finish after the rtpus
  Nanoseconds ending_limit = seconds(2);  ///< for `off` and `kill` of all tasks
};

/// The thread of the keeper must live longest, because the children die with it. Context: setup.
class Keeper {
 public:
  explicit Keeper(KeeperPlan plan);
  /// Ends every process that the keeper started.
  ~Keeper();
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  /// Starts all processes; refuses if a process cannot start. SIGINT, SIGTERM and SIGHUP are blocked from here on:
  /// run() handles them.
  Result<void> start();
  /// Runs until the run client exits or sends SIGUSR1, the manager asks for the end, or a signal arrives. Then it ends
  /// all processes. The client takes its last values first and sees how the tasks end.
  /// A client that dies by a signal is replaced; a client that is stopped or hangs is sent SIGKILL. If it dies too
  /// often, or during the end, standard error names the reason and the exit code is 1. Otherwise the exit code is the
  /// manager's if it is above 0, else the client's, 0 without a client.
  int run();
  /// The run client reported that its output is lost. Requires: start() was called.
  bool output_is_lost() const noexcept { return face_.is_wanted() && face_.page().lost_output != 0; }

 private:
  enum class Phase : std::uint8_t {
    kRunning,
    kFaceLooks,
    kRtpusFinish,
    kRtpusDie,
    kFaceFinishes,
    kManagerFinishes,
    kDone
  };

  void wait();
  void poll();
  void check_face();
  void end_badly(const Message& why);
  void count_refusal(Nanoseconds lived);
  void on_message(const KeeperMessage& wish);
  bool advance();
  void enter(Phase phase, Nanoseconds limit);
  void watch_manager();
  void watch_face(Nanoseconds now);
  void report_hang();

  const KeeperPlan plan_;
  LinuxClock clock_;
  KeptPeers peers_;
  KeptFace face_;
  SignalQueue signals_;
  Phase phase_ = Phase::kRunning;
  Nanoseconds phase_due_ = kNever;
  Nanoseconds watch_due_ = {};
  LifeWatch manager_life_, face_life_;
  std::uint64_t manager_beats_ = 0;   // of the present manager; 0: it does not serve yet
  KeeperMessage hung_;                // kHung: report of a hung manager, for the next one that runs
  Nanoseconds manager_due_ = kNever;  // next start of the manager
  Nanoseconds manager_pause_;
  int manager_refusals_ = 0;  // failed starts in a row; negative once a manager has served
  bool end_asked_ = false;
  bool face_has_looked_ = false;  // the client sent SIGUSR1: now it only waits for the ends
  int end_code_ = 0;
};

}  // namespace chimera
