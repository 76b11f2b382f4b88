"""Makes usd_gbp_volatility.csv of the returns in usd_gbp_1981_1985.csv (columns date, usd_per_gbp, r = 100 times the
difference of logarithms), which is not shipped: python3 usd_gbp_volatility.py usd_gbp_1981_1985.csv
"""

import csv
import math
import sys

MEAN = -0.03581376923  # of r

with open("usd_gbp_volatility.csv", "w") as file:
    file.write("date,r,ln_y2\n")
    for row in csv.DictReader(open(sys.argv[1])):
        if row["r"]:
            file.write(f"{row['date']},{row['r']},{math.log((float(row['r']) - MEAN) ** 2)!r}\n")
