// SPDX-License-Identifier: Apache-2.0
// Plays the values of a CSV file by time: the counterpart of csv_log. README.md is the data sheet.
#include <algorithm>
#include <cmath>
#include <vector>

#include "chimera/task/component.h"
#include "library/csv_player/recording.h"

using namespace chimera;

namespace {

struct CsvPlayer {
  Many<Out<double[]>> out{"out*", "U", "[n...<=64]",
                          doc = "Columns after the first, in order; a matrix row by row."};
  InConst<bool>       is_repeated{"is_repeated", "1", initial = false, doc = "Starts again behind the last row."};
  InConst<bool>       is_interpolated{"is_interpolated", "1", initial = false,
                                      doc = "Interpolates between rows; false: a row holds until the next."};
  Out<bool>           done{"done", "1", initial = false, doc = "The last row was played."};
  Resource            file{"file", safe_state, shared, doc = "CSV file whose first column is the time in s."};

  void init() {
    std::size_t values = 0;
    for (const auto& port : out) values += port.size();
    recording_ = library::read_recording(file.c_str(), values);
  }
  void on() {
    elapsed_ = {};
    publish();
  }
  void cycle(Cycle c) {
    elapsed_ += c.step();
    publish();
  }

 private:
  void publish() {
    double t = to_seconds(elapsed_);
    const double whole = recording_.length();
    *done = !*is_repeated && t >= whole;
    if (*is_repeated && whole > 0) t -= whole * std::floor(t / whole);
    const std::size_t row = recording_.row_at(t);
    double part = 0;
    if (*is_interpolated && row + 1 < recording_.rows()) {
      const double from = recording_.time(row), to = recording_.time(row + 1);
      part = (t - from) / (to - from);
    }
    std::size_t column = 0;
    for (const auto& port : out)
      for (double& value : port) value = recording_.value(row, column++, part);
  }

  library::Recording recording_;
  Nanoseconds elapsed_;
};

CHIMERA_COMPONENT(CsvPlayer, "csv_player", "Plays the values of a CSV file by time.", rate = 1000.0);

}  // namespace
