// SPDX-License-Identifier: Apache-2.0
// Generated URDF files: urdf_model and the three simulated robots read the same arm, or refuse with the same sentence.
#include "library/model_text/urdf_text.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <vector>

#include "chimera/task/rig.h"
#include "library/model_text/urdf_chain.h"
#include "library/mujoco/testing/random_arm.h"

namespace chimera::library {
namespace {

/// Makes a tree of links with one main chain, side branches and, in most files, one oddity.
class GeneratedUrdf {
 public:
  explicit GeneratedUrdf(unsigned seed) : random_(seed) {
    add_link("base");
    std::string parent = "base";
    const std::size_t joints = 1 + draw(5);
    for (std::size_t i = 0; i < joints; ++i) {
      const std::string link = "l" + std::to_string(i);
      add_link(link);
      add_joint("j" + std::to_string(i), draw(4) == 0 ? "continuous" : "revolute", parent, link);
      parent = link;
      if (draw(3) == 0) add_fixed(parent, "f" + std::to_string(i));
      if (draw(5) == 0) parent = "f" + std::to_string(i), add_fixed(link, parent + "x"), parent += "x";
    }
    if (draw(2) == 0) add_fixed(parent, "tool0");
    if (draw(3) == 0) add_link("finger"), add_joint("slide", "prismatic", parent, "finger");
    if (draw(2) == 0) tip_ = links_[draw(links_.size())];
    make_odd(draw(14));
  }
  const std::string& tip() const { return tip_; }
  std::string text(const std::string& extension = "") const {
    std::string made = "<robot name='r'>" + extension;
    for (const std::string& part : parts_) made += part + "\n";
    return made + "</robot>";
  }

 private:
  std::size_t draw(std::size_t below) { return random_() % below; }
  std::string number(double most) {
    std::ostringstream text;
    text << std::uniform_real_distribution<double>(-most, most)(random_);
    return text.str();
  }
  std::string three(double most) { return number(most) + " " + number(most) + " " + number(most); }
  void add_link(const std::string& name) {
    links_.push_back(name);
    parts_.push_back("<link name='" + name + "'><inertial><origin xyz='.1 0 0'/><mass value='1'/><inertia ixx='.01' "
                     "ixy='0' ixz='0' iyy='.01' iyz='0' izz='.01'/></inertial></link>");
  }
  std::string origin() { return draw(4) == 0 ? "" : "<origin xyz='" + three(1) + "' rpy='" + three(3) + "'/>"; }
  void add_fixed(const std::string& parent, const std::string& link) {
    add_link(link);
    parts_.push_back("<joint name='to_" + link + "' type='fixed'><parent link='" + parent + "'/><child link='" + link +
                     "'/>" + origin() + "</joint>");
  }
  void add_joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& link) {
    const std::string axis = draw(4) == 0 ? "" : "<axis xyz='" + three(2) + "'/>";
    const std::string limit = type == "continuous" && draw(2) == 0
                                  ? ""
                                  : "<limit lower='-" + std::to_string(draw(3)) + ".5' upper='1.25' effort='" +
                                        std::to_string(draw(3) * 20) + "' velocity='" + std::to_string(draw(3)) + "'/>";
    moving_ = parts_.size();
    parts_.push_back("<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
                     link + "'/>" + origin() + axis + limit + "</joint>");
  }
  void replace(const std::string& from, const std::string& to) {
    std::string& joint = parts_[moving_];
    const std::size_t at = joint.find(from);
    if (at != std::string::npos) joint.replace(at, from.size(), to);
  }
  void without_limit(const std::string& instead) {
    std::string& joint = parts_[moving_];
    const std::size_t at = joint.find("<limit");
    if (at != std::string::npos) joint.replace(at, joint.find("/>", at) + 2 - at, instead);
  }
  void make_odd(std::size_t kind) {
    const char* types[] = {"ball", "screw", "Revolute", "", "free", "hinge", "planar", "floating"};
    switch (kind) {
      case 0: return replace("type='", std::string("type='") + types[draw(6)]);
      case 1: return replace("</joint>", "<mimic joint='j0'/></joint>");
      case 2: return replace("</joint>", "<mimic joint='nothing'/></joint>");
      case 3: return without_limit("");
      case 4: return without_limit("<limit lower='0' upper='0' effort='0' velocity='0'/>");
      case 5: return without_limit("<limit effort='5' velocity='1'/>");
      case 6: return without_limit("<limit lower='1' upper='-1' effort='5' velocity='1'/>");
      case 7: return replace("</joint>", "<safety_controller soft_lower_limit='-.1' soft_upper_limit='.1' "
                                         "k_position='1' k_velocity='1'/></joint>");
      case 8: return add_link("second_root");
      case 9: return add_joint("again", "revolute", "base", links_[1 + draw(links_.size() - 1)]);
      case 10: return replace("revolute", types[6 + draw(2)]);
      case 11: return replace("<parent link='", "<parent link='no_");
      case 12: return without_limit("<limit upper='1' effort='5' velocity='1'/>");
      default: return;
    }
  }

