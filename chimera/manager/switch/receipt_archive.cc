// SPDX-License-Identifier: Apache-2.0
// Has receipts filed, holds an answer back until its receipt is on the disk, and keeps the last receipts for clients.
#include "chimera/manager/switch/receipt_archive.h"

#include <algorithm>
#include <utility>

#include "chimera/control/rotated_file.h"

namespace chimera::manager {

ReceiptArchive::ReceiptArchive(ManagerState& state, std::unique_ptr<Filing> filing)
    : journal_(state.own.block().journal()), filing_(std::move(filing)) {
  for (const Filing::Line& left : filing_->unfiled()) keep(left.text);
}

Result<std::unique_ptr<ReceiptArchive>> ReceiptArchive::start(ManagerState& state, const std::string& folder) {
  const SwitchJournal journal(state.own.block().journal());
  auto filing = Filing::start(state, journal.lines(), {.folder = folder, .stem = "receipts", .n_found = kKept});
  if (!filing) return filing.error();
  return std::unique_ptr<ReceiptArchive>(new ReceiptArchive(state, *std::move(filing)));
}

void ReceiptArchive::keep(std::string receipt) {
  kept_.push_back(std::move(receipt));
  if (kept_.size() > kKept) kept_.pop_front();
}

void ReceiptArchive::add(std::uint32_t number, std::string receipt, Nanoseconds now, std::function<void()> then) {
  (void)journal_.put(number, receipt);  // no room: the disk accepts nothing, and only this manager has it
  keep(receipt);
  filing_->try_again(now);
  filing_->add(number, std::move(receipt), now);
  if (!filing_->is_unfiled(number)) return then();
  waiting_.push_back({number, now + kDiskLimit, std::move(then)});
}

/// Puts the receipts of this manager after those that were filed before.
void ReceiptArchive::take_found(const std::vector<std::string>& found) {
  const std::deque<std::string> own = std::exchange(kept_, {});
  for (const std::string& receipt : found) keep(receipt);
  for (const std::string& receipt : own) {
    const auto is_it = [&](const std::string& one) { return control::line_key(one) == control::line_key(receipt); };
    if (std::ranges::none_of(kept_, is_it)) keep(receipt);
  }
}

void ReceiptArchive::answer(const std::function<bool(const Waiting&)>& is_due) {
  const auto later = [&](const Waiting& one) { return !is_due(one); };
  const auto first = std::stable_partition(waiting_.begin(), waiting_.end(), later);
  const std::vector<Waiting> due(first, waiting_.end());
  waiting_.erase(first, waiting_.end());
  for (const Waiting& one : due) one.then();
}

void ReceiptArchive::look(Nanoseconds now) {
  filing_->look(now);
  if (const auto found = filing_->take_found()) take_found(*found);
  answer([&](const Waiting& one) {
    return now >= one.until || !fault().empty() || !filing_->is_unfiled(one.number);
  });
}

Nanoseconds ReceiptArchive::next_due() const noexcept {
  Nanoseconds due = filing_->next_due();
  for (const Waiting& one : waiting_) due = std::min(due, one.until);
  return due;
}

}  // namespace chimera::manager
