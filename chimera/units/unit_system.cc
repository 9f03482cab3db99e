// SPDX-License-Identifier: Apache-2.0
// Reads the units with UDUNITS-2, and suggests the unit that a wrong one probably means.
#include "chimera/units/unit_system.h"

#include <udunits2.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <sstream>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/text/nearest.h"
#include "chimera/units/unit_text.h"

namespace chimera {
namespace {

constexpr std::size_t kMostUnitBytes = 1 << 20;  // the file of the framework has 10 KiB

/// UDUNITS keeps its status and its parser in static variables, so only one thread may call it at a time.
std::mutex& inside() {
  static std::mutex mutex;
  return mutex;
}

/// Slips that no edit distance finds, and compound units that a word without dots most likely means.
constexpr const char* kCompounds[] = {"N.m", "N.s", "N.m/rad", "N.m.s/rad", "rad/s", "m/s", "m/s2", "km/h", "kW.h"};
const std::map<std::string, std::string, std::less<>>& slips() {
  static const std::map<std::string, std::string, std::less<>> kSlips{
      {"Nm", "N.m"},     {"sec", "s"},    {"secs", "s"},    {"msec", "ms"},    {"usec", "us"},
      {"kph", "km/h"},   {"kmh", "km/h"}, {"rps", "rev/s"}, {"gravity", "gn"}, {"Nms", "N.m.s"},
      {"rads", "rad/s"}, {"mps", "m/s"},  {"none", "1"},    {"hr", "h"},       {"turn", "rev"},
      {"Vs", "V.s"},     {"As", "A.s"},    {"Ws", "W.s"},     {"kgm", "kg.m"},   {"mNm", "mN.m"},
      {"kNm", "kN.m"}};
  return kSlips;
}

/// Collects the parts of a unit from UDUNITS: value_in_base = factor * (x + offset).
struct UnitParts {
  Unit unit;
  bool is_known = true;
};

void add_base(UnitParts& parts, const ut_unit* base, int exponent) {
  const char* symbol = ut_get_symbol(base, UT_ASCII);
  for (std::size_t i = 0; i < kBaseUnits; ++i) {
    if (symbol != nullptr && base_unit_name(i) == symbol) {
      parts.unit.exponents[i] = static_cast<std::int16_t>(exponent);
      return;
    }
  }
  parts.is_known = false;
}

ut_status visit_basic(const ut_unit* unit, void* parts) {
  add_base(*static_cast<UnitParts*>(parts), unit, 1);
  return UT_SUCCESS;
}

ut_status visit_product(const ut_unit*, int count, const ut_unit* const* bases, const int* powers, void* parts) {
  for (int i = 0; i < count; ++i) add_base(*static_cast<UnitParts*>(parts), bases[i], powers[i]);
  return UT_SUCCESS;
}

ut_status visit_galilean(const ut_unit*, double scale, const ut_unit* under, double offset, void* data);

ut_status visit_timestamp(const ut_unit*, const ut_unit*, double, void* parts) {
  static_cast<UnitParts*>(parts)->is_known = false;
  return UT_SUCCESS;
}

ut_status visit_logarithmic(const ut_unit*, double, const ut_unit*, void* parts) {
  static_cast<UnitParts*>(parts)->is_known = false;
  return UT_SUCCESS;
}

const ut_visitor kVisitor{visit_basic, visit_product, visit_galilean, visit_timestamp, visit_logarithmic};

ut_status visit_galilean(const ut_unit*, double scale, const ut_unit* under, double offset, void* data) {
  UnitParts& parts = *static_cast<UnitParts*>(data);
  const ut_status status = ut_accept_visitor(under, &kVisitor, data);
  // f * (s * (x + o) + p) = f * s * (x + o + p / s)
  parts.unit.offset = offset + parts.unit.offset / scale;
  parts.unit.factor *= scale;
  return status;
}

/// The texts between <tag> and </tag>, except those of prefixes.
void collect(const std::string& xml, const std::string& tag, std::vector<std::string>& names) {
  const std::string open = "<" + tag + ">", close = "</" + tag + ">";
  for (std::size_t at = xml.find(open); at != std::string::npos; at = xml.find(open, at)) {
    const std::size_t prefix = xml.rfind("<prefix>", at), unit = xml.rfind("<unit>", at);
    at += open.size();
    const std::size_t end = xml.find(close, at);
    if (end == std::string::npos) return;
    if (unit != std::string::npos && (prefix == std::string::npos || prefix < unit)) {
      names.push_back(xml.substr(at, end - at));
    }
  }
}

/// ": REASON" if the last call failed for lack of memory or descriptors.
std::string want() {
  const bool is_want = errno == EMFILE || errno == ENFILE || errno == ENOMEM;
  return is_want ? std::string(": ") + std::strerror(errno) : "";
}

/// The units of `xml`. UDUNITS reads only files, so the text is presented as a file.
ut_system* read_units(const std::string& xml) {
  const auto file = FrozenBytes::create("chimera-units", std::as_bytes(std::span(xml)));
  if (!file) return nullptr;
  const std::scoped_lock lock(inside());
  ut_set_error_message_handler(ut_ignore);
  return ut_read_xml(("/proc/self/fd/" + std::to_string(file->descriptor())).c_str());
}

}  // namespace

struct UnitSystem::Content {
  ut_system* system = nullptr;
  std::string file;
  std::string xml;
  std::vector<std::string> names;
  mutable std::map<std::string, std::optional<Unit>, std::less<>> cache;  // guarded by inside()

  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    const std::scoped_lock lock(inside());
    if (system != nullptr) ut_free_system(system);
  }

