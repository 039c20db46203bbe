"""A sweep as a data frame: how long to look at the low sun, for a young and an old pupil."""

import pandas
import sungaze

from figure import CONES, plt, save

table = pandas.DataFrame(sungaze.sweep({
    "input": {"width": 48},
    "sweep": {
        "durations_s": {"from": 0.1, "to": 100, "count": 13},
        "vary": [{"key": "observer.age", "values": [20, 80]}],
    },
}))
print(table.groupby("observer.age")[["p_L", "p_M", "p_S"]].min().round(4))

figure, panels = plt.subplots(1, 2, figsize=(10, 4), sharey=True)
for panel, (age, rows) in zip(panels, table.groupby("observer.age")):
    for cone, colour in CONES.items():
        panel.semilogx(rows["duration_s"], rows[f"p_{cone}"], "o-", ms=4, color=colour)
        last = rows.iloc[len(rows) // 2 - (2 if cone == "S" else 5)]
        panel.annotate(cone, (last["duration_s"], last[f"p_{cone}"]), xytext=(7, 5),
                       textcoords="offset points", color=colour, weight="bold")
    panel.set(title=f"aged {age:.0f}", xlabel="looked at for (s)", ylim=(0, 1.03))
panels[0].set_ylabel("unbleached at the sun's centre")
save(figure, "sweep_in_pandas")
