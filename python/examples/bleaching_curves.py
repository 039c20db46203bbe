"""Pigment against time in the light and in the dark after it, and the steady state."""

import numpy as np
import sungaze

from figure import plt, save

LIGHTS = [3, 4, 5, 6, 7]
seconds = np.linspace(0, 120, 481)
curves = sungaze.unbleached(10.0 ** np.array(LIGHTS)[:, None], seconds)
dark = sungaze.unbleached(0, seconds * 4, start=curves[:, -1:])

figure, (light, recovery, steady) = plt.subplots(1, 3, figsize=(12, 4), width_ratios=[3, 3, 2])
shades = plt.colormaps["cividis"](np.linspace(0, 0.85, len(LIGHTS)))
for log_td, lit, after, shade in zip(LIGHTS, curves, dark, shades):
    light.plot(seconds, lit, color=shade, label=f"$10^{{{log_td}}}$ td")
    recovery.plot(seconds * 4 / 60, after, color=shade)
light.set(xlabel="time in the light (s)", ylabel="unbleached fraction p", title="Bleaching", ylim=(0, 1.02))
light.legend(title="retinal illuminance")
recovery.set(xlabel="time in the dark (min)", title="Recovery after two minutes", ylim=(0, 1.02))

td = np.geomspace(1e2, 1e8, 200)
for law, style in [("first-order", "-"), ("self-screened", "--"), ("rate-limited", ":")]:
    steady.semilogx(td, sungaze.steady(td, law=law), style, color="black", label=law)
steady.set(xlabel="retinal illuminance (td)", title="Steady state", ylim=(0, 1.02))
steady.legend()
save(figure, "bleaching_curves")
