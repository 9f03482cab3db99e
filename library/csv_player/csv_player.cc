// SPDX-License-Identifier: Apache-2.0
// Plays the values of a CSV file by time: the counterpart of csv_log. README.md is the data sheet.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "chimera/task/component.h"
#include "library/csv_player/recording.h"
#include "library/signals/recording_column.h"

using namespace chimera;

namespace {

struct CsvPlayer {
  Many<Out<double[]>> out{"out*", "U", "[n...<=64]",
                          doc = "Columns of the variable's name; a matrix row by row."};
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
