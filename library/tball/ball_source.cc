// SPDX-License-Identifier: Apache-2.0
// Opens devices, terminals and recordings, and reads ball events from their bytes.
#include "library/tball/ball_source.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "library/device/sentence.h"
#include "library/tball/keys.h"

namespace chimera::library {

void BallSource::open(const std::string& path) {
  close();
  path_ = path;
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0) throw std::runtime_error(open_refusal(path, errno));
  if (S_ISREG(about.st_mode)) {
    recording_ = read_recording(path);
    kind_ = Kind::kRecording;
  } else if (S_ISCHR(about.st_mode) || S_ISFIFO(about.st_mode)) {
    open_device(S_ISFIFO(about.st_mode));
  } else {
    throw std::runtime_error(path + ": neither an input device nor a terminal, a FIFO or a recording");
  }
}

void BallSource::open_device(bool is_fifo) {
  file_ = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (file_ < 0) throw std::runtime_error(open_refusal(path_, errno));
  int version = 0;
  if (is_fifo || ::ioctl(file_, EVIOCGVERSION, &version) == 0) {
    kind_ = Kind::kEvents;
  } else if (::isatty(file_) == 1) {
    kind_ = Kind::kKeys;
    make_raw();
  } else {
    close();
    throw std::runtime_error(path_ + ": no input device: those are /dev/input/event*, a terminal is one of keys");
  }
}

// Keys arrive one by one without echo. The interrupt key still interrupts.
void BallSource::make_raw() {
  has_mode_ = ::tcgetattr(file_, &mode_) == 0;
  termios raw = mode_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_cc[VMIN] = 1;  // a read without keys then fails with EAGAIN, and 0 means the end
  raw.c_cc[VTIME] = 0;
  if (has_mode_ && ::tcsetattr(file_, TCSANOW, &raw) == 0) return;
  const int error = errno;
  close();
  throw std::runtime_error(open_refusal(path_, error));
}

void BallSource::close() noexcept {
  if (file_ < 0) return;
  if (std::exchange(has_mode_, false)) ::tcsetattr(file_, TCSANOW, &mode_);
  ::close(std::exchange(file_, -1));
}

void BallSource::reopen() {
  if (kind_ == Kind::kRecording) return;
  open(std::string(path_));
  kept_ = 0;
  if (kind_ == Kind::kRecording || fill(sizeof buffer_) >= 0) return;
  throw std::runtime_error(path_ + ": opens, but no process has the other end open");
}

void BallSource::start(Nanoseconds now) noexcept {
  origin_ = now;
  next_ = 0;
  kept_ = 0;
  error_ = 0;
  old_reads_ = kMostOldReads;
  if (kind_ != Kind::kRecording) forget();
}

void BallSource::forget() noexcept {
  old_reads_ = fill(sizeof buffer_) == static_cast<int>(sizeof buffer_) ? old_reads_ - 1 : 0;
  kept_ = 0;
}

bool BallSource::collect(Ball& ball, std::int32_t full, Nanoseconds now) noexcept {
  if (kind_ == Kind::kRecording) return collect_recorded(ball, now), true;
  if (old_reads_ > 0) return forget(), true;
  const int got = fill(kind_ == Kind::kKeys ? kMostEvents : sizeof buffer_);
  if (got < 0) return false;
  if (kind_ == Kind::kKeys) take_keys(ball, static_cast<std::size_t>(got), full, now);
  else take_events(ball, static_cast<std::size_t>(got), now);
  return true;
}

int BallSource::fill(std::size_t most) noexcept {
  const ssize_t got = ::read(file_, buffer_ + kept_, most - kept_);
  if (got > 0) return static_cast<int>(static_cast<std::size_t>(got) + std::exchange(kept_, 0));
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return static_cast<int>(std::exchange(kept_, 0));
  error_ = got < 0 ? errno : 0;
  return -1;
}

void BallSource::collect_recorded(Ball& ball, Nanoseconds now) noexcept {
  for (std::size_t i = 0; i < kMostEvents && next_ < recording_.size(); ++i) {
    const RecordedEvent& event = recording_[next_];
    if (origin_ + event.at > now) return;
    ball.take(event.event, origin_ + event.at);
    ++next_;
  }
}

void BallSource::take_events(Ball& ball, std::size_t bytes, Nanoseconds now) noexcept {
  std::size_t at = 0;
  for (; at + sizeof(input_event) <= bytes; at += sizeof(input_event)) {
    input_event event;
    std::memcpy(&event, buffer_ + at, sizeof event);
    ball.take({event.type, event.code, event.value}, now);
  }
  kept_ = bytes - at;
  std::memmove(buffer_, buffer_ + at, kept_);
}

void BallSource::take_keys(Ball& ball, std::size_t bytes, std::int32_t full, Nanoseconds now) const noexcept {
  for (std::size_t i = 0; i < bytes; ++i) {
    const auto event = event_of_key(buffer_[i], full);
    if (buffer_[i] == ' ') ball.rest();
    if (!event) continue;
    ball.take(*event, now);
    ball.take({kSyncEvent, kReport, 0}, now);
  }
}

}  // namespace chimera::library
