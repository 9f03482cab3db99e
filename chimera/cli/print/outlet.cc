// SPDX-License-Identifier: Apache-2.0
// Queues what is printed and writes it from a thread of its own.
#include "chimera/cli/print/outlet.h"

#include <poll.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "chimera/platform/file.h"
#include "chimera/platform/standard_streams.h"

namespace chimera::cli {

struct Outlet::Queue {
  explicit Queue(int to) : descriptor(to) {}

  void put(const char* text, std::size_t n);
  void write_all();

  const int descriptor;
  std::mutex mutex;
  std::condition_variable changed;
  std::string waiting;      // these four under the mutex
  bool is_writing = false;  // the thread has something that it took
  bool is_over = false;
  int why = 0;
};

void Outlet::Queue::put(const char* text, std::size_t n) {
  const std::lock_guard lock(mutex);
  if (waiting.size() + n > kOutletBytes)
    why = why == 0 ? kNobodyReads : why;
  else
    waiting.append(text, n);
  changed.notify_all();
}

/// Takes back the part of a line that a full disk left at the end of a file. Part of a terminal or pipe stays.
static void cut_back(int descriptor, std::string_view written) {
  const auto part = static_cast<off_t>(written.size() - (written.rfind('\n') + 1));  // npos + 1 is 0
  const off_t end = ::lseek(descriptor, 0, SEEK_CUR);
  if (part == 0 || end < part || end != file_size(descriptor)) return;
  if (::ftruncate(descriptor, end - part) == 0) (void)::lseek(descriptor, -part, SEEK_CUR);
}

/// 0, or why not all of it could be written.
static int write_bytes(int descriptor, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = ::write(descriptor, text.data() + at, text.size() - at);
    if (n > 0) {
      at += static_cast<std::size_t>(n);
    } else if (n < 0 && errno == EAGAIN) {  // another holder made the descriptor non-blocking
      pollfd room{descriptor, POLLOUT, 0};
      ::poll(&room, 1, -1);
    } else if (n == 0 || errno != EINTR) {
      const int why = n == 0 ? EIO : errno;
      cut_back(descriptor, std::string_view(text).substr(0, at));
      return why;
    }
  }
  return 0;
}

void Outlet::Queue::write_all() {
  std::unique_lock lock(mutex);
  for (;;) {
    changed.wait(lock, [this] { return is_over || !waiting.empty(); });
    if (waiting.empty()) return;
    const std::string text = std::exchange(waiting, {});
    is_writing = true;
    lock.unlock();
    const int failed = write_bytes(descriptor, text);
    lock.lock();
    is_writing = false;
    if (why == 0) why = failed;
    changed.notify_all();
  }
}

Outlet::Outlet(int descriptor) : queue_(std::make_shared<Queue>(descriptor)) {
  const cookie_io_functions_t calls = {.read = nullptr,
                                       .write = [](void* queue, const char* text, std::size_t n) -> ssize_t {
                                         static_cast<Queue*>(queue)->put(text, n);
                                         return static_cast<ssize_t>(n);  // why_lost() reports a loss
                                       },
                                       .seek = nullptr,
                                       .close = nullptr};
  stream_ = ::fopencookie(queue_.get(), "w", calls);
  std::thread([queue = queue_] { queue->write_all(); }).detach();  // it may be in a write that never returns
}

Outlet::~Outlet() {
  if (stream_ != nullptr) std::fclose(stream_);
  const std::lock_guard lock(queue_->mutex);
  queue_->is_over = true;
  queue_->changed.notify_all();
}

int Outlet::why_lost() const noexcept {
  const std::lock_guard lock(queue_->mutex);
  return queue_->why;
}

void Outlet::finish(Nanoseconds limit) {
  if (stream_ != nullptr) std::fflush(stream_);
  std::unique_lock lock(queue_->mutex);
  const bool is_written = queue_->changed.wait_for(lock, std::chrono::nanoseconds(limit.count),
                                                   [this] { return queue_->waiting.empty() && !queue_->is_writing; });
  if (!is_written && queue_->why == 0) queue_->why = kNobodyReads;
}

}  // namespace chimera::cli
