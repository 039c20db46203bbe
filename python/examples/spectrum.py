"""Illuminants and a laser line of `colour-science`, seen before and after a minute of daylight."""

import colour
import numpy as np
import sungaze

from figure import plt, save

bands = np.arange(400, 701, 10)
shape = colour.SpectralShape(400, 700, 10)
KNOWN = {"A": "A", "D65": "D65", "FL2": "FL2", "LED-B3": "LED-B3", "HP1": "HP1"}
spectra = {
    label: colour.SDS_ILLUMINANTS[name].copy().align(shape).values for label, name in KNOWN.items()
}
# Radiance of 2000 cd/m2 each, W m^-2 sr^-1 nm^-1: 683 lm/W times the sum over V.
v = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape).values[:, 1]
patches = np.stack([s * 2000 / (683 * 10 * (s * v).sum()) for s in spectra.values()])
frame = np.repeat(np.repeat(patches[None], 20, 0), 20, 1)          # (h, w, bands)

eye = sungaze.Eye(width=frame.shape[1], height=20, horizontal_fov_deg=10, bands_nm=bands)
fresh = eye.look(frame, 0.0)
daylight = np.broadcast_to(patches[1] * 100, frame.shape)          # 2e5 cd/m2
eye.look(daylight, 60.0)
tired = eye.look(frame, 0.1)

figure, (lines, diagram) = plt.subplots(1, 2, figsize=(11, 4.6), width_ratios=[3, 2])
for (label, spectrum), style in zip(spectra.items(), ["-", "--", ":", "-.", (0, (5, 1, 1, 1, 1, 1))]):
    lines.plot(bands, spectrum / spectrum.max(), linestyle=style, label=label)
lines.set(xlabel="wavelength (nm)", ylabel="relative radiance", title="What is looked at")
lines.legend(loc="upper left", bbox_to_anchor=(0.0, 0.62), ncols=1, fontsize=9)

to_xyz = colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ
for i, label in enumerate(spectra):
    before, after = (
        colour.XYZ_to_xy(to_xyz @ look.percept[10, 20 * i + 10].astype(float)) for look in (fresh, tired)
    )
    diagram.annotate("", after, before, arrowprops={"arrowstyle": "->", "color": "black"})
    diagram.plot(*before, "o", mfc="none", color=f"C{i}", ms=9)
    diagram.plot(*after, "o", color=f"C{i}", ms=9)
    diagram.annotate(label, before, xytext=(9, 5), textcoords="offset points")
diagram.set(xlabel="x", ylabel="y", title="Seen rested (open), tired (filled)", aspect="equal")
diagram.margins(0.2)
save(figure, "spectrum")