  std::mt19937 random_;
  std::vector<std::string> links_, parts_;
  std::string tip_;
  std::size_t moving_ = 0;
};

struct Told {
  std::string refusal, note;
  std::vector<double> limits;
  DhChain chain;
};

Told told_by(const char* component, const std::string& path, const std::string& tip) {
  Rig rig(component);
  rig.resource("model", path.c_str());
  rig.set("tip", Text<64>(tip.c_str()));
  Told told{rig.init().text, "", {}, {}};
  for (const std::string& note : rig.notes()) told.note += note;
  if (!told.refusal.empty()) return told;
  told.chain.ndof = static_cast<std::size_t>(rig.get<std::int32_t>("ndof"));
  told.chain.base = rig.get<Pose>("base");
  told.chain.tool = rig.get<Pose>("tool");
  for (std::size_t i = 0; i < told.chain.ndof; ++i) {
    told.chain.dh[i] = rig.get<DhLink>("dh", i);
    for (const char* port : {"q_min", "q_max", "tau_max"}) told.limits.push_back(rig.get<double>(port, i));
    told.limits.push_back(rig.get<bool>("is_continuous", i) ? 1 : 0);
  }
  return told;
}

/// The tip as MuJoCo places it, in a model that keeps fixed links, against the frame that the constants give.
void compare_with_mujoco(const GeneratedUrdf& urdf, const std::string& path, const DhChain& chain) {
  const Result<UrdfChain> facts = read_urdf(path, urdf.tip());
  ASSERT_TRUE(facts);
  MujocoArm arm(urdf.text("<mujoco><compiler fusestatic='false'/></mujoco>"));
  ASSERT_TRUE(arm.model);
  std::vector<double> q(chain.ndof);
  for (std::size_t i = 0; i < q.size(); ++i) {
    q[i] = 0.1 + 0.2 * static_cast<double>(i);
    const int joint = mj_name2id(arm.model.get(), mjOBJ_JOINT, facts->joints[i].c_str());
    ASSERT_GE(joint, 0);
    arm.state->qpos[arm.model->jnt_qposadr[joint]] = q[i];
  }
  mj_kinematics(arm.model.get(), arm.state.get());
  const int body = mj_name2id(arm.model.get(), mjOBJ_BODY, facts->tip.c_str());
  ASSERT_GE(body, 0) << facts->tip;
  const Frame frame = tool_frame(chain, q);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(frame.origin[i], arm.state->xpos[3 * body + static_cast<int>(i)], 1e-6);
    EXPECT_NEAR(frame.x[i], arm.state->xmat[9 * body + 3 * static_cast<int>(i)], 1e-6);
  }
}

TEST(UrdfText, UrdfModelAndTheRobotsAgreeOnGeneratedFiles) {
  const std::string path = testing::TempDir() + "urdf_text_" + std::to_string(::getpid()) + ".urdf";
  std::map<std::string, int> outcomes;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const GeneratedUrdf urdf(seed);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", tip '" + urdf.tip() + "': " + urdf.text());
    std::ofstream(path) << urdf.text();
    const Told model = told_by("urdf_model", path, urdf.tip());
    for (const char* robot : {"mujoco_robot", "mujoco_robot_velocity", "mujoco_robot_torque"}) {
      SCOPED_TRACE(robot);
      const Told told = told_by(robot, path, urdf.tip());
      EXPECT_EQ(told.refusal, model.refusal);
      EXPECT_EQ(told.note, model.note);
      EXPECT_EQ(told.limits, model.limits);
      EXPECT_EQ(told.chain.ndof, model.chain.ndof);
    }
    if (model.refusal.empty()) compare_with_mujoco(urdf, path, model.chain);
    ++outcomes[model.refusal.empty() ? "read" : model.refusal.substr(path.size(), 12)];
    if (HasFailure()) break;
  }
  ::unlink(path.c_str());
  EXPECT_GT(outcomes["read"], 80) << "files that make an arm";
  EXPECT_GT(outcomes.size(), 8u) << "kinds of refusals";
}

struct UrdfTextTest : ::testing::Test {
  static std::string refusal(const std::string& text) {
    const Result<UrdfText> read = read_urdf_text(text);
    return read ? "read" : std::string(read.error().message.view());
  }
  /// Two links with the joint `inside` between them.
  static std::string with(const std::string& type, const std::string& inside) {
    return "<robot><link name='a'/><link name='b'/><joint name='j' type='" + type +
           "'><parent link='a'/><child link='b'/>" + inside + "</joint></robot>";
  }
};

TEST_F(UrdfTextTest, RefusesATypeThatMujocoWouldNotBear) {
  EXPECT_EQ(refusal(with("ball", "")), "joint 'j' has the unknown type 'ball'; expected revolute, continuous, "
                                       "prismatic, fixed, floating or planar");
}

