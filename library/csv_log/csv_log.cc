// SPDX-License-Identifier: Apache-2.0
// Writes its inputs of every cycle to a CSV file in the background. README.md is the data sheet.
//
//   cycle (one writer)                         background (one reader)
//   ring[put mod capacity] = row               put (acquire) | text of the row | taken = taken + 1 (release)
//   put = put + 1 (release)                    write; text_ keeps the bytes that the disk refuses, for the next try
// A row is lost only if cycle finds capacity rows between taken and put.
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "chimera/task/component.h"
#include "chimera/task/number_at.h"
#include "library/device/recording_file.h"
#include "library/signals/recording_column.h"

using namespace chimera;
using library::column_index, library::column_text;

namespace {

constexpr std::size_t kTextBytes = 1 << 16;     // bytes of one write
constexpr std::uint64_t kMostBytes = 1u << 29;  // bytes of all rows in the ring

struct CsvLog {
  Many<In<Any[]>>       in{"in*", "U", "[n...<=64]", type = "T", doc = "Numbers or truth values."};
  InConst<std::int32_t> capacity{"capacity", "1", initial = 10000, range(1, 1000000),
                                 doc = "Rows that may wait for the disk."};
  Out<std::int64_t>     rows{"rows", "1", initial = 0, doc = "Rows in the file or in the ring."};
  Out<std::int64_t>     lost{"lost", "1", initial = 0, doc = "Rows dropped."};
  Out<std::int32_t>     disk_error{"disk_error", "1", initial = 0,
                                   doc = "Error number while the disk refuses data; 0: none."};
  Resource              file{"file", safe_state, doc = "File to write; if it has data, NAME.2.csv."};

  void init(Cycle c) {
    check_inputs();
    columns_ = 1;
    for (const auto& port : in) columns_ += port.size();
    capacity_ = static_cast<std::uint64_t>(*capacity);
    check_room();
    // Writes every page now, because the first access to a page costs a page fault, which a cycle must not pay.
    ring_.assign(columns_ * capacity_, 0.0);
    text_.reserve(2 * kTextBytes);
    text_ = header(c);
    const library::RecordingFile opened = library::open_recording(file.c_str());
    file_ = opened.file;
    const std::string note = library::other_path_note(file.c_str(), opened.path);
    if (!note.empty()) c.note(note.c_str());
  }
  void on(Cycle c) {
    if (put_.load(std::memory_order_relaxed) == 0) origin_ = c.now();
    has_told_refusal_ = has_told_loss_ = false;
  }
  void cycle(Cycle c) {
    *disk_error = error_.load(std::memory_order_relaxed);
    if (*disk_error != 0) tell_refusal(c);
    const std::uint64_t put = put_.load(std::memory_order_relaxed);
    // SYNC: pairs with the release in background(): background has finished with the rows before taken_.
    if (put - taken_.load(std::memory_order_acquire) >= capacity_) {
      *lost = static_cast<std::int64_t>(++n_lost_);
      tell_loss(c);
      return;
    }
    double* row = ring_.data() + put % capacity_ * columns_;
    *row++ = static_cast<double>((c.now() - origin_).count) * 1e-9;
    for (const auto& port : in) {
      const std::span<const std::byte> bytes = port.bytes();
      for (std::size_t i = 0; i < port.size(); ++i) {
        const double value = number_at(port.element_type(), bytes.data() + i * port.element_size());
        *row++ = port.valid() ? value : std::nan("");
      }
    }
    // SYNC: pairs with the acquire in background(): the row is complete before it is counted.
    put_.store(put + 1, std::memory_order_release);
    *rows += 1;
  }
  void background() {
    // SYNC: pairs with the release in cycle().
    const std::uint64_t put = put_.load(std::memory_order_acquire);
    std::uint64_t taken = taken_.load(std::memory_order_relaxed);
    do {
      // Bytes that the disk refused are written before new rows.
      const bool was_empty = text_.empty();
      while (was_empty && taken != put && text_.size() < kTextBytes)
        add_text(ring_.data() + taken++ % capacity_ * columns_);
      // SYNC: pairs with the acquire in cycle(): the places of these rows are free.
      taken_.store(taken, std::memory_order_release);
    } while (!text_.empty() && write_text());
  }
  // The last background() has run, so the disk has refused the remaining rows.
  Outcome kill() {
    if (file_ < 0) return ok();
    const std::uint64_t left = rows_left();
    const int refusal = error_.load(std::memory_order_relaxed);
    const bool is_closed = ::close(std::exchange(file_, -1)) == 0;
    const std::string lost_ones = std::to_string(n_lost_) + " rows found no room";
    if (left > 0) {
      const std::string text = std::to_string(left) + " rows were not written: " + std::strerror(refusal);
      return fault(n_lost_ > 0 ? text + "; before them " + lost_ones : text, refusal);
    }
    if (n_lost_ > 0) return fault("the file lacks rows: " + lost_ones + ", the disk did not take them in time");
    return is_closed ? ok() : fault("the file could not be closed");
  }
  ~CsvLog() {
    if (file_ >= 0) ::close(file_);
  }

