// SPDX-License-Identifier: Apache-2.0
// Writes messages into the ring of their receiver and reads them from the rings of others.
#include "chimera/runtime/outbox.h"

#include <cstring>
#include <type_traits>

#include "chimera/runtime/refusal.h"
#include "chimera/table/shared_copy.h"

namespace chimera {

namespace {

static_assert(std::is_trivially_copyable_v<Post> && alignof(PostRing) == 8 && (kPosts & (kPosts - 1)) == 0);

constexpr std::uint64_t kCountBits = 40;
constexpr std::uint64_t kCountMask = (std::uint64_t{1} << kCountBits) - 1;

constexpr std::uint64_t progress_word(std::uint32_t incarnation, std::uint64_t taken) noexcept {
  return static_cast<std::uint64_t>(incarnation) << kCountBits | (taken & kCountMask);
}
constexpr bool is_of(std::uint64_t word, std::uint32_t incarnation) noexcept {
  return (word ^ progress_word(incarnation, 0)) <= kCountMask;
}

std::byte* place(PostRing& ring, std::uint64_t number) noexcept {
  return reinterpret_cast<std::byte*>(&ring.posts[number % kPosts]);
}
const std::byte* place(const PostRing& ring, std::uint64_t number) noexcept {
  return reinterpret_cast<const std::byte*>(&ring.posts[number % kPosts]);
}

// False for bytes that no sender writes. Judged before the bytes become a Post: a bool must be 0 or 1.
bool to_post(const unsigned char (&bytes)[sizeof(Post)], Post& post) noexcept {
  if (bytes[offsetof(Post, more)] > 1) return false;
  Post read;
  std::memcpy(static_cast<void*>(&read), bytes, sizeof read);
  if (static_cast<std::uint32_t>(read.signal) >= CHIMERA_SIGNALS || read.kind > PostKind::kEvent ||
      read.happening > kLastHappening || read.why > static_cast<std::uint8_t>(kLastRefusal) ||
      read.before > State::kError || read.after > State::kError) {
    return false;
  }
  post = read;
  return true;
}

}  // namespace

std::uint64_t Outbox::room() const noexcept {
  std::uint64_t taken = 0;
  if (progress_ != nullptr) {
    // SYNC: pairs with the release in Inbox::take(): the reader is done with the places it passed.
    const std::uint64_t word = progress_->word.load(std::memory_order_acquire);
    if (is_of(word, incarnation_)) taken = word & kCountMask;
  }
  // In 40 bits, so that the count may wrap; a reader that claims to be ahead of us leaves no room either.
  const std::uint64_t waiting = (ring_->posted.load(std::memory_order_relaxed) - taken) & kCountMask;
  return waiting < kPosts ? kPosts - waiting : 0;
}

bool Outbox::is_followed() const noexcept {
  return progress_ != nullptr && is_of(progress_->word.load(std::memory_order_acquire), incarnation_);
}

bool Outbox::try_post(const Post& post) noexcept {
  if (room() == 0) return false;
  const std::uint64_t posted = ring_->posted.load(std::memory_order_relaxed);
  shared_copy::copy_in(place(*ring_, posted), &post, sizeof post);
  // SYNC: pairs with the acquire in Inbox: the post is whole before it is counted.
  ring_->posted.store(posted + 1, std::memory_order_release);
  return true;
}

Inbox::Inbox(const PostRing& ring, PostProgress& progress, std::uint32_t sender_incarnation) noexcept
    : ring_(&ring), progress_(&progress), incarnation_(sender_incarnation),
      taken_(ring.posted.load(std::memory_order_acquire)) {
  progress_->word.store(progress_word(incarnation_, taken_), std::memory_order_release);
}

Inbox Inbox::resume(const PostRing& ring, PostProgress& progress, std::uint32_t sender_incarnation) noexcept {
  const std::uint64_t left = progress.word.load(std::memory_order_relaxed);
  Inbox made(ring, progress, sender_incarnation);
  const std::uint64_t unread = (made.taken_ - left) & kCountMask;
  if (!is_of(left, sender_incarnation) || unread > kPosts) return made;
  made.taken_ -= unread;
  progress.word.store(left, std::memory_order_release);
  return made;
}

bool Inbox::take(Post& post) noexcept {
  if (ring_ == nullptr) return false;
  // SYNC: pairs with the release in try_post().
  const std::uint64_t posted = ring_->posted.load(std::memory_order_acquire);
  bool found = false;
  const std::uint64_t before = taken_;
  if (posted - taken_ > kPosts) taken_ = posted;  // no sender counts like that: nothing of it is believed
  while (!found && taken_ != posted) {
    unsigned char bytes[sizeof(Post)];
    shared_copy::copy_out(bytes, place(*ring_, taken_), sizeof bytes);
    found = to_post(bytes, post);
    ++taken_;
  }
  // SYNC: pairs with the acquire in try_post(): the copy is done before the place is free.
  if (taken_ != before) progress_->word.store(progress_word(incarnation_, taken_), std::memory_order_release);
  return found;
}

}  // namespace chimera
