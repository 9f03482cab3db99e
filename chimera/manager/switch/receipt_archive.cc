// SPDX-License-Identifier: Apache-2.0
// Gives receipts to the writer, marks filed ones in the journal, and reports those that are not filed.
#include "chimera/manager/switch/receipt_archive.h"

#include <algorithm>
#include <utility>

#include "chimera/control/receipt/receipt_file.h"

namespace chimera::manager {

ReceiptArchive::ReceiptArchive(ManagerState& state) : state_(state), journal_(state.own.block().journal()) {
  for (const SwitchJournal::Receipt& left : journal_.unfiled()) {
    unfiled_.push_back({left.number, std::string(left.text)});
    keep(std::string(left.text));
  }
}

Result<std::unique_ptr<ReceiptArchive>> ReceiptArchive::start(ManagerState& state, const std::string& folder) {
  std::unique_ptr<ReceiptArchive> made(new ReceiptArchive(state));
  if (folder.empty()) {
    made->fault_ = "neither XDG_STATE_HOME nor HOME names a folder for them";
    return made;
  }
  made->path_ = control::ReceiptFile(folder).path();
  auto writer = ReceiptWriter::start(folder, kKept);
  if (!writer) return writer.error();
  made->writer_ = *std::move(writer);
  return made;
}

void ReceiptArchive::keep(std::string receipt) {
  kept_.push_back(std::move(receipt));
  if (kept_.size() > kKept) kept_.pop_front();
}

void ReceiptArchive::add(std::uint32_t number, std::string receipt, Nanoseconds now, std::function<void()> then) {
  (void)journal_.put(number, receipt);  // no room: the disk accepts nothing, and only this manager has it
  keep(receipt);
  if (!writer_) {
    journal_.filed(number);
    if (number == 1) state_.tell("note", TaskId{}, RtpuId{}, "receipts are not filed: " + fault_, now);
    return then();
  }
  if (unfiled_.size() >= kMostUnfiled + in_flight_) {
    const auto oldest = unfiled_.begin() + static_cast<std::ptrdiff_t>(in_flight_);
    state_.tell("note", TaskId{}, RtpuId{}, "receipt " + std::to_string(oldest->number) + " is lost: " + fault_, now);
    journal_.filed(oldest->number);
    unfiled_.erase(oldest);
  }
  unfiled_.push_back({number, std::move(receipt)});
  waiting_.push_back({number, now + kDiskLimit, std::move(then)});
  tries_again_ = now;
  file_next(now);
}

bool ReceiptArchive::is_unfiled(std::uint32_t number) const {
  return std::ranges::find(unfiled_, number, &Unfiled::number) != unfiled_.end();
}

void ReceiptArchive::file_next(Nanoseconds now) {
  if (writer_->is_busy() || unfiled_.empty() || now < tries_again_) return;
  std::vector<std::string> receipts;
  for (const Unfiled& one : unfiled_) receipts.push_back(one.receipt);
  in_flight_ = receipts.size();
  writer_->file(std::move(receipts));
}

/// Puts the receipts of this manager after those that were filed before.
void ReceiptArchive::take_found(const std::vector<std::string>& found) {
  const std::deque<std::string> own = std::exchange(kept_, {});
  for (const std::string& receipt : found) keep(receipt);
  for (const std::string& receipt : own) {
    const auto is_it = [&](const std::string& one) {
      return control::receipt_key(one) == control::receipt_key(receipt);
    };
    if (std::ranges::none_of(kept_, is_it)) keep(receipt);
  }
}

void ReceiptArchive::take_done(const ReceiptWriter::Done& done, Nanoseconds now) {
  if (done.fault.empty()) {
    for (; in_flight_ > 0; --in_flight_) {
      journal_.filed(unfiled_.front().number);
      unfiled_.pop_front();
    }
    if (!fault_.empty()) state_.tell("note", TaskId{}, RtpuId{}, "receipts are filed again", now);
  } else {
    in_flight_ = 0;
    tries_again_ = now + kTryAgain;
    if (fault_ != done.fault)
      state_.tell("note", TaskId{}, RtpuId{},
                  "receipts are not filed: " + done.fault + "; they are kept and tried again", now);
  }
  fault_ = done.fault;
}

void ReceiptArchive::answer(const std::function<bool(const Waiting&)>& is_due) {
  const auto later = [&](const Waiting& one) { return !is_due(one); };
  const auto first = std::stable_partition(waiting_.begin(), waiting_.end(), later);
  const std::vector<Waiting> due(first, waiting_.end());
  waiting_.erase(first, waiting_.end());
  for (const Waiting& one : due) one.then();
}

void ReceiptArchive::look(Nanoseconds now) {
  if (!writer_) return;
  if (const auto done = writer_->take()) {
    if (std::exchange(has_found_, true)) take_done(*done, now);
    else take_found(done->found);
  }
  file_next(now);
  answer([&](const Waiting& one) { return now >= one.until || !fault_.empty() || !is_unfiled(one.number); });
}

Nanoseconds ReceiptArchive::next_due() const noexcept {
  Nanoseconds due = unfiled_.empty() || !writer_ || writer_->is_busy() ? kNever : tries_again_;
  for (const Waiting& one : waiting_) due = std::min(due, one.until);
  return due;
}

void ReceiptArchive::flush(Nanoseconds limit) {
  for (const Nanoseconds until = now() + limit; writer_ && !unfiled_.empty() && now() < until;) {
    tries_again_ = now();
    look(now());
    if (writer_->is_busy()) writer_->await(until - now());
    else if (!fault_.empty()) return;
    look(now());
  }
}

}  // namespace chimera::manager
