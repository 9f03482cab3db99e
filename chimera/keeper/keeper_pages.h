// SPDX-License-Identifier: Apache-2.0
// The two pages by which the keeper shows all processes of a run who lives and how the run goes.
// docs/formats/processes.md, "Keeper messages".
#pragma once

#include "chimera/base/result.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/runtime/hosted/face_page.h"
#include "chimera/runtime/hosted/pages.h"

namespace chimera {

/// Single-threaded. Requires, for all but create(): was made by create(). Context: setup; never blocks.
class KeeperPages {
 public:
  /// Makes both pages: of `n_rtpus` and the manager none lives yet, and the grid of releases begins at `origin`.
  static Result<KeeperPages> create(std::uint32_t n_rtpus, Nanoseconds origin);

  /// What a process is given at its start: the decision page, for all to write; the keeper page, for all to read.
  int decision_descriptor() const noexcept { return decision_.descriptor(); }
  int keeper_descriptor() const noexcept { return keeper_.descriptor(); }

  /// Of the peer lives `incarnation`; 0: none. Wakes nobody: ring_all() does.
  void show_life(std::uint32_t index, std::uint32_t incarnation) noexcept;
  /// Wakes every process of the run.
  void ring_all() noexcept;
  /// Shows all peers that the loop of the keeper went round once more.
  void beat() noexcept { keeper().beats.fetch_add(1, std::memory_order_release); }
  /// Shows how often the face died and of what, and whether its output is lost; wakes everybody.
  void show_face(const FacePage& face) noexcept;
  /// The run ends from here on.
  void show_ending() noexcept { keeper().ending.store(1, std::memory_order_release); }

 private:
  KeeperPage& keeper() const noexcept { return *reinterpret_cast<KeeperPage*>(keeper_.writable().data()); }
  DecisionPage& decision() const noexcept { return *reinterpret_cast<DecisionPage*>(decision_.bytes().data()); }

  SharedPages decision_;
  MemoryRegion keeper_;
};

}  // namespace chimera