  std::optional<Unit> meaning(std::string_view word) const {
    const std::scoped_lock lock(inside());
    if (const auto known = cache.find(word); known != cache.end()) return known->second;
    const std::string name(word);
    std::optional<Unit> found;
    if (ut_unit* unit = ut_parse(system, name.c_str(), UT_ASCII); unit != nullptr) {
      UnitParts parts;
      if (ut_accept_visitor(unit, &kVisitor, &parts) == UT_SUCCESS && parts.is_known) found = parts.unit;
      ut_free(unit);
    }
    if (cache.size() < 1000) cache.emplace(name, found);
    return found;
  }

  std::string unknown(std::string_view word) const {
    const auto slip = slips().find(word);
    const std::string near = slip != slips().end() ? slip->second : nearest(word, names);
    return in_double_quotes(word) + " is no known unit" + did_you_mean(near, '"');
  }
};

Result<UnitSystem> UnitSystem::load(std::span<const std::string> files) {
  std::vector<std::string> places(files.begin(), files.end());
  if (const char* named = std::getenv("CHIMERA_UNITS"); named != nullptr && *named != '\0') places = {named};
  for (const std::string& place : places)
    if (auto text = read_ordinary(place, kMostUnitBytes)) return of(*std::move(text), place);
  std::string all = "no unit file; looked for";
  for (const std::string& place : places) all += " " + place;
  all += want();
  return Error{ErrorCode::kNotFound, std::string_view(all), {}};
}

Result<UnitSystem> UnitSystem::of(std::string text, std::string file) {
  auto content = std::make_shared<Content>();
  content->xml = std::move(text);
  content->file = std::move(file);
  content->system = read_units(content->xml);
  if (content->system == nullptr || !content->meaning("rad")) {
    const std::string why = "no unit file of UDUNITS-2 with the base unit rad" + want();
    return Error{ErrorCode::kBadInput, std::string_view(why), std::string_view(content->file)};
  }
  collect(content->xml, "symbol", content->names);
  collect(content->xml, "singular", content->names);
  content->names.insert(content->names.end(), std::begin(kCompounds), std::end(kCompounds));
  return UnitSystem(std::move(content));
}

Result<Unit> UnitSystem::parse(std::string_view text) const {
  const auto expression = parse_expression(text);
  if (!expression) return expression.error();
  if (expression.value().is_concrete()) return expression.value().rest;
  const std::string why = "unit \"" + std::string(text) + "\": U, X, Y and Z are unit variables of generic ports";
  return Error{ErrorCode::kBadInput, std::string_view(why), {}};
}

Result<UnitExpression> UnitSystem::parse_expression(std::string_view text) const {
  const auto meaning = [this](std::string_view word) -> std::optional<UnitExpression> {
    UnitExpression expression;
    if (word.size() == 1 && kUnitVariables.find(word) != std::string_view::npos) {
      expression.variables[kUnitVariables.find(word)] = 1;
      return expression;
    }
    const auto unit = content_->meaning(word);
    if (!unit) return std::nullopt;
    expression.rest = *unit;
    expression.words = {UnitWord{std::string(word)}};
    return expression;
  };
  return read_unit_text(text, meaning, [this](std::string_view word) { return content_->unknown(word); });
}

std::span<const std::string> UnitSystem::names() const noexcept { return content_->names; }
const std::string& UnitSystem::file() const noexcept { return content_->file; }
const std::string& UnitSystem::text() const noexcept { return content_->xml; }

}  // namespace chimera
