#!/usr/bin/env python3
"""Writes values.csv: values and derivatives of the functions of formulas, by mpmath with 100 digits.

A value is the sum of two doubles (106 bits); derivatives are rounded to one, empty where there is none. Arguments are numbers
of f32 where a row is for both formats, otherwise (near multiples of pi/2) of f64. Run it again to write the same file.
"""

import csv
import random
import struct
from pathlib import Path

from mpmath import mp, mpf

mp.dps = 100
random.seed(20261127)


def single(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def between(low, high, count=30):
    return [single(random.uniform(low, high)) for _ in range(count)]


def decades(low, high, count=30, both=False):
    sizes = [single(10 ** random.uniform(low, high)) for _ in range(count)]
    return [random.choice([-1, 1]) * a for a in sizes] if both else sizes


def pairs(first, second):
    return list(zip(first, second, strict=True))


def wrap(a):
    return a - 2 * mp.pi * mp.floor((a + mp.pi) / (2 * mp.pi))


def sinc(a):
    return mp.sin(a) / a if a else mpf(1)


def cosc(a):
    return (1 - mp.cos(a)) / a if a else mpf(0)


def nearest_even(a):
    return mp.nint(a)


near_quarters = [float(mp.nint(k) * mp.pi / 2) for k in (1, 2, 3, 7, 100, 1001, 9973, 50000)]
angles = between(-4, 4) + between(-100, 100) + decades(-6, 0, 10, True) + between(-9e4, 9e4, 10) + near_quarters
far = [123456.0, 1e6, 16777216.0, 1e10]

TABLE = {
    "sqrt": (mp.sqrt, lambda a: 1 / (2 * mp.sqrt(a)), decades(-30, 30) + [1.0, 2.0, 4.0]),
    "exp": (mp.exp, mp.exp, between(-4, 4) + between(-85, 88) + decades(-8, -1, 10, True)),
    "expm1": (mp.expm1, mp.exp, between(-1, 1) + between(-20, 88) + decades(-8, -1, 20, True)),
    "ln": (mp.log, lambda a: 1 / a, decades(-37, 38) + between(0.5, 1.5) + [single(1 + 2**-20), single(1 - 2**-20)]),
    "log1p": (mp.log1p, lambda a: 1 / (1 + a), decades(-8, 10) + between(-0.99, 1) + decades(-8, -1, 20, True)),
    "log10": (mp.log10, lambda a: 1 / (a * mp.log(10)), decades(-37, 38) + [10.0, 100.0, 1000.0, 1e-3]),
    "sin": (mp.sin, mp.cos, angles + far),
    "cos": (mp.cos, lambda a: -mp.sin(a), angles + far),
    "tan": (mp.tan, lambda a: 1 / mp.cos(a) ** 2, between(-1.5, 1.5) + between(-100, 100) + decades(-6, 0, 10, True)),
    "asin": (mp.asin, lambda a: 1 / mp.sqrt(1 - a * a), between(-1, 1) + decades(-6, -1, 10, True) + [single(1 - 2**-20)]),
    "acos": (mp.acos, lambda a: -1 / mp.sqrt(1 - a * a), between(-1, 1) + decades(-6, -1, 10, True) + [single(1 - 2**-20)]),
    "atan": (mp.atan, lambda a: 1 / (1 + a * a), between(-3, 3) + decades(-6, 6, 30, True)),
    "tanh": (mp.tanh, lambda a: 1 / mp.cosh(a) ** 2, between(-3, 3) + decades(-6, 1, 30, True)),
    "sinc": (sinc, lambda a: (mp.cos(a) - sinc(a)) / a if a else mpf(0), [0.0, 1.0] + between(-4, 4) + decades(-6, 3, 30, True)),
    "cosc": (cosc, lambda a: (mp.sin(a) - cosc(a)) / a if a else mpf(1) / 2, [0.0, 2.0] + between(-4, 4) + decades(-6, 2, 30, True)),
    "wrap": (wrap, lambda a: mpf(1), between(-3, 3) + between(-100, 100) + between(-9e4, 9e4, 10) + [3.140625, -3.140625] + far),
    "floor": (mp.floor, lambda a: mpf(0), between(-50, 50) + [0.5, -0.5, 1.5]),
    "round": (nearest_even, lambda a: mpf(0), between(-50, 50) + [0.5, -0.5, 1.5, 2.5]),
    "sign": (mp.sign, lambda a: mpf(0), between(-2, 2, 10)),
    "abs": (abs, mp.sign, between(-2, 2, 10)),
    "erf": (mp.erf, lambda a: 2 / mp.sqrt(mp.pi) * mp.exp(-a * a), between(-3, 3) + between(-6, 6) + decades(-6, 0, 20, True)),
    "lgamma": (mp.loggamma, mp.psi0 if hasattr(mp, "psi0") else lambda a: mp.psi(0, a), between(0.1, 4) + decades(-5, 6) + [1.0, 2.0, 8.0]),
}
PAIRS = {
    "atan2": (
        mp.atan2,
        lambda y, x: x / (x * x + y * y),
        lambda y, x: -y / (x * x + y * y),
        pairs(between(-2, 2), between(-2, 2)) + pairs(decades(-15, 15, 30, True), decades(-15, 15, 30, True)),
    ),
    "min": (min, lambda a, b: mpf(a < b), lambda a, b: mpf(b < a), pairs(between(-2, 2, 10), between(-2, 2, 10))),
    "max": (max, lambda a, b: mpf(a > b), lambda a, b: mpf(b > a), pairs(between(-2, 2, 10), between(-2, 2, 10))),
    "power": (
        mp.power,
        lambda a, b: b * a ** (b - 1),
        lambda a, b: a**b * mp.log(a),
        pairs(between(0.1, 4), between(-4, 4)) + pairs(decades(-4, 4), between(-8, 8)),
    ),
}


def row(name, a, b, value, da, db):
    high = float(value)
    low = float(value - mpf(high))
    write = lambda x: "" if x is None else repr(float(x))
    return [name, write(a), write(b), repr(high), repr(low), write(da), write(db)]


def main():
    with open(Path(__file__).parent / "values.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["function", "a", "b", "high", "low", "da", "db"])
        for name, (f, df, arguments) in TABLE.items():
            for a in arguments:
                out.writerow(row(name, a, None, f(mpf(a)), df(mpf(a)), None))
        for name, (f, da, db, arguments) in PAIRS.items():
            for a, b in arguments:
                x = (mpf(a), mpf(b))
                out.writerow(row(name, a, b, f(*x), da(*x), db(*x)))


if __name__ == "__main__":
    main()
