// SPDX-License-Identifier: Apache-2.0
// Reads the modules of an arm from a text file and writes a MuJoCo model of them.
#include "chimera/base/hosted/ordinary_file.h"
#include "library/rmms/module_store.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <locale>
#include <numbers>
#include <sstream>

namespace chimera::library {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Error bad(const std::string& text) {
  Error error;
  error.message = FixedString<400>(text);
  return error;
}

constexpr int kMostLines = 1000, kLongestLine = 256;

const char* judge(const RmmsModule& m) {
  if (std::abs(m.link.a) > 10 || std::abs(m.link.d) > 10) return "a and d are at most 10 m";
  if (m.mass > 1000 || m.torque > 1e6) return "the mass is at most 1000 kg, the torque 1e6 N.m";
  if (std::abs(m.link.alpha) > 7 || std::abs(m.link.theta) > 7) return "alpha and theta are at most 400 deg";
  if (m.low < -1000 || m.high > 1000) return "the limits are at most 1000 rad either way";
  if (!(m.mass > 0)) return "the mass is not positive";
  if (m.mass < 1e-3) return "the mass is at least 1 g";
  if (!(m.torque > 0)) return "the torque is not positive";
  if (!(m.low < m.high)) return "the lower limit is not below the upper one";
  if (std::hypot(m.link.a, m.link.d) < 1e-3) return "the link has no extent: at least 1 mm of a or d";
  return nullptr;
}

/// Returns nullptr, or the error of the line.
const char* read_module(const std::string& line, RmmsModule& m) {
  std::istringstream words(line);
  words.imbue(std::locale::classic());
  double alpha = 0, theta = 0, low = 0, high = 0;
  std::string more;
  if (!(words >> m.name >> m.link.a >> alpha >> m.link.d >> theta >> m.mass >> low >> high >> m.torque) ||
      words >> more) {
    return "expected a name and eight numbers: a alpha d theta mass low high torque";
  }
  m.link.alpha = alpha * kDegree;
  m.link.theta = theta * kDegree;
  m.low = low * kDegree;
  m.high = high * kDegree;
  return judge(m);
}

/// Writes all digits of a double.
std::string digits(double x) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, x, std::chars_format::general, 17).ptr};
}

std::string three(double x, double y, double z) { return digits(x) + ' ' + digits(y) + ' ' + digits(z); }

/// Place of the next body in the body that turns with `before`: after Tz(d) Tx(a) Rx(alpha), turned by theta.
std::string place(const DhLink& before, double theta) {
  const double ca = std::cos(before.alpha / 2), sa = std::sin(before.alpha / 2);
  const double ct = std::cos(theta / 2), st = std::sin(theta / 2);
  const std::string turned = digits(ca * ct) + ' ' + three(sa * ct, -sa * st, ca * st);
  return "pos='" + three(before.a, 0, before.d) + "' quat='" + turned + "'";
}

}  // namespace

Result<ModuleStore> ModuleStore::read(const std::string& path) {
  if (const std::string why = not_ordinary(path, SIZE_MAX); !why.empty()) return bad(path + ": " + why);
  std::ifstream file(path);
  if (!file) return bad(path + ": cannot be read");
  ModuleStore store;
  char text[kLongestLine + 1];
  for (int number = 1; file.getline(text, sizeof text) || file.gcount() > 0; ++number) {
    const std::string at = path + ":" + std::to_string(number) + ": ";
    if (!file && !file.eof()) return bad(at + "the line is longer than " + std::to_string(kLongestLine) + " bytes");
    if (number > kMostLines) return bad(at + "there are more than " + std::to_string(kMostLines) + " lines");
    std::string line = text;
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (store.count == kMostJoints) return bad(at + "there are more than " + std::to_string(kMostJoints) + " modules");
    const char* wrong = read_module(line, store.modules[store.count]);
    if (wrong != nullptr) return bad(at + wrong);
    ++store.count;
  }
  if (store.count == 0) return bad(path + ": there is no module in it");
  return store;
}

std::string ModuleStore::mjcf() const {
  std::string text =
      "<mujoco model='rmms'><compiler angle='radian'/><option timestep='0.0005'/>"
      "<default><geom contype='0' conaffinity='0'/></default><worldbody>";
  std::string motors, ends;
  DhLink before{};
  for (std::size_t i = 0; i < count; ++i) {
    const RmmsModule& m = modules[i];
    const std::string joint = "j" + std::to_string(i + 1);
    text += "<body " + place(before, m.link.theta) + "><joint name='" + joint + "' axis='0 0 1' limited='true'";
    text += " range='" + digits(m.low) + ' ' + digits(m.high) + "' armature='0.1' damping='1'/>";
    text += "<geom type='capsule' size='0.06' mass='" + digits(m.mass) + "' fromto='0 0 0 ";
    text += three(m.link.a, 0, m.link.d) + "'/>";
    motors += "<motor joint='" + joint + "' ctrllimited='true' ctrlrange='";
    motors += digits(-m.torque) + ' ' + digits(m.torque) + "'/>";
    ends += "</body>";
    before = m.link;
  }
  return text + "<site name='tip' " + place(before, 0) + "/>" + ends + "</worldbody><actuator>" + motors +
         "</actuator></mujoco>";
}

}  // namespace chimera::library
