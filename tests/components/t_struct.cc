// SPDX-License-Identifier: Apache-2.0
// Struct ports: the given ones and one of the component's own, a unit for each field.
#include "chimera/task/component.h"
#include "chimera/task/geometry.h"

using namespace chimera;

struct Battery {
  double voltage;
  double cell[4];
  std::int32_t charges;
  bool is_charging;
  Text<12> maker;
};
template <>
struct chimera::Fields<Battery> {
  static constexpr const char* name = "Battery";
  static constexpr auto list = std::tuple{
      field("voltage", "V", &Battery::voltage), field("cell", "V", &Battery::cell),
      field("charges", "1", &Battery::charges), field("is_charging", "1", &Battery::is_charging),
      field("maker", "1", &Battery::maker)};
};

struct Structs {
  In<Pose> pose{"pose", frame = "base"};
  Out<Twist> twist{"twist", frame = "base", initial = Twist{}};
  Out<Wrench> wrench{"wrench", frame = "base", initial = Wrench{}};
  Out<Battery> battery{"battery", initial = Battery{12.0, {3, 3, 3, 3}, 7, false, "acme"}};

  void on(Cycle) {
    for (int i = 0; i < 3; ++i) last_[i] = pose->position[i];
  }
  void cycle(Cycle c) {
    for (int i = 0; i < 3; ++i) {
      twist->linear[i] = (pose->position[i] - last_[i]) / c.dt();
      wrench->force[i] = -pose->position[i];
      last_[i] = pose->position[i];
    }
    battery->charges += 1;
    battery->is_charging = !battery->is_charging;
    for (double& cell : battery->cell) cell = battery->voltage / 4;
  }
  double last_[3] = {};
};
CHIMERA_COMPONENT(Structs, "t_struct", "Structs in and out.", rate = 1000.0);