TEST_F(UrdfTextTest, RefusesAJointThatTurnsWithoutARange) {
  const std::string none =
      "the limits of joint 'j' leave no range: give lower and upper, or make it continuous or fixed";
  EXPECT_EQ(refusal(with("revolute", "<limit lower='0' upper='0' effort='0' velocity='0'/>")), none);
  EXPECT_EQ(refusal(with("revolute", "<limit effort='1' velocity='1'/>")), none);
  EXPECT_EQ(refusal(with("prismatic", "<limit effort='1' velocity='1'/>")), none);
  EXPECT_EQ(refusal(with("revolute", "")),
            "joint 'j' has no <limit>: give lower, upper, effort and velocity, or make it continuous or fixed");
}

TEST_F(UrdfTextTest, NamesWhatItIgnores) {
  const Result<UrdfText> read = read_urdf_text(
      with("continuous", "<limit lower='-1' upper='1' effort='0' velocity='1'/><safety_controller k_velocity='1'/>"));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->note, "j: soft limits are not used; j: effort or velocity is 0: no limit; "
                        "j: it is continuous: no bounds");
  EXPECT_EQ(read->joints[0].high, kNoModelLimit);
  EXPECT_EQ(read->joints[0].effort, kNoModelLimit);
}

TEST_F(UrdfTextTest, RefusesATextThatIsNoTree) {
  EXPECT_EQ(refusal("<robot><link name='a'/><link name='b'/></robot>"),
            "links 'a' and 'b' have no parent; expected one root");
  EXPECT_EQ(refusal("<robot/>"), "there is no link");
  EXPECT_EQ(refusal("<Robot/>"), "the root element is <Robot>");
  EXPECT_EQ(refusal("<robot><link name='a'/>"), "line 1: the XML ends too early or is ill-formed");
  EXPECT_EQ(refusal("<robot>\n<link name='a'></robot>"), "line 2: </robot> closes no element");
  EXPECT_EQ(refusal("<robot><link name='a'/></robot><robot/>"), "there is a second root element");
  EXPECT_EQ(refusal("<robot><link name='a'/><link name='a'/></robot>"), "there are two links 'a'");
  std::string many = "<robot>";
  for (int i = 0; i < 1001; ++i) many += "<link name='l" + std::to_string(i) + "'/>";
  EXPECT_EQ(refusal(many + "</robot>"), "there are more than 1000 links");
}

// A text that is cut anywhere, or has one letter replaced, makes an arm or a refusal, never a crash.
TEST_F(UrdfTextTest, DamagedTextsAreReadOrRefusedByBoth) {
  const std::string path = testing::TempDir() + "urdf_damaged_" + std::to_string(::getpid()) + ".urdf";
  std::mt19937 random(28);
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::string text = GeneratedUrdf(13 + 14 * (seed % 7)).text();
    const std::size_t at = random() % text.size();
    if (seed % 4 == 0) text.resize(at);
    else if (seed % 4 == 1) text.erase(at, 1 + random() % 8);
    else text[at] = "<>/'=\"&! 0a\n"[random() % 12];
    std::ofstream(path) << text;
    const Told model = told_by("urdf_model", path, ""), robot = told_by("mujoco_robot", path, "");
    EXPECT_TRUE(model.refusal.empty() || !robot.refusal.empty()) << text << "\n" << model.refusal;
  }
  ::unlink(path.c_str());
}

// The same for MJCF, and for sizes that no memory holds.
TEST_F(UrdfTextTest, DamagedMjcfIsReadOrRefused) {
  const std::string sound =
      "<mujoco><size nstack='9000' njmax='90' nconmax='90'/><compiler angle='radian'/><worldbody><body name='b' pos='0 "
      "0 1'><joint name='j' type='hinge' axis='0 1 0' limited='true' range='-1 1'/><geom type='capsule' fromto='0 0 0 "
      "1 0 0' size='.1'/><site name='s'/></body></worldbody><actuator><motor joint='j'/></actuator></mujoco>";
  const std::string path = testing::TempDir() + "mjcf_damaged_" + std::to_string(::getpid()) + ".xml";
  const auto refusal_of = [&](const std::string& text) {
    std::ofstream(path) << text;
    return told_by("mujoco_robot", path, "").refusal;
  };
  EXPECT_EQ(refusal_of(sound), "");
  std::mt19937 random(29);
  for (unsigned seed = 0; seed < 600; ++seed) {
    std::string text = sound;
    const std::size_t at = random() % text.size();
    if (seed % 4 == 0) text.resize(at);
    else if (seed % 4 == 1) text.erase(at, 1 + random() % 8);
    else text[at] = "<>/'=\"&! 0a9-\n"[random() % 14];
    (void)refusal_of(text);
  }
  for (const char* size : {"nstack", "njmax", "nconmax"}) {
    std::string text = sound;
    text.replace(text.find(size), std::string(size).size() + 3, std::string(size) + "='2147483647");
    (void)refusal_of(text);
  }
  EXPECT_EQ(refusal_of(sound), "") << "a refused file leaves nothing behind";
  ::unlink(path.c_str());
}

}  // namespace
}  // namespace chimera::library
