// SPDX-License-Identifier: Apache-2.0
// Printed by tools/math_coefficients.py. Polynomials: lowest coefficient first.
#pragma once

namespace chimera::math {

// kSin: relative error of the function below 2^-57
constexpr double kSin[] = {
    -0x1.5555555555555p-3,
    0x1.1111111111110p-7,
    -0x1.a01a01a019938p-13,
    0x1.71de3a546095bp-19,
    -0x1.ae645412c560cp-26,
    0x1.61217f0b800d5p-33,
    -0x1.ab17d404de5b3p-41,
};
// kCos: relative error of the function below 2^-59
constexpr double kCos[] = {
    0x1.5555555555555p-5,
    -0x1.6c16c16c16c16p-10,
    0x1.a01a01a019d0ap-16,
    -0x1.27e4fb7712d65p-22,
    0x1.1eed8deb97a97p-29,
    -0x1.9394ba0cd6ed5p-37,
    0x1.ab785b00b4646p-45,
};
// kExp: relative error of the function below 2^-61
constexpr double kExp[] = {
    0x1.0000000000000p-1,
    0x1.5555555555557p-3,
    0x1.5555555555556p-5,
    0x1.11111111100bep-7,
    0x1.6c16c16c162c3p-10,
    0x1.a01a01abf85abp-13,
    0x1.a01a01a6e1e2ap-16,
    0x1.71de01fdbf9cap-19,
    0x1.27e4db46cddd1p-22,
    0x1.af4e554377204p-26,
    0x1.1f7340dbc337ep-29,
};
// kLog: relative error of the function below 2^-60
constexpr double kLog[] = {
    0x1.5555555555555p-1,
    0x1.9999999999a38p-2,
    0x1.2492492476cccp-2,
    0x1.c71c720159177p-3,
    0x1.745cf9048dd95p-3,
    0x1.3b1c355a8f7a2p-3,
    0x1.0fbe95d716020p-3,
    0x1.0c039c49989c6p-3,
};
// kAtan: relative error of the function below 2^-60
constexpr double kAtan[] = {
    -0x1.5555555555555p-2,
    0x1.99999999997e8p-3,
    -0x1.2492492452f47p-3,
    0x1.c71c71563eed4p-4,
    -0x1.745ce5cd88404p-4,
    0x1.3b07e2cb42347p-4,
    -0x1.0f7f618324350p-4,
    0x1.a992d2c5379c5p-5,
};
// kAsin: relative error of the function below 2^-58
constexpr double kAsin[] = {
    0x1.5555555555555p-3,
    0x1.3333333333388p-4,
    0x1.6db6db6dac1e0p-5,
    0x1.f1c71c7a52ba3p-6,
    0x1.6e8ba123e494cp-6,
    0x1.1c4efce23019fp-6,
    0x1.c990ad3d8fdcap-7,
    0x1.7b027ee1dd585p-7,
    0x1.3b49de7121487p-7,
    0x1.31622469ce5adp-7,
    0x1.8f193743418ffp-9,
    0x1.406192d124629p-6,
    -0x1.3b416bb7d9257p-6,
    0x1.e529c6fce9bb4p-6,
};
constexpr double kHalfPiFirst = 0x1.921fb54400000p+0;
constexpr double kHalfPiSecond = 0x1.0b4611a600000p-34;
constexpr double kHalfPiThird = 0x1.3198a2e000000p-69;
constexpr double kHalfPiFourth = 0x1.b839a252049c1p-104;
constexpr double kHalfPiHi = 0x1.921fb54442d18p+0;
constexpr double kHalfPiLo = 0x1.1a62633145c07p-54;
constexpr double kPiHi = 0x1.921fb54442d18p+1;
constexpr double kPiLo = 0x1.1a62633145c07p-53;
constexpr double kLn2Hi = 0x1.62e42fef00000p-1;
constexpr double kLn2Lo = 0x1.473de6af278edp-34;
constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
constexpr double kOneOverLn2 = 0x1.71547652b82fep+0;
struct Angle { double hi, lo; };
constexpr Angle kAtanOfEighths[] = {
    {0x0.0p+0, 0x0.0p+0},
    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
};

}  // namespace chimera::math
