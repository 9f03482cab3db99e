// SPDX-License-Identifier: Apache-2.0
// Reads the elements <link> and <joint> of a URDF text and checks that they form one tree of joints with limits.
#include "library/model_text/urdf_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "library/model_text/xml_tags.h"

namespace chimera::library {
namespace {

constexpr std::size_t kMostLinks = 1000;
constexpr std::size_t kMostNested = 100;
constexpr std::pair<std::string_view, UrdfKind> kKinds[] = {
    {"fixed", UrdfKind::kFixed},         {"revolute", UrdfKind::kRevolute}, {"continuous", UrdfKind::kContinuous},
    {"prismatic", UrdfKind::kPrismatic}, {"planar", UrdfKind::kPlanar},     {"floating", UrdfKind::kFloating}};

Error bad(const std::string& text) {
  Error error;
  error.message = FixedString<400>(text);
  return error;
}

std::string quoted(std::string_view name) {
  constexpr std::size_t kShown = 64;
  return "'" + std::string(name.substr(0, kShown)) + (name.size() > kShown ? "...'" : "'");
}

/// The facts that no component uses. Each has one place in the note.
enum Ignored : std::uint8_t { kMimics, kSoftLimits, kNoEffort, kMissingBound, kBoundsOfContinuous, kIgnored };
constexpr const char* kIgnoredTexts[kIgnored] = {"it mimics another and is free", "soft limits are not used",
                                                 "effort or velocity is 0: no limit", "a missing bound is 0",
                                                 "it is continuous: no bounds"};

class Reader {
 public:
  explicit Reader(std::string_view text) : tags_(text) {}

  Result<UrdfText> read() {
    for (XmlTag tag; fault_.empty() && tags_.next_of_all(tag);) tag.is_end ? close(tag) : open(tag);
    if (fault_.empty() && (!tags_.is_sound() || !open_.empty() || !has_root_))
      fault_ = "line " + std::to_string(tags_.line()) + ": the XML ends too early or is ill-formed";
    if (fault_.empty()) judge_tree();
    if (!fault_.empty()) return bad(fault_);
    made_.note = note();
    return std::move(made_);
  }

 private:
  void fail(const std::string& why) {
    if (fault_.empty()) fault_ = why;
  }

  void open(const XmlTag& tag) {
    if (open_.empty() && std::exchange(has_root_, true)) return fail("there is a second root element");
    if (open_.empty() && tag.element != "robot") fail("the root element is <" + std::string(tag.element) + ">");
    if (open_.size() == kMostNested) return fail("the elements are nested too deeply");
    const std::string_view parent = open_.empty() ? "" : open_.back();
    if (open_.size() == 1 && tag.element == "link") add_link(tag);
    if (open_.size() == 1 && tag.element == "joint") begin_joint(tag);
    if (open_.size() == 2 && parent == "joint") add_part(tag);
    open_.push_back(tag.element);
    if (tag.is_empty) close(tag);
  }

  void close(const XmlTag& tag) {
    if (open_.empty() || open_.back() != tag.element)
      return fail("line " + std::to_string(tag.line) + ": </" + std::string(tag.element) + "> closes no element");
    open_.pop_back();
    if (open_.size() == 1 && tag.element == "joint") end_joint();
  }

  void add_link(const XmlTag& tag) {
    made_.links.push_back(plain(value_of(tag, "name")));
    if (made_.links.back().empty()) fail("a link has no name");
    if (made_.links.size() > kMostLinks) fail("there are more than 1000 links");
  }

  void begin_joint(const XmlTag& tag) {
    joint_ = {};
    seen_.clear();
    bounds_ = 0;
    joint_.name = plain(value_of(tag, "name"));
    if (joint_.name.empty()) return fail("a joint has no name");
    const std::string_view type = value_of(tag, "type");
    const auto* kind = std::ranges::find(kKinds, type, &std::pair<std::string_view, UrdfKind>::first);
    if (kind == std::end(kKinds))
      return fail(said() + " has the unknown type " + quoted(type) +
                  "; expected revolute, continuous, prismatic, fixed, floating or planar");
    joint_.kind = kind->second;
  }

