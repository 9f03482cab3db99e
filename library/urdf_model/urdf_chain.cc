// SPDX-License-Identifier: Apache-2.0
// Walks from the root of a URDF model to a tip and collects its joints.
#include "chimera/base/hosted/classic_locale.h"
#include "chimera/base/hosted/ordinary_file.h"
#include "library/urdf_model/urdf_chain.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

namespace chimera::library {
namespace {

constexpr double kNone = 1e6;
constexpr std::size_t kLongest = std::size_t{4} << 20;  // bytes of a file, at most

Error bad(const std::string& text) {
  Error error;
  error.message = FixedString<400>(text);
  return error;
}

/// Collects the first error message, because urdfdom reports errors only to its log.
class FirstReason final : public console_bridge::OutputHandler {
 public:
  FirstReason() : before_(console_bridge::getOutputHandler()) { console_bridge::useOutputHandler(this); }
  ~FirstReason() override { console_bridge::useOutputHandler(before_); }
  FirstReason(const FirstReason&) = delete;
  FirstReason& operator=(const FirstReason&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (text_.empty() && level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) text_ = text;
  }
  std::string text() const { return text_.empty() ? "it is no URDF file" : text_; }

 private:
  console_bridge::OutputHandler* before_;
  std::string text_;
};

bool turns(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
}

/// Joints from the root to `link`, with fixed ones. In a loop the result has one joint more than the model.
std::vector<urdf::JointConstSharedPtr> joints_to(const urdf::ModelInterface& model, urdf::LinkConstSharedPtr link) {
  std::vector<urdf::JointConstSharedPtr> joints;
  while (link && link->parent_joint && joints.size() <= model.joints_.size()) {
    joints.push_back(link->parent_joint);
    link = model.getLink(link->parent_joint->parent_link_name);
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

bool has_circle(const urdf::ModelInterface& model) {
  return std::ranges::any_of(model.links_, [&model](const auto& named) {
    return joints_to(model, named.second).size() > model.joints_.size();
  });
}

/// The link behind the most turning joints. Links are sorted by name, so the choice is repeatable.
std::string farthest_link(const urdf::ModelInterface& model) {
  std::string best;
  std::size_t most = 0;
  for (const auto& [name, link] : model.links_) {
    std::size_t turning = 0;
    for (const auto& joint : joints_to(model, link)) {
      if (turns(*joint)) ++turning;
      else if (joint->type != urdf::Joint::FIXED) turning = 0;
    }
    if (turning > most) {
      most = turning;
      best = name;
    }
  }
  return best;
}

Frame frame_of_origin(const urdf::Pose& pose) {
  Pose place{{pose.position.x, pose.position.y, pose.position.z}, {1, 0, 0, 0}};
  pose.rotation.getQuaternion(place.orientation[1], place.orientation[2], place.orientation[3], place.orientation[0]);
  return frame_of(place);
}

void take_limits(const urdf::Joint& joint, std::size_t i, UrdfChain& found) {
  const bool limited = joint.type == urdf::Joint::REVOLUTE && joint.limits;
  found.joints[i] = joint.name;
  found.low[i] = limited ? joint.limits->lower : -kNone;
  found.high[i] = limited ? joint.limits->upper : kNone;
  found.speed[i] = joint.limits && joint.limits->velocity > 0 ? joint.limits->velocity : kNone;
  found.effort[i] = joint.limits && joint.limits->effort > 0 ? joint.limits->effort : kNone;
}

Result<UrdfChain> walk(const std::vector<urdf::JointConstSharedPtr>& joints) {
  UrdfChain found;
  std::array<JointAxis, kMostJoints> axes;
  std::size_t n = 0;
  Frame frame;
  for (const auto& joint : joints) {
    frame = frame * frame_of_origin(joint->parent_to_joint_origin_transform);
    if (joint->type == urdf::Joint::FIXED) continue;
    if (!turns(*joint)) return bad("joint '" + joint->name + "' slides or floats; expected joints that turn");
    if (joint->mimic) return bad("joint '" + joint->name + "' mimics another; expected joints of their own");
    if (n == kMostJoints) return bad("there are more than " + std::to_string(kMostJoints) + " joints");
    const Vec3 axis{joint->axis.x, joint->axis.y, joint->axis.z};
    if (!(length(axis) > 1e-9)) return bad("the axis of joint '" + joint->name + "' has no direction");
    axes[n] = {frame.origin, frame.rotate(axis)};
    take_limits(*joint, n, found);
    if (found.low[n] > found.high[n]) {
      return bad("the lower limit of joint '" + joint->name + "' is above its upper one");
    }
    ++n;
  }
  if (n == 0) return bad("no joint turns between the root and the tip");
  found.chain = dh_of_axes(std::span(axes.data(), n), frame);
  return found;
}

}  // namespace

Result<UrdfChain> read_urdf(const std::string& path, const std::string& tip) {
  if (const std::string why = not_ordinary(path, SIZE_MAX); !why.empty()) return bad(path + ": " + why);
  std::ifstream file(path);
  if (!file) return bad(path + ": cannot be read");
  std::string text(kLongest + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLongest) return bad(path + ": is longer than 4 MiB");
  urdf::ModelInterfaceSharedPtr model;
  {
    const ClassicLocale decimal_point;
    FirstReason reason;
    model = urdf::parseURDF(text);
    if (!model) return bad(path + ": " + reason.text());
  }
  if (has_circle(*model)) {
    for (const auto& [name, link] : model->links_) link->child_links.clear();  // breaks ownership cycles
    return bad(path + ": its joints go round in a circle");
  }
  const std::string link = tip.empty() ? farthest_link(*model) : tip;
  if (!tip.empty() && !model->getLink(tip)) return bad(path + ": there is no link '" + tip + "'");
  Result<UrdfChain> found = walk(joints_to(*model, model->getLink(link)));
  if (!found) return bad(path + ": " + std::string(found.error().message.view()));
  return found;
}

}  // namespace chimera::library
