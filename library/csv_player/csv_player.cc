// SPDX-License-Identifier: Apache-2.0
// Plays the values of a CSV file by time: the counterpart of csv_log. README.md is the data sheet.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chimera/task/component.h"
#include "library/csv_player/recording.h"
#include "library/signals/fade.h"
#include "library/signals/input.h"
#include "library/signals/recording_column.h"

using namespace chimera;

namespace {

struct CsvPlayer {
  Many<Out<double[]>> out{"out*", "U", "[n...<=64]",
                           doc = "Columns of the variable's name; a matrix row by row."};
  Many<In<double[]>, 1> start{"start*", "X", "[m...<=64]",
                              doc = "Measured value of the first output, for on; may be left out."};
  InConst<double>     blend{"blend", "s", initial = 1.0, range(0, 3600),
                            doc = "Time in which the way from start to the rows fades; 0: a jump."};
  InConst<bool>       is_repeated{"is_repeated", "1", initial = false, doc = "Starts again behind the last row."};
  InConst<bool>       is_interpolated{"is_interpolated", "1", initial = false,
                                      doc = "Interpolates between rows; false: a row holds until the next."};
  InConst<Text<256>>  columns{"columns", initial = "",
                              doc = "Names of the recorded variables, if others: one for each output."};
  Out<bool>           done{"done", "1", initial = false, doc = "The last row was played."};
  Resource            file{"file", safe_state, shared, doc = "CSV file whose first column is the time in s."};

  void init(Cycle c) {
    if (out.size() == 0) throw std::runtime_error("there is nothing to play: name at least one output");
    const std::vector<std::string> names = recorded_names(c);
    std::vector<library::WantedColumn> wanted;
    for (std::size_t k = 0; k < out.size(); ++k)
      for (std::size_t i = 0; i < out[k].size(); ++i)
        wanted.push_back({names[k] + library::column_index(*out[k].live(), i), library::column_text(c.unit(out[k]))});
    recording_ = library::read_recording(file.c_str(), wanted);
    if (start.size() == 0) return;
    if (start[0].size() < out[0].size()) throw std::runtime_error("start has fewer elements than the first output");
    if (c.unit(start[0]) != c.unit(out[0]))
      throw std::runtime_error("start is in another unit than the first output");
  }
  void on() { begin(out.size() > 0 && out[0].is_handed_over()); }
  // A machine that holds itself under the flag does not follow: the rows wait, then start where the machine is.
  void cycle(Cycle c) {
    const bool waits = c.illegal() && start.size() > 0;
    if (waits || stood_) {
      if (!waits) begin(false);
      stood_ = waits;
      return;
    }
    elapsed_ += c.step();
    fade_.advance(c.dt());
    publish();
  }

 private:
  std::vector<std::string> recorded_names(Cycle c) const {
    std::vector<std::string> names;
    std::string word;
    for (const char letter : std::string(columns->view()) + " ") {
      if (letter != ' ') word += letter;
      else if (!word.empty()) names.push_back(std::exchange(word, {}));
    }
    if (names.empty())
      for (const auto& port : out) names.push_back(library::column_text(c.variable(port)));
    if (names.size() != out.size())
      throw std::runtime_error("`columns` has " + std::to_string(names.size()) + " names, and there are " +
                               std::to_string(out.size()) + " outputs");
    return names;
  }
  /// From a first output that is handed over, else from `start`, else from the rows.
  void begin(bool goes_on) {
    stood_ = false;
    elapsed_ = {};
    fade_.start(0);
    const bool has_start = start.size() > 0 && out.size() > 0 && *blend > 0;
    goes_on = goes_on && has_start && library::all_finite(out[0]);
    const bool is_measured = has_start && library::all_finite(start[0]);
    for (std::size_t i = 0; (goes_on || is_measured) && i < out[0].size(); ++i)
      away_[i] = goes_on ? out[0][i] : start[0][i];
    publish();
    if (!goes_on && !is_measured) return;
    fade_.start(*blend);
    for (std::size_t i = 0; i < out[0].size(); ++i) {
      away_[i] -= out[0][i];
      out[0][i] += away_[i];
    }
  }
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
    const double left = fade_.left();
    for (std::size_t i = 0; left > 0 && i < out[0].size(); ++i) out[0][i] += left * away_[i];
  }

  library::Recording recording_;
  Nanoseconds elapsed_;
  library::Fade fade_;
  double away_[library::kMostElements] = {};  // the way from the rows to the start
  bool stood_ = false;                        // the flag was up in the last cycle
};

CHIMERA_COMPONENT(CsvPlayer, "csv_player", "Plays the values of a CSV file by time.", rate = 1000.0);

}  // namespace
