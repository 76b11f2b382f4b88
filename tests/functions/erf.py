#!/usr/bin/env python3
"""Prints the coefficients of `erf` in src/tape/functions.rs: Chebyshev interpolation by mpmath with 60 digits."""

from mpmath import chebyfit, erf, erfc, exp, mp, mpf, pi, sqrt

mp.dps = 60


def near(square):
    return erf(sqrt(square)) / sqrt(square) if square else 2 / sqrt(pi)


def far(y):
    a = 1 / (mpf(3) / 20 + y / 20) - 4
    return exp(a * a) * erfc(a)


for f, interval, terms in [(near, [0, 1], 12), (far, [-1, 1], 16)]:
    coefficients, error = chebyfit(f, interval, terms, error=True)
    print(f.__name__, "error", mp.nstr(error, 2))
    for c in reversed(coefficients):
        print("    %r," % float(c))
