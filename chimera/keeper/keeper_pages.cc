// SPDX-License-Identifier: Apache-2.0
// Makes the decision page and the keeper page, and writes the keeper's part of them.
#include "chimera/keeper/keeper_pages.h"

#include <new>

#include "chimera/platform/wake.h"

namespace chimera {

Result<KeeperPages> KeeperPages::create(std::uint32_t n_rtpus, Nanoseconds origin) {
  auto decision = SharedPages::create("chimera-decision", sizeof(DecisionPage));
  if (!decision) return decision.error();
  auto keeper = MemoryRegion::create("chimera-keeper", sizeof(KeeperPage));
  if (!keeper) return keeper.error();
  KeeperPages pages;
  pages.decision_ = *std::move(decision);
  pages.keeper_ = *std::move(keeper);
  new (pages.decision_.bytes().data()) DecisionPage;
  new (pages.keeper_.writable().data()) KeeperPage;
  pages.keeper().origin = origin;
  pages.keeper().n_rtpus = n_rtpus;
  return pages;
}

void KeeperPages::show_life(std::uint32_t index, std::uint32_t incarnation) noexcept {
  if (index < keeper().n_rtpus) keeper().unguarded[index].store(0, std::memory_order_relaxed);
  keeper().alive[index].store(incarnation, std::memory_order_release);
  decision().changes.fetch_add(1, std::memory_order_release);  // pairs with the reads at a cycle boundary
}

void KeeperPages::ring_all() noexcept {
  for (std::uint32_t i = 0; i <= keeper().n_rtpus; ++i) Doorbell(decision().bells[i].word).ring();
}

void KeeperPages::show_face(const FacePage& face) noexcept {
  keeper().face_signal.store(face.last_signal, std::memory_order_relaxed);
  keeper().face_deaths.store(face.deaths, std::memory_order_release);
  keeper().lost_output.store(face.lost_output, std::memory_order_release);
  ring_all();
}

void KeeperPages::show_guard(std::int32_t pid, GuardState state) noexcept {
  keeper().guard_pid.store(pid, std::memory_order_relaxed);
  keeper().guard_state.store(state, std::memory_order_relaxed);
  ring_all();
}

void KeeperPages::show_unguarded(std::uint32_t index, std::uint32_t incarnation, std::int32_t error) noexcept {
  if (index >= keeper().n_rtpus || keeper().alive[index].load(std::memory_order_relaxed) != incarnation) return;
  keeper().unguarded[index].store(error, std::memory_order_relaxed);
  ring_all();
}

}  // namespace chimera
