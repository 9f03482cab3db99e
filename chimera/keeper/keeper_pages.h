// SPDX-License-Identifier: Apache-2.0
// The two pages in which the keeper shows every process of a run which peers live and how the run goes.
// docs/formats/processes.md, "Keeper messages".
#pragma once

#include "chimera/base/result.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/runtime/hosted/face_page.h"
#include "chimera/runtime/hosted/pages.h"

namespace chimera {

/// Single-threaded. Requires for all functions but create(): create() made the pages. Context: setup; never blocks.
class KeeperPages {
 public:
  /// Makes both pages. No peer lives yet, and the grid of releases begins at `origin`.
  static Result<KeeperPages> create(std::uint32_t n_rtpus, Nanoseconds origin);

  /// Descriptors that each process gets at its start: the decision page, writable by all; the keeper page, readable by
  /// all.
  int decision_descriptor() const noexcept { return decision_.descriptor(); }
  int keeper_descriptor() const noexcept { return keeper_.descriptor(); }

  /// Shows that `incarnation` of the peer lives, and that it is guarded; 0: no process of the peer lives. Wakes no
  /// process: ring_all() does.
  void show_life(std::uint32_t index, std::uint32_t incarnation) noexcept;
  /// Wakes every process of the run.
  void ring_all() noexcept;
  /// Counts one more round of the keeper's loop, for all peers to see.
  void beat() noexcept { keeper().beats.fetch_add(1, std::memory_order_release); }
  /// Shows how often and by which signal the run client died, and whether its output is lost. Wakes all processes.
  void show_face(const FacePage& face) noexcept;
  /// Shows whether there is a guard (0: none), and its state. Wakes all processes.
  void show_guard(std::int32_t pid, GuardState state) noexcept;
  /// Shows why no safe frame of that incarnation of an rtpu can be written (errno); nothing if another incarnation
  /// lives. Wakes all processes.
  void show_unguarded(std::uint32_t index, std::uint32_t incarnation, std::int32_t error) noexcept;
  /// Shows that the run ends.
  void show_ending() noexcept { keeper().ending.store(1, std::memory_order_release); }

 private:
  KeeperPage& keeper() const noexcept { return *reinterpret_cast<KeeperPage*>(keeper_.writable().data()); }
  DecisionPage& decision() const noexcept { return *reinterpret_cast<DecisionPage*>(decision_.bytes().data()); }

  SharedPages decision_;
  MemoryRegion keeper_;
};

}  // namespace chimera
