// SPDX-License-Identifier: Apache-2.0
// Derives the role of a connection from the user and groups of its process, reads lines from the connection and writes
// lines to it, within limits of size and time.
#include "chimera/control/connection.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "chimera/platform/local_socket.h"

namespace chimera::control {
namespace {

constexpr std::size_t kReadAtOnce = std::size_t{1} << 16;

}  // namespace

Role role_of(uid_t user, std::span<const gid_t> groups, uid_t owner, const RoleGroups& rules) noexcept {
  if (user == 0 || user == owner) return Role::kConfigure;
  const auto is_in = [groups](const std::optional<gid_t>& wanted) {
    return wanted && std::find(groups.begin(), groups.end(), *wanted) != groups.end();
  };
  if (is_in(rules.configure)) return Role::kConfigure;
  if (is_in(rules.operate)) return Role::kOperate;
  return is_in(rules.observe) ? Role::kObserve : Role::kNone;
}

PeerIdentity identify(int descriptor, uid_t owner, const RoleGroups& rules) {
  const auto peer = peer_of(descriptor);
  if (!peer) return {};
  return {peer->user, role_of(peer->user, peer->groups, owner, rules), peer->process};
}

void Connection::receive(Nanoseconds now) {
  if (taken_ > 0) {  // once a turn, not once a line
    input_.erase(0, taken_);
    looked_ -= taken_;
    taken_ = 0;
  }
  char bytes[kReadAtOnce];
  while (input_.size() <= kMaxLine) {
    const std::int64_t got = receive_now(socket_.fd, bytes);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      has_ended_ = got == 0 || errno != EAGAIN;
      if (has_ended_) half_since_ = kNever;
      return;
    }
    const char* end = static_cast<const char*>(::memrchr(bytes, '\n', static_cast<std::size_t>(got)));
    if (end != nullptr)
      half_since_ = end == bytes + got - 1 ? kNever : now;
    else
      half_since_ = std::min(half_since_, now);
    input_.append(bytes, static_cast<std::size_t>(got));
  }
}

bool Connection::has_line() const noexcept {
  return next != nullptr || input_.size() - taken_ > kMaxLine || input_.find('\n', looked_) != std::string::npos;
}

bool Connection::has_short_line() const noexcept {
  return std::string_view(input_).substr(taken_, kLongLine).find('\n') != std::string_view::npos;
}

bool Connection::take_line(std::string& line) {
  const std::size_t end = input_.find('\n', looked_);
  if (end == std::string::npos && input_.size() - taken_ <= kMaxLine) {
    looked_ = input_.size();
    return false;
  }
  line.assign(input_, taken_, std::min(end, input_.size()) - taken_);
  looked_ = taken_ = end == std::string::npos ? input_.size() : end + 1;
  return true;
}

void Connection::queue(const std::string& line, Nanoseconds now) {
  if (!behind_.empty()) {
    const auto kept = std::make_shared<const std::string>(line);
    behind_.push_back(std::make_shared<TextPieces>(kept, *kept));
    return;
  }
  if (!has_bytes()) moved_ = now;
  output_ += line;
}

void Connection::queue_in_pieces(const std::string& begin, std::shared_ptr<Pieces> pieces, const std::string& end,
                               Nanoseconds now) {
  queue(begin, now);
  behind_.push_back(std::move(pieces));
  queue(end, now);
}

bool Connection::go_on(Nanoseconds now) {
  if (!can_go_on()) return false;
  if (!has_bytes()) moved_ = now;
  if (sent_ > kAhead) output_.erase(0, std::exchange(sent_, 0));  // not whole before the last piece is sent
  if (!behind_.front()->append_to(output_)) behind_.pop_front();
  (void)flush(now);
  return true;
}

bool Connection::is_read(Nanoseconds now) {
  const int unread = unread_by_other_end(socket_.fd);
  if (unread < 0) return true;
  if (unread == 0 || unread < unread_) taken_at_ = now;
  unread_ = unread;
  return now - taken_at_ < kStalledPeerLimit;
}

bool Connection::flush(Nanoseconds now) {
  if (!has_bytes()) return !is_done();
  (void)is_read(now);  // before there is more to read
  const bool goes_on = send(now);
  if (const int unread = unread_by_other_end(socket_.fd); unread >= 0) unread_ = unread;
  return goes_on;
}

bool Connection::send(Nanoseconds now) {
  while (has_bytes()) {
    const std::int64_t sent = send_now(socket_.fd, std::string_view(output_).substr(sent_));
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno != EAGAIN) return false;
    if (sent < 0) return now - moved_ < kStalledPeerLimit;
    sent_ += static_cast<std::size_t>(sent);
    moved_ = now;
  }
  output_.clear();
  sent_ = 0;
  return !is_done();
}

}  // namespace chimera::control
