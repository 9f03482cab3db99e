// SPDX-License-Identifier: Apache-2.0
// Files receipts in a thread of its own and rings when a job is done.
#include "chimera/manager/switch/receipt_writer.h"

#include <cerrno>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "chimera/base/assert.h"
#include "chimera/control/receipt/receipt_file.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"

namespace chimera::manager {

struct ReceiptWriter::Shared {
  explicit Shared(const std::string& folder, WakeEvent rung) : file(folder), event(std::move(rung)) {}

  control::ReceiptFile file;  // used by the thread only
  WakeEvent event;
  std::mutex mutex;
  std::condition_variable changed;
  bool is_ending = false;  // guarded by the mutex, as are all below
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
  void run(std::size_t n_found) {
    finish({file.last(n_found), ""});
    while (const auto receipts = next_job()) {
      const auto filed = file.file(*receipts);
      finish({{}, filed ? "" : filed.error().where.c_str() + std::string(": ") + filed.error().message.c_str()});
    }
  }
};

Result<std::unique_ptr<ReceiptWriter>> ReceiptWriter::start(const std::string& folder, std::size_t n_found) {
  auto event = WakeEvent::open(Message("writer of the receipts"));
  if (!event) return event.error();
  auto shared = std::make_shared<Shared>(folder, *std::move(event));
  if (!start_ordinary_thread([shared, n_found] { shared->run(n_found); }))
    return system_error(Message("writer of the receipts"), "thread");
  return std::unique_ptr<ReceiptWriter>(new ReceiptWriter(std::move(shared)));
}

ReceiptWriter::~ReceiptWriter() {
  const std::lock_guard lock(shared_->mutex);
  shared_->is_ending = true;
  shared_->changed.notify_all();
}

int ReceiptWriter::descriptor() const noexcept { return shared_->event.descriptor(); }

void ReceiptWriter::file(std::vector<std::string> receipts) {
  CHIMERA_ASSERT(!is_busy_);
  is_busy_ = true;
  const std::lock_guard lock(shared_->mutex);
  shared_->job = std::move(receipts);
  shared_->changed.notify_all();
}

std::optional<ReceiptWriter::Done> ReceiptWriter::take() {
  const std::lock_guard lock(shared_->mutex);
  shared_->event.reset();
  if (shared_->done) is_busy_ = false;
  return std::exchange(shared_->done, std::nullopt);
}

void ReceiptWriter::await(Nanoseconds limit) const {
  const int descriptors[] = {descriptor()};
  await_readable(descriptors, limit);
}

}  // namespace chimera::manager
