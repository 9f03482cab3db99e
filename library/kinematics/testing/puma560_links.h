// SPDX-License-Identifier: Apache-2.0
// Mass properties of the Puma 560: Corke and Armstrong-Helouvry, ICRA 1994, as in library/puma_torque/puma560.xml.
#pragma once

#include <array>

#include "library/kinematics/dh_dynamics.h"

namespace chimera::library {

/// Base to wrist. Of link 1 only the inertia about its axis is published, and only that has an effect.
inline constexpr std::array<LinkMass, 6> kPuma560Links{
    LinkMass{0, {0, 0, 0}, {0, .35, 0, 0, 0, 0}, .78403, 5.801822},
    {17.4, {-.3638, .006, .2275}, {.13, .524, .539, 0, 0, 0}, 2.324815, 9.496869},
    {4.8, {-.0203, -.0141, .070}, {.066, .086, .0125, 0, 0, 0}, .5768733, 3.980426},
    {.82, {0, .019, 0}, {1.8e-3, 1.3e-3, 1.8e-3, 0, 0, 0}, .1907906, .4116452},
    {.34, {0, 0, 0}, {.3e-3, .4e-3, .3e-3, 0, 0, 0}, .1707063, .427283},
    {.09, {0, 0, .032 - .05625}, {.15e-3, .15e-3, .04e-3, 0, 0, 0}, .1940645, .2158233}};

}  // namespace chimera::library
