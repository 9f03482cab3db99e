// SPDX-License-Identifier: Apache-2.0
// Parses measures such as a maximum, a root mean square and a settling time, and computes them sample by sample.
#include "chimera/cli/run/measure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/blanks.h"
#include "chimera/text/nearest.h"
#include "chimera/units/quantity.h"

namespace chimera::cli {
namespace {

constexpr std::array kWords = {"end", "min", "max", "mean", "rms", "settling"};

Error wrong(const std::string& text, const std::string& why) {
  return {ErrorCode::kBadInput, {"'" + text + "': " + why}, {}};
}

std::string number_text(double value, const std::string& unit) {
  return with_unit(formatted("%.6g", value), unit);
}

bool is_of(const std::string& number, const std::string& chosen) {
  return number.starts_with(chosen) &&
         (number.size() == chosen.size() || number[chosen.size()] == '[' || number[chosen.size()] == '.');
}

}  // namespace

Result<Measure> Measure::read_words(const std::string& text) {
  Measure made;
  made.text_ = trimmed(text);
  std::string rest = made.text_;
  const std::size_t blank = rest.find(' ');
  for (std::size_t k = 0; k < kWords.size() && blank != std::string::npos; ++k) {
    const std::size_t behind = rest.find_first_not_of(' ', blank);
    if (rest.substr(0, blank) != kWords[k] || rest[behind] == '<' || rest[behind] == '>') continue;  // a variable `max`
    made.kind_ = static_cast<Kind>(k);
    rest = rest.substr(behind);
    break;
  }
  const std::size_t comparison = rest.find_first_of("<>");
  if (comparison != std::string::npos) made.rest_ = rest.substr(comparison);
  std::string name = trimmed(rest.substr(0, comparison));
  if (name.size() > 2 && name.front() == '|' && name.back() == '|') {
    made.magnitude_ = true;
    name = trimmed(name.substr(1, name.size() - 2));
  }
  made.element_ = name;
  made.variable_ = name.substr(0, name.find_first_of("[."));
  if (name.find(' ') != std::string::npos) {
    const std::vector<std::string> words(kWords.begin(), kWords.end());
    const std::string unknown = no_such("measure", name.substr(0, name.find(' ')), words);
    return wrong(made.text_, unknown + (unknown.ends_with("?") ? " There are " : "; There are ") + join(words, ", "));
  }
  return made;
}

Result<Measure> Measure::read(const std::string& text, const Configuration& configuration) {
  auto made = read_words(text);
  if (!made) return made;
  const auto found = find_variable(configuration, made->variable_);
  if (!found) return wrong(made->text_, found.error().message.c_str());
  if ((*found)->type == "string") return wrong(made->text_, made->variable_ + " is not a number or a list of numbers");
  return made;
}

std::string Measure::compared() const {
  const std::string bars = magnitude_ ? "|" : "";
  return bars + variable_ + bars;
}

// Reads the bound in the unit of the variable. An element or a field has the bound of the whole variable.
Result<void> Measure::read_bound(const std::string& comparison, const Configuration& configuration,
                                 const UnitSystem& units) {
  auto bound = Expectation::read(compared() + " " + comparison, configuration, units);
  if (!bound) return wrong(text_, bound.error().message.c_str());
  bound_ = *std::move(bound);
  return {};
}

Result<Measure> Measure::parse(const std::string& text, const Configuration& configuration, const UnitSystem& units) {
  auto made = read(text, configuration);
  if (!made) return made;
  if (made->kind_ != Kind::kSettling && !made->rest_.empty())
    return wrong(made->text_, "a measure has no comparison, unless it is 'settling'; --expect has one");
  if (made->kind_ != Kind::kSettling) return made;
  if (made->rest_.empty())
    return wrong(made->text_, "write 'settling VARIABLE <= QUANTITY': the time from which on that holds");
  if (auto read = made->read_bound(made->rest_, configuration, units); !read) return read.error();
  return made;
}

// The comparison of an expectation, without `within DURATION`, which it keeps.
Result<std::string> Measure::comparison() {
  if (rest_.empty()) return wrong(text_, "write 'VARIABLE <= QUANTITY', with < <= > or >=");
  const std::size_t within = rest_.find(" within ");
  if ((within != std::string::npos) != (kind_ == Kind::kSettling))
    return wrong(text_, "write 'settling VARIABLE <= QUANTITY within DURATION'");
  if (within == std::string::npos) return rest_;
  const auto limit = parse_duration(trimmed(rest_.substr(within + 8)));
  if (!limit) return wrong(text_, limit.error().message.c_str());
  within_ = *limit;
  return trimmed(rest_.substr(0, within));
}

Result<Measure> Measure::parse_expectation(const std::string& text, const Configuration& configuration,
                                           const UnitSystem& units) {
  auto made = read(text, configuration);
  if (!made) return made;
  const auto comparison = made->comparison();
  if (!comparison) return comparison.error();
  if (auto read = made->read_bound(*comparison, configuration, units); !read) return read.error();
  return made;
}

Result<Measure> Measure::with_bound(const std::string& text, const Bound& bound) {
  auto made = read_words(text);
  if (!made) return made;
  const auto comparison = made->comparison();
  if (!comparison) return comparison.error();
  auto expectation = Expectation::with_bound(made->compared() + " " + *comparison, bound);
  if (!expectation) return expectation.error();
  made->bound_ = *std::move(expectation);
  return made;
}

bool Measure::is_end_of_variable() const { return kind_ == Kind::kEnd && element_ == variable_; }

Result<void> Measure::bind(const Application& application) {
  auto probe = application.probe(variable_);
  if (!probe) return probe.error();
  probe_ = *std::move(probe);
  return bind(number_names(*probe_), number_units(*probe_));
}

Result<void> Measure::bind(const std::vector<std::string>& names, const std::vector<std::string>& units) {
  if (!chosen_.empty()) return {};
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (!is_of(names[n], element_)) continue;
    chosen_.push_back(n);
    names_.push_back(names[n]);
    units_.push_back(units[n]);
  }
  if (chosen_.empty())
    return wrong(text_, names.empty()
                            ? variable_ + " has no numbers"
                            : "no element '" + element_ + "': there are " + names.front() + " to " + names.back());
  sums_.assign(chosen_.size(), {});
  return {};
}