 private:
  void check_inputs() const {
    if (in.size() == 0) throw std::runtime_error("there is nothing to log: name at least one input");
    for (const auto& port : in)
      if (port.element_type() > CHIMERA_FLOAT64) throw std::runtime_error("texts and structs cannot be logged");
  }
  void check_room() const {
    const std::uint64_t row = columns_ * sizeof(double);
    if (capacity_ * row > kMostBytes)
      throw std::runtime_error("rows of " + std::to_string(columns_) + " values are " + std::to_string(row) +
                               " bytes: at most " + std::to_string(kMostBytes / row) +
                               " of them may wait, and capacity is " + std::to_string(capacity_));
  }
  // One note after each `on`. Later refusals and losses only count in `lost`.
  void tell_refusal(Cycle c) {
    if (std::exchange(has_told_refusal_, true)) return;
    char text[CHIMERA_FAULT_TEXT];
    std::snprintf(text, sizeof text, "the disk refuses rows: %s; %llu may wait", reason(*disk_error),
                  static_cast<unsigned long long>(capacity_));
    c.note(text);
  }
  void tell_loss(Cycle c) {
    if (std::exchange(has_told_loss_, true)) return;
    char text[CHIMERA_FAULT_TEXT];
    std::snprintf(text, sizeof text, "rows are lost from t = %.3f s on: %s", to_seconds(c.now() - origin_),
                  *disk_error == 0 ? "the disk does not keep up" : reason(*disk_error));
    c.note(text);
  }
  // strerror() may load a translation, which takes too long for a cycle.
  static const char* reason(int error) {
    const char* text = ::strerrordesc_np(error);
    return text != nullptr ? text : "it refuses";
  }
  static std::string unit(std::string_view text) {
    return text.empty() || text == "1" ? "" : "(" + column_text(text) + ")";
  }
  std::string header(Cycle c) const {
    std::string line = "t(s)";
    for (const auto& port : in)
      for (std::size_t i = 0; i < port.size(); ++i)
        line += "," + column_text(c.variable(port)) + column_index(*port.live(), i) + unit(c.unit(port));
    return line + "\n";
  }
  void add_text(const double* row) {
    char number[40];
    for (std::size_t i = 0; i < columns_; ++i) {
      if (i > 0) text_ += ',';
      if (std::isnan(row[i])) continue;
      // Has a decimal point whatever the locale of the process.
      text_.append(number, std::to_chars(number, number + sizeof number, row[i], std::chars_format::general, 15).ptr);
    }
    text_ += '\n';
  }
  // Returns false if the disk did not accept all bytes. The next call writes the rest, with the row that the disk cut.
  bool write_text() {
    std::size_t done = 0;
    while (done < text_.size()) {
      const ssize_t n = ::write(file_, text_.data() + done, text_.size() - done);
      if (n > 0) done += static_cast<std::size_t>(n);
      else if (n == 0 || errno != EINTR) break;
    }
    const bool is_whole = done == text_.size();
    error_.store(is_whole ? 0 : errno, std::memory_order_relaxed);
    text_.erase(0, is_whole ? done : whole_rows(done));
    return is_whole;
  }
  // Removes the cut row behind `done` written bytes from the file. Returns the bytes of text_ that are in the file.
  std::size_t whole_rows(std::size_t done) const {
    const std::size_t end = done == 0 ? 0 : text_.rfind('\n', done - 1) + 1;  // 0 without a whole row
    const off_t at = ::lseek(file_, 0, SEEK_CUR) - static_cast<off_t>(done - end);  // below 0 for a pipe
    return at >= 0 && ::ftruncate(file_, at) == 0 && ::lseek(file_, at, SEEK_SET) == at ? end : done;
  }
  // Rows not yet written, with a partly written one, without the header line.
  std::uint64_t rows_left() const {
    std::uint64_t lines = 0;
    for (const char c : text_) lines += c == '\n' ? 1 : 0;
    const std::uint64_t in_ring = put_.load(std::memory_order_relaxed) - taken_.load(std::memory_order_relaxed);
    const bool has_header = lines > 0 && lines > taken_.load(std::memory_order_relaxed);
    return in_ring + lines - (has_header ? 1 : 0);
  }

  // Constant after init.
  std::size_t columns_ = 1;
  std::uint64_t capacity_ = 0;
  std::vector<double> ring_;  // one row after the other
  // Used by cycle only.
  Nanoseconds origin_;
  std::uint64_t n_lost_ = 0;
  bool has_told_refusal_ = false, has_told_loss_ = false;
  alignas(64) std::atomic<std::uint64_t> put_{0};  // rows since init; release by cycle, acquire by background
  // Used by background.
  alignas(64) std::atomic<std::uint64_t> taken_{0};  // release by background, acquire by cycle: these places are free
  std::atomic<int> error_{0};                        // relaxed: orders no other data; cycle reports it
  std::string text_;  // bytes not yet written
  int file_ = -1;
};

CHIMERA_COMPONENT(CsvLog, "csv_log", "Writes its inputs of every cycle to a CSV file, without delaying a cycle.");

}  // namespace
