"""uav_gps.csv with one fix in twenty thrown off, by up to 100 m to every side; the fixes as they were are kept as truth."""
import csv
import random
from pathlib import Path

here = Path(__file__).parent
draw = random.Random(417)
with open(here / "uav_gps.csv") as source, open(here / "uav_gps_outliers.csv", "w") as out:
    print("t,e,n,u,e_fix,n_fix,u_fix", file=out)
    for row in csv.DictReader(source):
        fix = [float(row[axis]) for axis in "enu"]
        off = [draw.uniform(-100, 100) for _ in fix]
        bad = draw.random() < 0.05
        shown = [a + b if bad else a for a, b in zip(fix, off)]
        print(row["t"], *(f"{v:.3f}" for v in shown + fix), sep=",", file=out)
