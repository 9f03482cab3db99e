// SPDX-License-Identifier: Apache-2.0
// Gives receipts to a thread that files them, marks filed ones in the journal, and reports those that are not filed.
#include "chimera/manager/switch/receipt_archive.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "chimera/base/assert.h"
#include "chimera/control/receipt/receipt_file.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"

namespace chimera::manager {

/// A thread that reads and files receipts, so that a slow, full or stalled disk delays no other work. It has one job at
/// a time; the first one, made at the start, reads the filed receipts. A thread that a disk stalls is left behind.
class ReceiptArchive::Writer {
 public:
  struct Done {
    std::vector<std::string> found;  // by the first job: the last receipts of the file
    std::string fault;               // reason why the receipts of the job may not be on the disk; "": they are
  };

  static Result<std::unique_ptr<Writer>> start(const std::string& folder) {
    auto event = WakeEvent::open(Message("writer of the receipts"));
    if (!event) return event.error();
    auto shared = std::make_shared<Shared>(folder, *std::move(event));
    if (!start_ordinary_thread([shared] { shared->run(); }))
      return system_error(Message("writer of the receipts"), "thread");
    return std::make_unique<Writer>(std::move(shared));
  }
  ~Writer() {
    const std::lock_guard lock(shared_->mutex);
    shared_->is_ending = true;
    shared_->changed.notify_all();
  }

  /// Readable when take() has a result.
  int descriptor() const noexcept { return shared_->event.descriptor(); }
  bool is_busy() const noexcept { return is_busy_; }
  /// Requires: !is_busy().
  void file(std::vector<std::string> receipts) {
    CHIMERA_ASSERT(!is_busy_);
    is_busy_ = true;
    const std::lock_guard lock(shared_->mutex);
    shared_->job = std::move(receipts);
    shared_->changed.notify_all();
  }
  /// The result of the job, once; is_busy() until then.
  std::optional<Done> take() {
    const std::lock_guard lock(shared_->mutex);
    shared_->event.reset();
    if (shared_->done) is_busy_ = false;
    return std::exchange(shared_->done, std::nullopt);
  }
  /// Blocks until take() has a result, `limit` at most.
  void await(Nanoseconds limit) const {
    const int descriptors[] = {descriptor()};
    await_readable(descriptors, limit);
  }

  struct Shared {
    Shared(const std::string& folder, WakeEvent rung) : file(folder), event(std::move(rung)) {}

    control::ReceiptFile file;  // used by the thread only
    WakeEvent event;
    std::mutex mutex;
    std::condition_variable changed;
    bool is_ending = false;  // guarded by the mutex, as are the next two
    std::optional<std::vector<std::string>> job;
    std::optional<Done> done;

    void finish(Done what) {
      const std::lock_guard lock(mutex);
      done = std::move(what);
      event.ring();
    }
    std::optional<std::vector<std::string>> next_job() {
      std::unique_lock lock(mutex);
      changed.wait(lock, [this] { return is_ending || job; });
      return is_ending ? std::nullopt : std::exchange(job, std::nullopt);
    }
    void run() {
      finish({file.last(kKept), ""});
      while (const auto receipts = next_job()) {
        const auto filed = file.file(*receipts);
        finish({{}, filed ? "" : filed.error().where.c_str() + std::string(": ") + filed.error().message.c_str()});
      }
    }
  };
  explicit Writer(std::shared_ptr<Shared> shared) noexcept : shared_(std::move(shared)) {}

 private:
  std::shared_ptr<Shared> shared_;  // with the thread, which may outlive this
  bool is_busy_ = true;
};

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
  auto writer = Writer::start(folder);
  if (!writer) return writer.error();
  made->writer_ = *std::move(writer);
  return made;
}

ReceiptArchive::~ReceiptArchive() = default;

int ReceiptArchive::descriptor() const noexcept { return writer_ ? writer_->descriptor() : -1; }

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

void ReceiptArchive::take_done(const std::string& fault, Nanoseconds now) {
  if (fault.empty()) {
    for (; in_flight_ > 0; --in_flight_) {
      journal_.filed(unfiled_.front().number);
      unfiled_.pop_front();
    }
    if (!fault_.empty()) state_.tell("note", TaskId{}, RtpuId{}, "receipts are filed again", now);
  } else {
    in_flight_ = 0;
    tries_again_ = now + kTryAgain;
    if (fault_ != fault)
      state_.tell("note", TaskId{}, RtpuId{},
                  "receipts are not filed: " + fault + "; they are kept and tried again", now);
  }
  fault_ = fault;
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
    if (std::exchange(has_found_, true)) take_done(done->fault, now);
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
