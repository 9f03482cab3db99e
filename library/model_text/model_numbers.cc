// SPDX-License-Identifier: Apache-2.0
// Checks the numbers in the attributes of a model file.
#include "library/model_text/model_numbers.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <span>
#include <string_view>
#include <vector>

#include "chimera/base/hosted/ordinary_file.h"
#include "library/model_text/xml_tags.h"

namespace chimera::library {
namespace {

constexpr int kMostNested = 8;
constexpr std::size_t kLongest = std::size_t{16} << 20;  // bytes of a file

/// Number of values of an attribute; 0: any number.
struct Numbers {
  std::string_view element, attribute;  // an empty element means every element
  std::size_t count;
};

// MuJoCo knows more attributes with numbers. These two lists cover robots.
constexpr Numbers kUrdf[] = {
    {"origin", "xyz", 3},        {"origin", "rpy", 3},         {"axis", "xyz", 3},          {"mass", "value", 1},
    {"inertia", "ixx", 1},       {"inertia", "ixy", 1},        {"inertia", "ixz", 1},       {"inertia", "iyy", 1},
    {"inertia", "iyz", 1},       {"inertia", "izz", 1},        {"limit", "lower", 1},       {"limit", "upper", 1},
    {"limit", "effort", 1},      {"limit", "velocity", 1},     {"dynamics", "damping", 1},  {"dynamics", "friction", 1},
    {"mimic", "multiplier", 1},  {"mimic", "offset", 1},       {"calibration", "rising", 1},
    {"calibration", "falling", 1},                             {"safety_controller", "k_velocity", 1},
    {"safety_controller", "k_position", 1},                    {"safety_controller", "soft_lower_limit", 1},
    {"safety_controller", "soft_upper_limit", 1},              {"box", "size", 3},          {"sphere", "radius", 1},
    {"cylinder", "radius", 1},   {"cylinder", "length", 1},    {"capsule", "radius", 1},    {"capsule", "length", 1},
    {"mesh", "scale", 3},        {"color", "rgba", 4}};

// In MJCF an attribute has the same meaning in every element, except scale and force of a muscle.
constexpr Numbers kMjcf[] = {
    {"", "pos", 3},         {"", "quat", 4},        {"", "axis", 3},      {"", "euler", 3},      {"", "axisangle", 4},
    {"", "xyaxes", 6},      {"", "zaxis", 3},       {"", "fromto", 6},    {"", "gravity", 3},    {"", "wind", 3},
    {"", "magnetic", 3},    {"", "diaginertia", 3}, {"", "range", 2},     {"", "center", 3},     {"", "dir", 3},
    {"", "fullinertia", 6}, {"", "anchor", 3},      {"", "ctrlrange", 2}, {"", "forcerange", 2}, {"", "actrange", 2},
    {"", "lengthrange", 2}, {"", "refpos", 3},      {"", "refquat", 4},   {"", "relpose", 7}};

constexpr std::string_view kWhole[] = {
    "group",      "contype",    "conaffinity", "condim",           "priority",       "njmax",     "nconmax",
    "nstack",     "nuserdata",  "nkey",        "nuser_body",       "nuser_jnt",      "nuser_geom", "nuser_site",
    "nuser_cam",  "nuser_tendon", "nuser_actuator", "nuser_sensor", "iterations",    "noslip_iterations",
    "mpr_iterations", "offwidth", "offheight",  "shadowsize",      "offsamples",     "numslices", "numstacks",
    "numquads",   "nrow",       "ncol",        "dim"};

// Attributes with a name or a word. In <rgba> and <scale> of <visual> they have numbers.
constexpr std::string_view kNames[] = {
    "name",   "class",     "childclass", "model",    "file",    "meshdir",    "texturedir", "material",   "texture",
    "mesh",   "hfield",    "target",     "joint",    "joint1",  "joint2",     "body",       "body1",      "body2",
    "geom",   "geom1",     "geom2",      "site",     "sidesite", "slidersite", "cranksite", "refsite",    "tendon",
    "tendon1", "tendon2",  "objname",    "prefix",   "actuator", "fileright", "fileleft",   "fileup",     "filedown",
    "filefront", "fileback", "gridlayout", "link",   "filename", "type",      "key",        "instance",   "plugin"};

bool has(std::span<const std::string_view> words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

std::vector<std::string_view> words_of(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  std::vector<std::string_view> words;
  for (;;) {
    const std::size_t begin = text.find_first_not_of(kSpace);
    if (begin == std::string_view::npos) return words;
    text.remove_prefix(begin);
    words.push_back(text.substr(0, text.find_first_of(kSpace)));
    text.remove_prefix(words.back().size());
  }
}

std::string_view without_sign(std::string_view word) {
  return word.starts_with('+') || word.starts_with('-') ? word.substr(1) : word;
}

/// True for nan, inf and infinity in any letters, which strtod accepts. XML entities may hide them, too.
bool is_no_number(std::string_view word) {
  std::string small(without_sign(word));
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (small.find('&') != std::string::npos) return true;
  return small == "nan" || small.starts_with("nan(") || small == "inf" || small == "infinity";
}

bool is_finite_number(std::string_view word) {
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  double value = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return fault == std::errc{} && end == digits.data() + digits.size() && std::isfinite(value);
}

bool is_whole(std::string_view word) {
  std::int32_t value = 0;
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return fault == std::errc{} && end == digits.data() + digits.size();
}

const Numbers* known(std::span<const Numbers> all, std::string_view element, std::string_view attribute) {
  const auto found = std::ranges::find_if(all, [&](const Numbers& n) {
    return n.attribute == attribute && (n.element.empty() || n.element == element);
  });
  return found == all.end() ? nullptr : &*found;
}

class Reader {
 public:
  explicit Reader(std::string folder) : folder_(std::move(folder)) {}

  Result<void> read(const std::string& path, int depth) {
    if (const std::string why = not_ordinary(path, SIZE_MAX); !why.empty()) return bad(path + ": " + why);
    std::ifstream file(path);
    std::string text;
    for (char part[4096]; text.size() <= kLongest && (file.read(part, sizeof part), file.gcount() > 0);)
      text.append(part, static_cast<std::size_t>(file.gcount()));
    if (text.size() > kLongest) return bad(path + ": is longer than 16 MiB");
    XmlTags tags(text);
    XmlTag tag;
    while (tags.next(tag)) {
      if (tag.element == "robot") is_urdf_ = true;
      for (const auto& [attribute, value] : tag.attributes) {
        const std::string why = judge(tag.element, attribute, value);
        if (!why.empty()) return bad(place(path, tag, attribute) + why);
        if (tag.element != "include" || attribute != "file" || depth == kMostNested) continue;
        const std::string inner = value.starts_with('/') ? std::string(value) : folder_ + std::string(value);
        if (Result<void> read_inner = read(inner, depth + 1); !read_inner) return read_inner;
      }
    }
    return {};
  }

 private:
  static Error bad(const std::string& text) {
    Error error;
    error.message = FixedString<400>(text);
    return error;
  }
  static std::string place(const std::string& path, const XmlTag& tag, std::string_view attribute) {
    std::string text = path + ":" + std::to_string(tag.line) + ": attribute '" + std::string(attribute) + "' of <" +
                       std::string(tag.element) + ">";
    for (const auto& [name, value] : tag.attributes)
      if (name == "name" && attribute != "name") text += " '" + std::string(value) + "'";
    return text + ": ";
  }
  static std::string found(std::string_view word) { return "found '" + std::string(word.substr(0, 40)) + "'"; }

  std::string judge(std::string_view element, std::string_view attribute, std::string_view value) const {
    const bool is_picture = element == "rgba" || element == "scale";
    const bool is_text = element == "flag" || (element == "text" && attribute == "data");
    if (is_text || (has(kNames, attribute) && !is_picture)) return {};
    const Numbers* of_urdf = is_urdf_ ? known(kUrdf, element, attribute) : nullptr;
    const Numbers* numbers = of_urdf != nullptr ? of_urdf : is_urdf_ ? nullptr : known(kMjcf, element, attribute);
    const bool whole = has(kWhole, attribute) && !is_urdf_;
    const std::vector<std::string_view> words = words_of(value);
    for (const std::string_view word : words) {
      if (is_no_number(word) || (numbers != nullptr && !is_finite_number(word))) {
        return found(word) + ", expected a finite number; write one, or leave the attribute out";
      }
      if (whole && !is_whole(word)) return found(word) + ", expected a whole number";
    }
    if (numbers == nullptr || words.size() == numbers->count) return {};
    return "found " + std::to_string(words.size()) + (words.size() == 1 ? " number" : " numbers") + ", expected " +
           std::to_string(numbers->count);
  }

  std::string folder_;
  bool is_urdf_ = false;
};

}  // namespace

Result<void> check_model_numbers(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return Reader(slash == std::string::npos ? "" : path.substr(0, slash + 1)).read(path, 0);
}

}  // namespace chimera::library
