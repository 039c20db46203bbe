"""What is seen of spectra against colour-science and Mitsuba: light.py SUNGAZE FOLDER.

An eye that does not bleach sees a lamp, equal energy, D65 and twelve patches of a ColorChecker under D65. Luminances
are held against the CIE 1931 integral; linear sRGB against colour-science's by CIE 1931 and against `hdrfilm`'s, per
channel, relative to the greatest channel of the light: how far the observers are from each other. Against
colour-science's by CIE 2015, scaled to one white, it must be the same. Prints a table and exits with 1 if something
is beyond its bound.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np

SUNGAZE, FOLDER = sys.argv[1], Path(sys.argv[2])
WAVELENGTHS = np.arange(380, 781, 5)
PATCHES = 12
# Mitsuba's `hdrfilm` divides by the area of Y; this and 683 lm/W make cd/m2 of its spectral variants' RGB.
HDRFILM_CD_M2 = 683.002 * 106.856895
# Of luminance, relative; of a channel, relative to the light's greatest: other observers, and our own.
LUMINANCES = {"equal energy": 2e-3, "D65": 1e-4, "lamp, 2900 K": 5e-3}
OTHERS, OWN = 0.03, 2e-3
CIE_1931, CIE_2015 = "CIE 1931 2 Degree Standard Observer", "CIE 2015 2 Degree Standard Observer"
D65_XYZ = np.array([0.3127, 0.3290, 1 - 0.3127 - 0.3290]) / 0.3290


def curve(distribution):
    """A distribution of colour-science at our wavelengths."""
    import colour

    shape = colour.SpectralShape(WAVELENGTHS[0], WAVELENGTHS[-1], 5)
    return distribution.copy().align(shape, extrapolator_kwargs={"method": "Constant", "left": 0, "right": 0}).values


def lights():
    """Radiances by name, those of the patches last."""
    import colour

    d65 = curve(colour.SDS_ILLUMINANTS["D65"])
    lamp = curve(colour.sd_blackbody(2900, colour.SpectralShape(360, 830, 5)))
    all_patches = list(colour.SDS_COLOURCHECKERS["babel_average"].items())
    chosen = all_patches[:: len(all_patches) // PATCHES][:PATCHES]
    named = {"equal energy": np.ones_like(d65), "D65": d65, "lamp, 2900 K": lamp}
    named = {name: light / xyz(light)[1] for name, light in named.items()}
    return named | {name: curve(patch) * named["D65"] for name, patch in chosen}


def xyz(light, name=CIE_1931):
    """XYZ of a radiance, cd/m2."""
    import colour

    observer = colour.MSDS_CMFS[name]
    shape = colour.SpectralShape(WAVELENGTHS[0], WAVELENGTHS[-1], 5)
    return 683.002 * 5.0 * light @ observer.copy().align(shape).values


def own_xyz(light, d65):
    """XYZ by CIE 2015, each scaled so that D65 has its own chromaticity and its luminance of 1931."""
    return xyz(light, CIE_2015) * D65_XYZ / xyz(d65, CIE_2015)


def seen(radiances):
    """Linear sRGB, cd/m2, of what our unbleached eye sees."""
    import mitsuba as mi

    names = [f"S0.{nm},000000nm" for nm in WAVELENGTHS]
    pixels = np.repeat(radiances[None].astype(np.float32), 4, axis=0)
    frame, out = FOLDER / "light.exr", FOLDER / "light"
    mi.Bitmap(pixels, mi.Bitmap.PixelFormat.MultiChannel, names).write(str(frame))
    keys = ["numerics.model=none", "optics.psf=none"]
    sets = [word for key in keys for word in ("--set", key)]
    run = [SUNGAZE, "run", str(frame), "--fov", "8", "--for", "1", "--fps", "1", "--quiet", "--out", str(out)]
    subprocess.run(run + sets, check=True)
    return np.array(mi.Bitmap(str(out / "seen.0001.exr")))[0, :, :3]


def hdrfilm(light):
    """Linear sRGB, cd/m2, of Mitsuba's picture of a sky of this radiance."""
    import mitsuba as mi

    values = list(zip(WAVELENGTHS.tolist(), light.tolist()))
    film = {"type": "hdrfilm", "width": 4, "height": 4, "rfilter": {"type": "box"}, "component_format": "float32"}
    sampler = {"type": "independent", "sample_count": 4096}
    scene = {
        "type": "scene",
        "integrator": {"type": "path"},
        "sensor": {"type": "perspective", "film": film, "sampler": sampler},
        "sky": {"type": "constant", "radiance": {"type": "spectrum", "value": values}},
    }
    return np.array(mi.render(mi.load_dict(scene))).reshape(-1, 3).mean(axis=0) * HDRFILM_CD_M2


def main():
    import colour
    import mitsuba as mi

    mi.set_variant("scalar_spectral")
    named = lights()
    ours = seen(np.array(list(named.values())))
    to_srgb = colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB
    luminance, failures = np.linalg.inv(to_srgb)[1], 0
    print(f"{'':20} {'Y by 1931':>10} {'RGB less 1931, %':>22} {'less hdrfilm':>22} {'less CIE 2015':>22}")
    for (name, light), rgb in zip(named.items(), ours):
        whole = rgb.max() if name in LUMINANCES else 1.0
        theirs = [to_srgb @ xyz(light), hdrfilm(light), to_srgb @ own_xyz(light, named["D65"])]
        apart = [(rgb - other) / whole for other in theirs]
        ratio = luminance @ rgb / xyz(light)[1]
        wrong = abs(ratio - 1) > LUMINANCES.get(name, np.inf)
        wrong |= any(abs(part).max() > bound for part, bound in zip(apart, (OTHERS, OTHERS, OWN)))
        failures += wrong
        shown = [" ".join(f"{100 * part:6.2f}" for part in difference) for difference in apart]
        print(f"{name:20} {ratio:10.5f} " + " ".join(f"{part:>22}" for part in shown), "FAILED" if wrong else "")
    return failures


try:
    sys.exit(bool(main()))
except ImportError as missing:
    print(f"light: skipped, {missing}")
