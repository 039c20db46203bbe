"""Thirteen flashes, 18 s apart, against the bleaching that Cooper et al. published in 2020."""

import numpy as np
import sungaze

from figure import plt, save

FLASH_TD, FLASH_S, BEFORE_S, EVERY_S = 988015.9686, 0.999, 4.0, 18.0
PUBLISHED = {1: 0.336527066, 2: 0.528324619, 3: 0.637636188, 5: 0.735443211, 10: 0.779667866,
             13: 0.781973571}

p, peaks, times, course = 1.0, {}, [], []
for trial in range(1, 14):
    begin = (trial - 1) * EVERY_S
    for td, start, length in [(0, 0, BEFORE_S), (FLASH_TD, BEFORE_S, FLASH_S),
                              (0, BEFORE_S + FLASH_S, EVERY_S - BEFORE_S - FLASH_S)]:
        seconds = np.linspace(0, length, 20)
        run = sungaze.unbleached(td, seconds, start=p)
        times.extend(begin + start + seconds)
        course.extend(1 - run)
        p = run[-1]
        if td:
            peaks[trial] = 1 - p

for trial, bleached in PUBLISHED.items():
    print(f"flash {trial:2}: {peaks[trial]:.9f}, published {bleached:.9f}")
    assert abs(peaks[trial] - bleached) < 1e-9

figure, axes = plt.subplots(figsize=(8, 4))
axes.plot(times, course, color="#0072B2", label="sungaze")
at = [(trial - 1) * EVERY_S + BEFORE_S + FLASH_S for trial in PUBLISHED]
axes.plot(at, list(PUBLISHED.values()), "o", color="#D55E00", mfc="none", label="published, end of a flash")
axes.set(xlabel="time (s)", ylabel="bleached fraction", ylim=(0, 1),
         title="A train of one-second flashes of $10^{5.99}$ td")
axes.legend(loc="lower right")
save(figure, "flash_train")