void Measure::add_sample(const Seen& seen, Nanoseconds at) {
  if (!seen.is_written) return;
  Seen chosen{true, {}, {}};
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    double value = seen.numbers[chosen_[i]];
    chosen.numbers.push_back(value);
    if (magnitude_) value = std::fabs(value);
    Sum& sum = sums_[i];
    sum.is_number = sum.is_number && std::isfinite(value);
    sum.last = value;
    sum.least = samples_ == 0 ? value : std::min(sum.least, value);
    sum.greatest = samples_ == 0 ? value : std::max(sum.greatest, value);
    sum.sum += value;
    sum.squares += value * value;
  }
  ++samples_;
  std::string said;
  if (kind_ != Kind::kSettling) return;
  if (!bound_->holds(chosen, said))
    settled_.reset();
  else if (!settled_)
    settled_ = at;
}

std::optional<double> Measure::value_of(const Sum& sum) const {
  if (samples_ == 0) return std::nullopt;
  const bool is_number = kind_ == Kind::kEnd ? std::isfinite(sum.last) : sum.is_number;
  if (!is_number) return std::nullopt;
  const auto n = static_cast<double>(samples_);
  switch (kind_) {
    case Kind::kMin:
      return sum.least;
    case Kind::kMax:
      return sum.greatest;
    case Kind::kMean:
      return sum.sum / n;
    case Kind::kRms:
      return std::sqrt(sum.squares / n);
    case Kind::kEnd:
    case Kind::kSettling:
      break;
  }
  return sum.last;
}

std::string Measure::name_of(const std::string& number) const {
  const std::string bars = magnitude_ ? "|" : "";
  return (kind_ == Kind::kEnd ? "" : std::string(kWords[static_cast<std::size_t>(kind_)]) + " ") + bars + number + bars;
}

std::vector<Measure::Number> Measure::numbers() const {
  if (kind_ == Kind::kSettling) return {{text_, "s", settled_ ? std::optional(to_seconds(*settled_)) : std::nullopt}};
  std::vector<Number> all;
  for (std::size_t i = 0; i < sums_.size(); ++i) all.push_back({name_of(names_[i]), units_[i], value_of(sums_[i])});
  return all;
}

bool Measure::holds(std::string& said) const {
  if (samples_ == 0) {
    said = variable_ + " was never written";
    return false;
  }
  if (kind_ == Kind::kSettling) {
    said = settled_ ? "it holds from " + number_text(to_seconds(*settled_), "s") + " on" : "it does not at the end";
    return settled_ && *settled_ <= within_;
  }
  Seen seen{true, {}, {}};
  for (const Number& number : numbers()) {
    if (said.size() < 200)
      append_joined(said, ", ",
                    number.name + " is " +
                        (number.value ? bound_->value_text({*number.value}, number_text(*number.value, number.unit))
                                      : "not a number"));
    seen.numbers.push_back(number.value.value_or(NAN));
  }
  std::string ignored;
  return bound_->holds(seen, ignored);
}

}  // namespace chimera::cli