  void add_part(const XmlTag& tag) {
    constexpr std::string_view kOnce[] = {"parent", "child", "origin",   "axis",
                                          "limit",  "mimic", "dynamics", "safety_controller"};
    if (std::ranges::find(kOnce, tag.element) == std::end(kOnce)) return;
    if (has(tag.element)) return fail(said() + " has two elements <" + std::string(tag.element) + ">");
    seen_.push_back(tag.element);
    if (tag.element == "parent") joint_.parent = plain(value_of(tag, "link"));
    if (tag.element == "child") joint_.child = plain(value_of(tag, "link"));
    if (tag.element == "origin") take_origin(tag);
    if (tag.element == "axis") joint_.axis = numbers(tag, "xyz", {1, 0, 0});
    if (tag.element == "limit") take_limit(tag);
    if (tag.element == "mimic") take_mimic(tag);
    if (tag.element == "safety_controller") ignore(kSoftLimits);
  }

  void take_origin(const XmlTag& tag) {
    const Vec3 xyz = numbers(tag, "xyz", {0, 0, 0}), rpy = numbers(tag, "rpy", {0, 0, 0});
    const double cr = std::cos(rpy[0]), sr = std::sin(rpy[0]), cp = std::cos(rpy[1]), sp = std::sin(rpy[1]);
    const double cy = std::cos(rpy[2]), sy = std::sin(rpy[2]);
    joint_.origin = {xyz,
                     {cy * cp, sy * cp, -sp},
                     {cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr},
                     {cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr}};
  }

  void take_mimic(const XmlTag& tag) {
    joint_.mimics = plain(value_of(tag, "joint"));
    if (joint_.mimics.empty()) fail(said() + " has a <mimic> that names no joint");
    ignore(kMimics);
  }

  void take_limit(const XmlTag& tag) {
    bounds_ = (value_of(tag, "lower").data() != nullptr ? 1 : 0) + (value_of(tag, "upper").data() != nullptr ? 1 : 0);
    joint_.low = number(tag, "lower");
    joint_.high = number(tag, "upper");
    joint_.speed = number(tag, "velocity");
    joint_.effort = number(tag, "effort");
    if (joint_.speed < 0 || joint_.effort < 0) fail("the velocity or the effort of " + said() + " is below 0");
    if (joint_.kind == UrdfKind::kFixed || (joint_.speed > 0 && joint_.effort > 0)) return;
    ignore(kNoEffort);
    for (double* most : {&joint_.speed, &joint_.effort})
      if (!(*most > 0)) *most = kNoModelLimit;
  }

  void end_joint() {
    if (!fault_.empty()) return;
    const bool is_limited = joint_.kind == UrdfKind::kRevolute || joint_.kind == UrdfKind::kPrismatic;
    if (is_limited) judge_range();
    else if (bounds_ > 0 && joint_.kind == UrdfKind::kContinuous) ignore(kBoundsOfContinuous);
    if (!is_limited) joint_.low = -kNoModelLimit, joint_.high = kNoModelLimit;
    const bool has_axis = joint_.kind != UrdfKind::kFixed && joint_.kind != UrdfKind::kFloating;
    if (has_axis && !(length(joint_.axis) > 1e-9)) fail("the axis of " + said() + " has no direction");
    made_.joints.push_back(joint_);
  }

  void judge_range() {
    if (!has("limit"))
      return fail(said() + " has no <limit>: give lower, upper, effort and velocity, or make it continuous or fixed");
    if (joint_.low > joint_.high) return fail("the lower limit of " + said() + " is above its upper one");
    if (joint_.low == joint_.high)
      return fail("the limits of " + said() + " leave no range: give lower and upper, or make it continuous or fixed");
    if (bounds_ < 2) ignore(kMissingBound);
  }

  void judge_tree() {
    std::ranges::sort(made_.links);
    const auto twice = std::ranges::adjacent_find(made_.links);
    if (twice != made_.links.end()) return fail("there are two links " + quoted(*twice));
    for (const UrdfJoint& joint : made_.joints) judge_ends(joint);
    if (!fault_.empty()) return;
    std::vector<std::string_view> roots;
    for (const std::string& link : made_.links)
      if (made_.joint_before(link) == nullptr) roots.push_back(link);
    if (made_.links.empty()) return fail("there is no link");
    if (roots.size() > 1)
      return fail("links " + quoted(roots[0]) + " and " + quoted(roots[1]) + " have no parent; expected one root");
    if (roots.empty() || has_circle(roots[0])) return fail("its joints go round in a circle");
    for (const UrdfJoint& joint : made_.joints)
      if (joint.kind == UrdfKind::kFloating && joint.parent != roots[0])
        fail("joint " + quoted(joint.name) + " floats on link " + quoted(joint.parent) + "; expected on the root");
    if (roots[0] != "world" && made_.has_link("world")) fail("link 'world' has a parent; expected a root");
  }

