// SPDX-License-Identifier: Apache-2.0
// JSON that is too much to be made or copied at once: made piece by piece, as fast as its reader takes it, so that
// others are served between two pieces.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace chimera::control {

inline constexpr std::size_t kPiece = std::size_t{1} << 16;  ///< bytes of a piece, about

/// Context: setup; never blocks.
class Pieces {
 public:
  Pieces() = default;
  Pieces(const Pieces&) = delete;
  Pieces& operator=(const Pieces&) = delete;
  virtual ~Pieces() = default;
  /// Appends the next piece: about kPiece bytes, or a millisecond of work. False: that was the last one.
  virtual bool append_to(std::string& text) = 0;
};

/// A text that is there already. Context: setup.
class TextPieces final : public Pieces {
 public:
  /// `owner` keeps `text`.
  TextPieces(std::shared_ptr<const void> owner, std::string_view text) : owner_(std::move(owner)), left_(text) {}
  bool append_to(std::string& text) override {
    const std::string_view next = left_.substr(0, kPiece);
    text.append(next);
    left_.remove_prefix(next.size());
    return !left_.empty();
  }

 private:
  std::shared_ptr<const void> owner_;
  std::string_view left_;
};

}  // namespace chimera::control
