// SPDX-License-Identifier: Apache-2.0
// Walks from the root of a URDF model to a tip and collects its joints.
#include "library/model_text/urdf_chain.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "chimera/base/hosted/ordinary_file.h"
#include "library/model_text/model_numbers.h"

namespace chimera::library {
namespace {

constexpr std::size_t kLongest = std::size_t{4} << 20;  // bytes of a file, at most

Error bad(const std::string& text) {
  Error error;
  error.message = FixedString<400>(text);
  return error;
}

/// Joints from the root to `link`, with fixed ones.
std::vector<const UrdfJoint*> joints_to(const UrdfText& text, std::string_view link) {
  std::vector<const UrdfJoint*> joints;
  for (const UrdfJoint* joint = text.joint_before(link); joint != nullptr; joint = text.joint_before(joint->parent))
    joints.push_back(joint);
  std::reverse(joints.begin(), joints.end());
  return joints;
}

/// Links are sorted by name, so the choice is repeatable.
std::string farthest_link(const UrdfText& text) {
  std::string best;
  std::pair<std::size_t, std::size_t> most;  // joints that turn, all joints
  for (const std::string& link : text.links) {
    const std::vector<const UrdfJoint*> joints = joints_to(text, link);
    std::pair<std::size_t, std::size_t> here{0, joints.size()};
    for (const UrdfJoint* joint : joints) {
      if (joint->turns()) ++here.first;
      else if (joint->kind != UrdfKind::kFixed) here.first = 0;
    }
    if (here.first == 0 || here <= most) continue;
    most = here;
    best = link;
  }
  return best;
}

Result<UrdfChain> walk(const std::vector<const UrdfJoint*>& joints) {
  UrdfChain found;
  std::size_t n = 0;
  Frame frame;
  for (const UrdfJoint* joint : joints) {
    frame = frame * joint->origin;
    if (joint->kind == UrdfKind::kFixed) continue;
    if (!joint->turns()) return bad("joint '" + joint->name + "' slides or floats; expected joints that turn");
    if (!joint->mimics.empty()) return bad("joint '" + joint->name + "' mimics another; expected joints of their own");
    if (n == kMostJoints) return bad("there are more than " + std::to_string(kMostJoints) + " joints");
    found.axes[n] = {frame.origin, frame.rotate(joint->axis)};
    found.joints[n] = joint->name;
    found.low[n] = joint->low;
    found.high[n] = joint->high;
    found.speed[n] = joint->speed;
    found.effort[n] = joint->effort;
    found.is_continuous[n++] = joint->kind == UrdfKind::kContinuous;
  }
  if (n == 0) return bad("no joint turns between the root and the tip");
  found.chain = dh_of_axes(std::span(found.axes.data(), n), frame);
  return found;
}

}  // namespace

Result<UrdfChain> read_urdf(const std::string& path, const std::string& tip) {
  if (const std::string why = not_ordinary(path, SIZE_MAX); !why.empty()) return bad(path + ": " + why);
  const Result<std::string> bytes = read_ordinary(path, kLongest + 1);
  if (!bytes) return bad(path + ": cannot be read");
  if (bytes->size() > kLongest) return bad(path + ": is longer than 4 MiB");
  if (const Result<void> sound = check_model_numbers(path); !sound) return sound.error();
  const Result<UrdfText> text = read_urdf_text(*bytes);
  if (!text) return bad(path + ": " + std::string(text.error().message.view()));
  if (!tip.empty() && !text->has_link(tip)) return bad(path + ": there is no link '" + tip + "'");
  const std::string link = tip.empty() ? farthest_link(*text) : tip;
  Result<UrdfChain> found = walk(joints_to(*text, link));
  if (!found) return bad(path + ": " + std::string(found.error().message.view()));
  found->tip = link;
  found->note = text->note;
  return found;
}

}  // namespace chimera::library
