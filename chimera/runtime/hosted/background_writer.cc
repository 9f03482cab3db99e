// SPDX-License-Identifier: Apache-2.0
// Calls each background method at its interval in an ordinary thread, and ends it within a limit.
#include "chimera/runtime/hosted/background_writer.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <vector>

#include "chimera/base/assert.h"
#include "chimera/platform/thread.h"

namespace chimera {
namespace {

std::int64_t steady_now() { return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1); }

}  // namespace

/// One instance and its thread.
struct BackgroundWriter::Worker {
  void* instance = nullptr;
  chimera_background background = nullptr;
  Nanoseconds every;
  std::uint32_t tag = 0;
  // The call that is under way. By the worker, read by the main thread for a figure: pairs with nothing.
  std::atomic<std::int64_t> began{INT64_MAX};

  std::mutex mutex;
  std::condition_variable changed;
  bool ending = false;  // under the mutex, as all below
  bool ended = false;
  bool abandoned = false;  // by end(): whatever it was doing was its last
  bool failed = false;
  chimera_fault fault{};

  void run() {
    std::unique_lock lock(mutex);
    for (bool last = false; !last;) {
      changed.wait_for(lock, std::chrono::nanoseconds(every.count), [this] { return ending; });
      last = ending;
      if (failed) continue;
      chimera_fault said{};
      lock.unlock();
      began = steady_now();
      const bool good = background(instance, &said) == CHIMERA_OK;
      began = INT64_MAX;
      lock.lock();
      if (abandoned) return;
      if (good) continue;
      failed = true;
      fault = said;
      fault.text[CHIMERA_FAULT_TEXT - 1] = '\0';
    }
    ended = true;
    changed.notify_all();
  }
};

struct BackgroundWriter::Workers {
  std::mutex mutex;                          // of the list: another thread calls longest()
  std::vector<std::shared_ptr<Worker>> all;  // each shared with its thread, which may outlive us
};

BackgroundWriter::BackgroundWriter(Nanoseconds every, Nanoseconds limit) noexcept
    : every_(every), limit_(limit), workers_(std::make_unique<Workers>()) {}

BackgroundWriter::~BackgroundWriter() {
  chimera_fault unheard{};
  for (const auto& worker : workers_->all) (void)end(*worker, unheard);
}

bool BackgroundWriter::add(void* instance, chimera_background background, std::uint32_t tag) {
  auto worker = std::make_shared<Worker>();
  worker->instance = instance;
  worker->background = background;
  worker->every = every_;
  worker->tag = tag;
  const bool made = start_ordinary_thread([worker] { worker->run(); });
  const std::lock_guard lock(workers_->mutex);
  if (made) workers_->all.push_back(std::move(worker));
  return made;
}

std::uint32_t BackgroundWriter::longest(Nanoseconds longer_than) const {
  const std::lock_guard lock(workers_->mutex);
  const auto earlier = [](const auto& a, const auto& b) { return a->began < b->began; };
  const auto at = std::min_element(workers_->all.begin(), workers_->all.end(), earlier);
  return at != workers_->all.end() && (*at)->began < steady_now() - longer_than.count ? (*at)->tag : 0;
}

BackgroundWriter::End BackgroundWriter::remove(void* instance, chimera_fault& fault) {
  std::shared_ptr<Worker> worker;
  {
    const std::lock_guard lock(workers_->mutex);
    const auto at = std::find_if(workers_->all.begin(), workers_->all.end(),
                                 [instance](const auto& other) { return other->instance == instance; });
    CHIMERA_ASSERT(at != workers_->all.end());
    worker = *at;
    workers_->all.erase(at);
  }
  return end(*worker, fault);
}

BackgroundWriter::End BackgroundWriter::end(Worker& worker, chimera_fault& fault) const {
  std::unique_lock lock(worker.mutex);
  worker.ending = true;
  worker.changed.notify_all();
  if (!worker.changed.wait_for(lock, std::chrono::nanoseconds(limit_.count), [&] { return worker.ended; })) {
    worker.abandoned = true;
    fault.code = 0;
    std::snprintf(fault.text, sizeof fault.text, "its background did not return within %.3g s: what it holds is lost",
                  to_seconds(limit_));
    return End::kStalled;
  }
  fault = worker.fault;
  return worker.failed ? End::kFault : End::kDone;
}

}  // namespace chimera
