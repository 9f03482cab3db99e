// SPDX-License-Identifier: Apache-2.0
// Prints and wipes a line with the number of finished pieces.
#include "chimera/cli/batch/piece_progress.h"

#include "chimera/base/hosted/wording.h"
#include "chimera/platform/standard_streams.h"

namespace chimera::cli {

std::string pieces_text(std::size_t done, std::size_t all, const std::string& noun, Nanoseconds wall) {
  std::string line = std::to_string(done) + " of " + std::to_string(all) + " " + noun;
  if (done == 0 || done >= all) return line;
  const double left = to_seconds(wall) * static_cast<double>(all - done) / static_cast<double>(done);
  return line + formatted(", about %.0f s to go", left);
}

PieceProgress::PieceProgress(std::size_t all, std::string noun, std::FILE* err)
    : all_(all), noun_(std::move(noun)), err_(err), is_on_(is_terminal(::fileno(err))) {}

void PieceProgress::show(std::size_t done) {
  const auto now = std::chrono::steady_clock::now();
  if (!is_on_ || now < next_) return;
  const Nanoseconds wall{std::chrono::nanoseconds(now - begin_).count()};
  std::fprintf(err_, "\r%s\033[K", pieces_text(done, all_, noun_, wall).c_str());
  std::fflush(err_);
  next_ = now + std::chrono::milliseconds(200);
  has_written_ = true;
}

void PieceProgress::wipe() {
  if (has_written_) std::fputs("\r\033[K", err_);
  has_written_ = false;
}

}  // namespace chimera::cli
