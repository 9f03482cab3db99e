#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Derives the polynomials and tables of chimera/base/math.cc: Chebyshev interpolation at 60 digits, each
coefficient rounded to the nearest double. Prints C++ and the largest error of each polynomial.
Needs python3-mpmath; run by hand when a polynomial changes."""
import math
import mpmath as mp

mp.mp.dps = 60


def chebyshev_fit(f, lo, hi, degree):
    """Coefficients, lowest first, of the polynomial through f at the Chebyshev points of [lo, hi]."""
    n = degree + 1
    xs = [(lo + hi) / 2 + (hi - lo) / 2 * mp.cos(mp.pi * (2 * k + 1) / (2 * n)) for k in range(n)]
    table = [f(x) for x in xs]
    for level in range(1, n):  # divided differences
        for i in range(n - 1, level - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (xs[i] - xs[i - level])
    coefficients = [table[-1]]
    for i in range(n - 2, -1, -1):  # Newton form to powers
        shifted = [mp.mpf(0)] + coefficients
        for j, c in enumerate(coefficients):
            shifted[j] -= xs[i] * c
        shifted[0] += table[i]
        coefficients = shifted
    return coefficients


def at(coefficients, x):
    return mp.polyval(coefficients[::-1], x)


def emit(name, f, lo, hi, degree, weight):
    """weight(x) turns an error of the polynomial into a relative error of the function."""
    rounded = [float(c) for c in chebyshev_fit(f, mp.mpf(lo), mp.mpf(hi), degree)]
    worst = mp.mpf(0)
    for k in range(2001):
        x = mp.mpf(lo) + (mp.mpf(hi) - lo) * k / 2000
        if x == 0:
            continue
        worst = max(worst, abs(at([mp.mpf(c) for c in rounded], x) - f(x)) * weight(x))
    print(f"// {name}: relative error of the function below 2^{math.ceil(float(mp.log(worst, 2)))}")
    print(f"constexpr double {name}[] = {{")
    for c in rounded:
        print(f"    {c.hex()},")
    print("};")


def emit_cut(name, value, bits_cleared):
    """The leading bits of value alone, so that products with small whole numbers are exact."""
    m, e = math.frexp(float(value))
    cut = math.ldexp(math.floor(math.ldexp(m, 53 - bits_cleared)), e - 53 + bits_cleared)
    print(f"constexpr double {name} = {cut.hex()};")
    return cut


def emit_pair(name, value, bits_cleared=0):
    hi = emit_cut(name + "Hi", value, bits_cleared)
    print(f"constexpr double {name}Lo = {float(value - mp.mpf(hi)).hex()};")


def series(f, z, terms):
    """f(z) by its power series near 0, where the closed form would cancel."""
    return sum(f(k) * z ** k for k in range(terms))


def main():
    quarter = (mp.pi / 4) ** 2
    emit("kSin", lambda z: series(lambda k: mp.mpf((-1) ** (k + 1)) / mp.factorial(2 * k + 3), z, 30), 0, quarter, 6,
         lambda z: z * mp.sqrt(z) / mp.sin(mp.sqrt(z)))
    emit("kCos", lambda z: series(lambda k: mp.mpf((-1) ** k) / mp.factorial(2 * k + 4), z, 30), 0, quarter, 6,
         lambda z: z * z / mp.cos(mp.sqrt(z)))
    half_ln2 = mp.log(2) / 2 * mp.mpf("1.001")
    emit("kExp", lambda r: series(lambda k: 1 / mp.factorial(k + 2), r, 40), -half_ln2, half_ln2, 10,
         lambda r: r * r / mp.exp(r))
    s_max = ((mp.sqrt(2) - 1) / (mp.sqrt(2) + 1)) ** 2
    emit("kLog", lambda z: series(lambda k: mp.mpf(2) / (2 * k + 3), z, 60), 0, s_max, 7,
         lambda z: z / 2)
    emit("kAtan", lambda z: series(lambda k: mp.mpf((-1) ** (k + 1)) / (2 * k + 3), z, 60), 0, mp.mpf(3) / 16 * 3 / 16,
         7, lambda z: z * mp.sqrt(z) / mp.atan(mp.sqrt(z)))

    def asin_rest(z):
        if z < mp.mpf("1e-6"):
            return series(lambda k: mp.binomial(2 * k + 2, k + 1) / (4 ** (k + 1) * (2 * k + 3)), z, 12)
        x = mp.sqrt(z)
        return (mp.asin(x) - x) / (x * z)
    emit("kAsin", asin_rest, 0, mp.mpf(1) / 4, 13, lambda z: z * mp.sqrt(z) / mp.asin(mp.sqrt(z)))

    rest = mp.pi / 2
    for name in ("kHalfPiFirst", "kHalfPiSecond", "kHalfPiThird"):
        rest -= mp.mpf(emit_cut(name, rest, 20))
    print(f"constexpr double kHalfPiFourth = {float(rest).hex()};")
    emit_pair("kHalfPi", mp.pi / 2)
    emit_pair("kPi", mp.pi)
    emit_pair("kLn2", mp.log(2), 20)
    print(f"constexpr double kTwoOverPi = {float(2 / mp.pi).hex()};")
    print(f"constexpr double kOneOverLn2 = {float(1 / mp.log(2)).hex()};")
    print("struct Angle { double hi, lo; };\nconstexpr Angle kAtanOfEighths[] = {")
    for k in range(9):
        a = mp.atan(mp.mpf(k) / 8)
        print(f"    {{{float(a).hex()}, {float(a - mp.mpf(float(a))).hex()}}},")
    print("};")


main()