  void judge_ends(const UrdfJoint& joint) {
    for (const std::string& link : {joint.parent, joint.child})
      if (!made_.has_link(link))
        fail("joint " + quoted(joint.name) + " names link " + quoted(link) + ", which does not exist");
    for (const UrdfJoint& other : made_.joints) {
      if (&other == &joint) continue;
      if (other.name == joint.name) fail("there are two joints " + quoted(joint.name));
      if (other.child == joint.child)
        fail("link " + quoted(joint.child) + " has two parents, by joints " + quoted(joint.name) + " and " +
             quoted(other.name));
    }
    const auto is_mimicked = [&](const UrdfJoint& other) { return other.name == joint.mimics && &other != &joint; };
    if (!joint.mimics.empty() && std::ranges::none_of(made_.joints, is_mimicked))
      fail("joint " + quoted(joint.name) + " mimics " + quoted(joint.mimics) + ", which is no other joint");
  }

  /// Requires: each link but `root` has one parent.
  bool has_circle(std::string_view root) const {
    std::set<std::string_view> sound{root};  // the root is above them
    for (const std::string& link : made_.links) {
      std::vector<std::string_view> way;
      for (std::string_view at = link; !sound.contains(at); at = made_.joint_before(at)->parent) {
        if (way.size() > made_.joints.size()) return true;
        way.push_back(at);
      }
      sound.insert(way.begin(), way.end());
    }
    return false;
  }

  /// Three numbers; `otherwise` without the attribute. check_model_numbers() has refused ill-formed ones.
  static Vec3 numbers(const XmlTag& tag, std::string_view attribute, Vec3 otherwise) {
    std::string_view text = value_of(tag, attribute);
    for (std::size_t i = 0; i < 3 && !text.empty(); ++i) {
      text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n+"), text.size()));
      const auto read = std::from_chars(text.data(), text.data() + text.size(), otherwise[i]);
      text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
    }
    return otherwise;
  }
  static double number(const XmlTag& tag, std::string_view attribute) { return numbers(tag, attribute, {0, 0, 0})[0]; }

  bool has(std::string_view element) const { return std::ranges::find(seen_, element) != seen_.end(); }
  std::string said() const { return "joint " + quoted(joint_.name); }
  void ignore(Ignored what) {
    if (++count_[what] == 1) first_[what] = joint_.name.substr(0, 24);
  }
  std::string note() const {
    std::string text;
    for (std::size_t i = 0; i < kIgnored; ++i) {
      if (count_[i] == 0) continue;
      const std::string more = count_[i] > 1 ? " and " + std::to_string(count_[i] - 1) + " more" : "";
      text += (text.empty() ? "" : "; ") + first_[i] + more + ": " + kIgnoredTexts[i];
    }
    return text;
  }

  XmlTags tags_;
  UrdfText made_;
  std::string fault_;
  std::vector<std::string_view> open_, seen_;  // elements: not closed yet; of the present joint
  UrdfJoint joint_;
  int bounds_ = 0;  // stated for the present joint
  bool has_root_ = false;
  std::array<std::size_t, kIgnored> count_{};
  std::array<std::string, kIgnored> first_;
};

}  // namespace

bool UrdfText::has_link(std::string_view name) const noexcept { return std::ranges::binary_search(links, name); }

const UrdfJoint* UrdfText::joint_before(std::string_view link) const noexcept {
  const auto found = std::ranges::find_if(joints, [&](const UrdfJoint& joint) { return joint.child == link; });
  return found == joints.end() ? nullptr : &*found;
}

bool is_urdf(std::string_view text) {
  constexpr std::string_view kRobot = "robot";
  XmlTags tags(text);
  XmlTag tag;
  if (!tags.next(tag)) return false;
  return std::ranges::equal(tag.element, kRobot, [](unsigned char a, char b) { return std::tolower(a) == b; });
}

Result<UrdfText> read_urdf_text(std::string_view text) { return Reader(text).read(); }

}  // namespace chimera::library
