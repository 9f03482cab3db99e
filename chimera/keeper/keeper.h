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
  std::vector<std::string> face;          ///< program and arguments of the face of this run; empty: none
  Nanoseconds face_limit = seconds(2);    ///< to take its last values when told to; and to finish after the rtpus
  Nanoseconds ending_limit = seconds(2);  ///< for `off` and `kill` of all tasks
};

/// Must live in the thread that lives longest: the children follow it. Context: setup.
class Keeper {
 public:
  explicit Keeper(KeeperPlan plan);
  /// Nothing that it started outlives it.
  ~Keeper();
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  /// Starts everybody; refuses when one cannot be. SIGINT, SIGTERM and SIGHUP are blocked from here on: run() takes
  /// them.
  Result<void> start();
  /// Keeps until the face exits or says SIGUSR1, the manager says so, or a signal does; then ends everybody: the face
  /// has taken its last values by then, and sees how the tasks end. A face that dies by a signal is replaced (one that
  /// is stopped or hangs is sent SIGKILL), and so are its successors; when one dies too often, or while everything
  /// ends, that is told on standard error and the exit code is 1. Else the manager's if it gave one above 0, else that
  /// of the face, 0 without one.
  int run();
  /// The face has told that what it printed is lost. Requires: start() was called.
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
  std::uint64_t manager_beats_ = 0;   // of the present one; 0: it has not come to serve
  KeeperMessage hung_;                // kHung: of the manager, to be told when one runs again
  Nanoseconds manager_due_ = kNever;  // when it is started again
  Nanoseconds manager_pause_;
  int manager_refusals_ = 0;  // in a row from the start on; negative once one has lived
  bool end_asked_ = false;
  bool face_has_looked_ = false;  // and says so by SIGUSR1: from there on it only waits for the ends
  int end_code_ = 0;
};

}  // namespace chimera
