// SPDX-License-Identifier: Apache-2.0
// Measures a variable over a whole run: "max |error|", "rms tau[2]", "settling error <= 2 mrad".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "chimera/cli/run/application.h"
#include "chimera/cli/run/expectation.h"

namespace chimera::cli {

/// `[WORD] VARIABLE`, the variable perhaps between |bars| (magnitudes), perhaps with an element (`q[2]`) or a field
/// (`target.x`). WORD is end (when left out), min, max, mean, rms, or settling with a comparison behind the variable:
/// the time from which on it holds until the end. The samples count alike. Context: setup.
class Measure {
 public:
  enum class Kind : std::uint8_t { kEnd, kMin, kMax, kMean, kRms, kSettling };
  struct Number {
    std::string name;  ///< "max |error|", "q[2]"
    std::string unit;
    std::optional<double> value;  ///< nothing: never written, not a number, or not settled at the end
  };

  /// Refuses an unknown variable with the nearest one, and what is no number.
  static Result<Measure> parse(const std::string& text, const Configuration& configuration, const UnitSystem& units);
  /// `MEASURE OP QUANTITY`, and of settling `settling VARIABLE OP QUANTITY within DURATION`.
  static Result<Measure> parse_expectation(const std::string& text, const Configuration& configuration,
                                           const UnitSystem& units);

  /// One that parse_expectation() has accepted elsewhere, whose bound was `bound`. Refuses what is no comparison.
  static Result<Measure> with_bound(const std::string& text, const Bound& bound);

  /// True if the value of a whole variable at the end counts, as of Expectation.
  bool is_end_of_variable() const;

  /// Once the extents are known. Refuses an element that the variable does not have.
  Result<void> bind(const Application& application);
  /// Binds to the names and units of the numbers of the variable; only the first names count.
  Result<void> bind(const std::vector<std::string>& names, const std::vector<std::string>& units);
  /// The values at `at` since the start. Requires: bound to an application; times grow.
  void add_sample(Nanoseconds at) { add_sample(probe_->sample(), at); }
  /// Likewise of values from elsewhere.
  void add_sample(const Seen& seen, Nanoseconds at);
  std::vector<Number> numbers() const;
  /// True if every number satisfies the expectation of parse_expectation(); `said` lists the numbers.
  bool holds(std::string& said) const;

  const std::string& text() const noexcept { return text_; }
  const std::string& variable() const noexcept { return variable_; }
  /// Requires: an expectation.
  const Bound& bound() const noexcept { return bound_->bound(); }

 private:
  /// The samples of one number, summed up.
  struct Sum {
    double last = 0, least = 0, greatest = 0, sum = 0, squares = 0;
    bool is_number = true;
  };

  static Result<Measure> read_words(const std::string& text);
  static Result<Measure> read(const std::string& text, const Configuration& configuration);
  Result<std::string> comparison();
  std::string compared() const;
  Result<void> read_bound(const std::string& comparison, const Configuration& configuration, const UnitSystem& units);
  std::optional<double> value_of(const Sum& sum) const;
  std::string name_of(const std::string& number) const;

  std::string text_, variable_, element_, rest_;
  Kind kind_ = Kind::kEnd;
  bool magnitude_ = false;
  std::optional<Expectation> bound_;  ///< of settling, and of an expectation
  Nanoseconds within_ = kNever;       ///< of an expectation of settling
  std::optional<Probe> probe_;
  std::vector<std::size_t> chosen_;         ///< numbers of the variable
  std::vector<std::string> names_, units_;  ///< of those
  std::vector<Sum> sums_;
  std::uint64_t samples_ = 0;
  std::optional<Nanoseconds> settled_;
};

}  // namespace chimera::cli
