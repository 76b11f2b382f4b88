"""A slowly moving robot positioned by UWB: 6 % of the fixes are multipath, several metres off to one side."""
import numpy as np
r = np.random.default_rng(417)
p, v = 0.0, 0.3
rows = []
for k in range(300):
    bad = r.random() < .06
    z = p + r.normal(0, .08) + (r.uniform(2, 6) if bad else 0)
    rows.append((k * .1, z, p))
    v = .98 * v + r.normal(0, .03); p += .1 * v
with open('uwb.csv', 'w') as f:
    f.write('t,uwb,true_p\n'); [f.write(f'{t:.1f},{z:.3f},{q:.3f}\n') for t, z, q in rows]
