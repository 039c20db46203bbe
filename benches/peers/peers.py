"""SciPy's solve_ivp on the light histories: python peers.py histories.csv"""

import csv
import statistics
import sys
import time
from collections import defaultdict

import numpy as np
from scipy.integrate import solve_ivp

FRAME, TAU, HALF_BLEACH = 0.04, 120.0, 10**4.3


def read(path):
    scenes = defaultdict(list)
    with open(path) as table:
        for row in csv.DictReader(table):
            scenes[row["scene"]].append((float(row["light_td"]), float(row["p"])))
    return scenes


def run(frames, method, places):
    """The largest error of the first place, and seconds per place and frame."""
    p, worst = np.ones(places), 0.0
    spread = np.linspace(1.0, 2.0, places)
    start = time.perf_counter()
    for light, truth in frames:
        k, rate = 1 / TAU, (1 + light * spread / HALF_BLEACH) / TAU
        found = solve_ivp(lambda t, p: k - rate * p, (0, FRAME), p, method=method, rtol=1e-6, atol=1e-9,
                          t_eval=[FRAME])
        p = found.y[:, -1]
        worst = max(worst, abs(p[0] - truth))
    return worst, (time.perf_counter() - start) / (len(frames) * places)


for scene, frames in read(sys.argv[1]).items():
    for method, places in [("RK45", 1), ("LSODA", 1), ("Radau", 1), ("RK45", 1000)]:
        runs = [run(frames, method, places) for _ in range(3)]
        seconds = statistics.median(seconds for _, seconds in runs)
        setting = "rtol 1e-6 atol 1e-9" + (f"; {places} places in one state" if places > 1 else "")
        print(f"SciPy {method},{scene},{setting},{runs[0][0]:.2e},{seconds * 1e9:.1f},", flush=True)
