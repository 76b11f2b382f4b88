"""Draws battery.csv: the voltage of a cell under the current of a day's drives. Run in this folder: python3 battery.py

The cell is the model of ../battery.toml with the curve of battery_ocv.csv, which is made up too (typical of a lithium-ion cell
with a nickel cathode, measured on none). Current is known; the voltmeter has an error of 5 mV, and current that the meter does
not see (0.1 A, changing at random) is the process noise.
"""

import csv
import math
import random

CAPACITY = 2.5 * 3600          # A s
R0, R1, TAU = 0.035, 0.02, 120  # ohm, ohm, s
DT = 20                        # s

points = [(float(x), float(y)) for x, y in list(csv.reader(open("battery_ocv.csv")))[2:]]


def slopes():
    """Fritsch and Carlson's, as kfgpu's `table` has them."""
    h = [b[0] - a[0] for a, b in zip(points, points[1:])]
    d = [(b[1] - a[1]) / w for a, b, w in zip(points, points[1:], h)]
    m = [d[0]] + [(a + b) / 2 for a, b in zip(d, d[1:])] + [d[-1]]
    return m


def ocv(x):
    """Cubic Hermite through the points; close to the curve that the filter has, as a real cell would be."""
    m = slopes()
    i = max(0, min(len(points) - 2, sum(x >= p[0] for p in points) - 1))
    (x0, y0), (x1, y1) = points[i], points[i + 1]
    w, t = x1 - x0, (x - x0) / (x1 - x0)
    return (y0 * (1 + 2 * t) * (1 - t) ** 2 + m[i] * w * t * (1 - t) ** 2
            + y1 * t * t * (3 - 2 * t) + m[i + 1] * w * t * t * (t - 1))


draw = random.Random(5)
soc, u1, current = 0.92, 0.0, 0.0
with open("battery.csv", "w") as file:
    file.write("t,current,voltage,soc_true\n")
    for k in range(360):
        if k % 3 == 0:  # a new load each minute: rest, drive, or a little charge by the brakes
            current = draw.choice([0, 0, 0, 0.8, 1.5, 3, -1.5])
        voltage = ocv(soc) - R0 * current - u1 + draw.gauss(0, 0.005)
        file.write(f"{k * DT},{current},{voltage:.4f},{soc:.6f}\n")
        unseen = current + draw.gauss(0, 0.1)
        decay = math.exp(-DT / TAU)
        soc -= unseen * DT / CAPACITY
        u1 = u1 * decay + R1 * unseen * (1 - decay)
