// SPDX-License-Identifier: Apache-2.0
// Gives lines to a thread that files them, frees filed ones in the journal, and reports those that are not filed.
#include "chimera/manager/state/filing.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "chimera/base/assert.h"
#include "chimera/control/rotated_file.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"

namespace chimera::manager {

/// A thread that reads and files lines. It has one job at a time; the first one, made at the start, reads the filed
/// lines. A thread that a disk stalls is left behind.
class Filing::Writer {
 public:
  struct Done {
    std::vector<std::string> found;  // by the first job: the last lines of the file
    std::string fault;               // reason why the lines of the job may not be on the disk; "": they are
  };

  static Result<std::unique_ptr<Writer>> start(const Place& place) {
    const std::string name = "writer of the " + place.stem;
    auto event = WakeEvent::open(Message(name));
    if (!event) return event.error();
    auto shared = std::make_shared<Shared>(place, *std::move(event));
    if (!start_ordinary_thread([shared] { shared->run(); })) return system_error(Message(name), "thread");
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
  void file(std::vector<std::string> lines) {
    CHIMERA_ASSERT(!is_busy_);
    is_busy_ = true;
    const std::lock_guard lock(shared_->mutex);
    shared_->job = std::move(lines);
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
    Shared(Place at, WakeEvent rung) : place(std::move(at)), file(place.folder, place.stem), event(std::move(rung)) {}

    const Place place;
    control::RotatedFile file;  // used by the thread only
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
      finish({file.last(place.n_found, place.run), ""});
      while (const auto lines = next_job()) {
        const auto filed = file.file(*lines);
        finish({{}, filed ? "" : filed.error().where.c_str() + std::string(": ") + filed.error().message.c_str()});
      }
    }
  };
  explicit Writer(std::shared_ptr<Shared> shared) noexcept : shared_(std::move(shared)) {}

 private:
  std::shared_ptr<Shared> shared_;  // with the thread, which may outlive this
  bool is_busy_ = true;
};

Filing::Filing(ManagerState& state, LineJournal journal, std::string stem)
    : state_(state), journal_(journal), stem_(std::move(stem)) {
  for (const LineJournal::Line& left : journal_.unfiled()) unfiled_.push_back({left.number, std::string(left.text)});
}

Result<std::unique_ptr<Filing>> Filing::start(ManagerState& state, LineJournal journal, const Place& place) {
  std::unique_ptr<Filing> made(new Filing(state, journal, place.stem));
  if (place.folder.empty()) {
    made->fault_ = "neither XDG_STATE_HOME nor HOME names a folder for them";
    made->has_read_ = true;
    made->found_.emplace();
    return made;
  }
  made->path_ = control::RotatedFile(place.folder, place.stem).path();
  auto writer = Writer::start(place);
  if (!writer) return writer.error();
  made->writer_ = *std::move(writer);
  return made;
}

Filing::~Filing() = default;

int Filing::descriptor() const noexcept { return writer_ ? writer_->descriptor() : -1; }

void Filing::add(std::uint64_t number, std::string line, Nanoseconds now) {
  if (!writer_) {
    journal_.filed(number);
    if (number == 1) note(stem_ + " are not filed: " + fault_, now);
    return;
  }
  unfiled_.push_back({number, std::move(line)});
  if (unfiled_.size() > kMostUnfiled + in_flight_) lose_oldest(now);
  file_next(now);
}

/// Reports the first loss only: the report may be a line of this file itself.
void Filing::lose_oldest(Nanoseconds now) {
  const auto oldest = unfiled_.begin() + static_cast<std::ptrdiff_t>(in_flight_);
  const std::uint64_t number = oldest->number;
  journal_.filed(number);
  unfiled_.erase(oldest);
  const std::string why = fault_.empty() ? "the disk does not answer" : fault_;
  if (++lost_ == 1) note(stem_ + " are lost from number " + std::to_string(number) + " on: " + why, now);
}

bool Filing::is_unfiled(std::uint64_t number) const {
  return std::ranges::find(unfiled_, number, &Line::number) != unfiled_.end();
}

void Filing::file_next(Nanoseconds now) {
  if (writer_->is_busy() || unfiled_.empty() || now < tries_again_) return;
  std::vector<std::string> lines;
  for (const Line& one : unfiled_) lines.push_back(one.text);
  in_flight_ = lines.size();
  writer_->file(std::move(lines));
}

void Filing::take_done(const std::string& fault, Nanoseconds now) {
  const std::string before = std::exchange(fault_, fault);
  if (!fault.empty()) {
    in_flight_ = 0;
    tries_again_ = now + kTryAgain;
    if (before != fault) note(stem_ + " are not filed: " + fault + "; they are kept and tried again", now);
    return;
  }
  for (; in_flight_ > 0; --in_flight_) {
    journal_.filed(unfiled_.front().number);
    unfiled_.pop_front();
  }
  const std::uint64_t lost = std::exchange(lost_, 0);
  if (!before.empty() || lost > 0)
    note(stem_ + " are filed again" + (lost == 0 ? "" : ", without " + std::to_string(lost) + " that are lost"), now);
}

void Filing::look(Nanoseconds now) {
  if (!writer_) return;
  if (auto done = writer_->take()) {
    if (std::exchange(has_read_, true)) take_done(done->fault, now);
    else found_ = std::move(done->found);
  }
  file_next(now);
}

Nanoseconds Filing::next_due() const noexcept {
  return unfiled_.empty() || !writer_ || writer_->is_busy() ? kNever : tries_again_;
}

void Filing::flush(Nanoseconds limit) {
  for (const Nanoseconds until = now() + limit; writer_ && !unfiled_.empty() && now() < until;) {
    tries_again_ = now();
    look(now());
    if (writer_->is_busy()) writer_->await(until - now());
    else if (!fault_.empty()) return;
    look(now());
  }
}

}  // namespace chimera::manager
