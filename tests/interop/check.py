"""Files of other programs against `sungaze inspect --json`: check.py SUNGAZE FOLDER."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

SUNGAZE, FOLDER = sys.argv[1], Path(sys.argv[2])
RANDOM = np.random.default_rng(7)
FAILURES = []


def inspected(path):
    run = subprocess.run([SUNGAZE, "inspect", "--json", str(path)], capture_output=True, text=True)
    if run.returncode:
        return {"error": run.stderr.strip()}
    told = json.loads(run.stdout)
    return told[0] if isinstance(told, list) else told


def check(path, tolerance=0.0, **expected):
    """Compares fields of the inspection; numbers within float rounding, or a tolerance."""
    told = inspected(path)
    for key, value in expected.items():
        found = told.get(key)
        if key == "centres_nm":
            found = [band[0] for band in told.get("bands_nm") or []]
        same = found == value
        if not isinstance(value, (str, type(None))) and found is not None:
            a, b = np.asarray(found, float), np.asarray(value, float)
            same = a.shape == b.shape and np.allclose(a, b, rtol=2e-6, atol=max(1e-9, tolerance))
        if not same:
            FAILURES.append(f"{path.name}: {key} is {found}, should be {value} {told.get('error', '')}")
    print(f"{path.name}: {'checked' if not any(f.startswith(path.name + ':') for f in FAILURES) else 'FAILED'}")


def ranges(planes):
    return [[float(plane.min()), float(plane.max())] for plane in planes]


def openexr():
    import OpenEXR

    codes = ["NO", "RLE", "ZIPS", "ZIP", "PIZ"]
    for kind in (np.float16, np.float32):
        for code in codes:
            rgb = RANDOM.lognormal(0, 2, (45, 70, 3)).astype(kind)
            header = {
                "compression": getattr(OpenEXR, f"{code}_COMPRESSION"),
                "type": OpenEXR.scanlineimage,
                "chromaticities": (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767),
                "whiteLuminance": 4000.0,
            }
            path = FOLDER / f"openexr_{code.lower()}_{np.dtype(kind).name}.exr"
            OpenEXR.File(header, {"RGB": rgb}).write(str(path))
            check(
                path,
                kind="rgb",
                width=70,
                height=45,
                white_cd_m2=4000.0,
                primaries=[[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], [0.32168, 0.33767]],
                ranges=ranges(rgb.transpose(2, 0, 1)),
            )

    offset = RANDOM.uniform(1, 2, (5, 6)).astype(np.float32)
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "dataWindow": (np.array([2, 3], np.int32), np.array([7, 7], np.int32)),
        "displayWindow": (np.array([0, 0], np.int32), np.array([9, 9], np.int32)),
    }
    path = FOLDER / "openexr_windows.exr"
    OpenEXR.File(header, {"R": offset, "G": offset, "B": offset}).write(str(path))
    check(path, width=10, height=10, data_window=[2, 3, 7, 7], ranges=[[0, float(offset.max())]] * 3)

    tiled = RANDOM.uniform(0, 1, (33, 41, 3)).astype(np.float16)
    header = {"compression": OpenEXR.PIZ_COMPRESSION, "type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
    path = FOLDER / "openexr_tiled.exr"
    OpenEXR.File(header, {"RGB": tiled}).write(str(path))
    check(path, kind="rgb", ranges=ranges(tiled.transpose(2, 0, 1)))

    names = {f"S0.{nm}nm": np.full((3, 4), nm, np.float32) for nm in (400, 550, 1000)}
    names["S1.400nm"] = np.ones((3, 4), np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    path = FOLDER / "openexr_bands.exr"
    OpenEXR.File(header, names).write(str(path))
    check(path, kind="spectral", centres_nm=[400, 550, 1000], ranges=[[400, 400], [550, 550], [1000, 1000]])

    xyz = {name: RANDOM.uniform(0, 1, (7, 9)).astype(np.float32) for name in "XYZ"}
    path = FOLDER / "openexr_xyz.exr"
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, dict(xyz)).write(str(path))
    check(path, kind="rgb", primaries=[[1, 0], [0, 1], [0, 0], [1 / 3, 1 / 3]], ranges=ranges(np.stack([*xyz.values()])))

    # Luminance and chroma of one colour: RY = .25, BY = -.5, each for every second pixel on either axis.
    luminance = RANDOM.uniform(1, 2, (34, 18)).astype(np.float32)
    red, blue = 1.25 * luminance, 0.5 * luminance
    green = (luminance - 0.2126390 * red - 0.0721923 * blue) / 0.7151687
    for code in ("NO", "ZIPS", "ZIP", "PIZ", "RLE"):
        chroma = {"RY": 0.25, "BY": -0.5}
        channels = {k: OpenEXR.Channel(np.full((34, 18), v, np.float32), 2, 2) for k, v in chroma.items()}
        channels["Y"] = OpenEXR.Channel(luminance)
        header = {"compression": getattr(OpenEXR, f"{code}_COMPRESSION"), "type": OpenEXR.scanlineimage}
        path = FOLDER / f"openexr_chroma_{code.lower()}.exr"
        OpenEXR.File(header, channels).write(str(path))
        check(path, kind="rgb", ranges=ranges(np.stack([red, green, blue])))

    # Tiles, and last blocks, that DWA cannot shrink are stored as they are.
    for code, kind in (("DWAA", OpenEXR.scanlineimage), ("DWAB", OpenEXR.tiledimage)):
        noise = RANDOM.uniform(0, 1, (33, 5, 3)).astype(np.float16)
        header = {"compression": getattr(OpenEXR, f"{code}_COMPRESSION"), "type": kind, "tiles": OpenEXR.TileDescription()}
        if kind == OpenEXR.scanlineimage:
            del header["tiles"]
        path = FOLDER / f"openexr_{code.lower()}_small.exr"
        OpenEXR.File(header, {"RGB": noise}).write(str(path))
        with OpenEXR.File(str(path)) as read:
            check(path, kind="rgb", ranges=ranges(read.channels()["RGB"].pixels.transpose(2, 0, 1)))

    parts = [
        OpenEXR.Part({"name": "first", "type": OpenEXR.scanlineimage}, {"Z": np.ones((4, 4), np.float32)}),
        OpenEXR.Part({"name": "beauty", "type": OpenEXR.scanlineimage}, {"RGB": tiled[:4, :4].copy()}),
    ]
    path = FOLDER / "openexr_parts.exr"
    OpenEXR.File(parts).write(str(path))
    check(path, kind="rgb", ranges=ranges(tiled[:4, :4].transpose(2, 0, 1)))


def mitsuba():
    import mitsuba as mi

    mi.set_variant("scalar_spectral")
    wavelengths = np.arange(380, 781, 20)
    image = RANDOM.lognormal(0, 1, (6, 9, len(wavelengths))).astype(np.float32)
    names = [f"S0.{nm},000000nm" for nm in wavelengths]
    bitmap = mi.Bitmap(image, mi.Bitmap.PixelFormat.MultiChannel, names)
    path = FOLDER / "mitsuba_fichet.exr"
    bitmap.write(str(path))
    check(path, kind="spectral", centres_nm=wavelengths.tolist(), ranges=ranges(image.transpose(2, 0, 1)))

    film = {
        "type": "specfilm",
        "width": 8,
        "height": 8,
        "component_format": "float32",
        "rfilter": {"type": "box"},
        "a_free": {"type": "spectrum", "value": [(399, 0.0), (400, 1.0), (500, 1.0), (501, 0.0)]},
        "b_free": {"type": "spectrum", "value": [(499, 0.0), (500, 1.0), (600, 1.0), (601, 0.0)]},
    }
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path"},
            "sensor": {"type": "perspective", "film": film, "sampler": {"type": "independent", "sample_count": 16}},
            "sky": {"type": "constant", "radiance": {"type": "uniform", "value": 1.0}},
        }
    )
    path = FOLDER / "mitsuba_specfilm.exr"
    mi.render(scene)
    scene.sensors()[0].film().write(str(path))
    check(path, kind=None, width=8, height=8)
    told = [channel["name"] for channel in inspected(path)["channels"]]
    if told != ["a_free", "b_free"]:
        FAILURES.append(f"{path.name}: channels are {told}")


def colour_science():
    import colour
    from colour.io.fichet2021 import Specification_Fichet2021, write_spectral_image_Fichet2021

    wavelengths = colour.SpectralShape(400, 700, 20).wavelengths
    image = RANDOM.lognormal(0, 1, (4, 5, len(wavelengths))).astype(np.float32)
    path = FOLDER / "colour_fichet.exr"
    emissive = Specification_Fichet2021(is_emissive=True)
    write_spectral_image_Fichet2021({"S0": (wavelengths, image)}, str(path), "float32", emissive)
    check(path, kind="spectral", centres_nm=wavelengths.tolist(), ranges=ranges(image.transpose(2, 0, 1)))


def spectral_python():
    from spectral.io import envi

    wavelengths = [700, 450, 500, 600]
    for interleave in ("bsq", "bil", "bip"):
        for kind, order in ((np.float32, 0), (np.float64, 1), (np.uint16, 1), (np.int16, 0)):
            image = RANDOM.integers(0, 30000, (5, 7, 4)).astype(kind)
            path = FOLDER / f"envi_{interleave}_{np.dtype(kind).name}.hdr"
            metadata = {"wavelength": wavelengths, "wavelength units": "Nanometers"}
            envi.save_image(str(path), image, interleave=interleave, byteorder=order, metadata=metadata, dtype=kind)
            planes = image.transpose(2, 0, 1)[np.argsort(wavelengths)]
            check(path, kind="spectral", centres_nm=sorted(wavelengths), ranges=ranges(planes))


def imageio_png():
    import imageio.v3 as iio

    codes = RANDOM.integers(0, 256, (9, 11, 3)).astype(np.uint8)
    path = FOLDER / "imageio.png"
    iio.imwrite(path, codes)
    signal = codes.transpose(2, 0, 1) / 255.0
    light = np.where(signal <= 0.04045, signal / 12.92, ((signal + 0.055) / 1.055) ** 2.4)
    check(path, kind="rgb", width=11, height=9, clipped=int((codes == 255).sum()), ranges=ranges(light))


def linear(codes, top):
    signal = np.asarray(codes, float) / top
    return np.where(signal <= 0.04045, signal / 12.92, ((signal + 0.055) / 1.055) ** 2.4)


def pillow():
    """Every mode of PNG, and JPEGs of every orientation, against Pillow's own reading."""
    from PIL import Image, ImageOps

    codes = RANDOM.integers(0, 256, (9, 11, 4)).astype(np.uint8)
    for mode in ("1", "L", "LA", "P", "RGB", "RGBA"):
        path = FOLDER / f"pillow_{mode}.png"
        Image.fromarray(codes).convert("RGB").convert(mode).save(path)
        light = linear(np.asarray(Image.open(path).convert("RGBA"))[..., :3], 255)
        check(path, kind="rgb", width=11, height=9, ranges=ranges(light.transpose(2, 0, 1)))
    deep = RANDOM.integers(0, 65536, (9, 11)).astype(np.uint16)
    path = FOLDER / "pillow_16.png"
    Image.fromarray(deep).save(path)
    check(path, kind="rgb", ranges=ranges([linear(deep, 65535)] * 3))

    ramp = np.add.outer(np.arange(40) * 2, np.arange(56) * 3)
    ramp = np.stack([ramp, 255 - ramp, ramp // 2], -1).clip(0, 255).astype(np.uint8)
    for orientation in range(1, 9):
        for options in ({"subsampling": 2}, {"progressive": True}, {"subsampling": 0}):
            exif = Image.Exif()
            exif[274] = orientation
            path = FOLDER / f"pillow_{orientation}_{'_'.join(options)}.jpg"
            Image.fromarray(ramp).save(path, quality=90, exif=exif, **options)
            turned = ImageOps.exif_transpose(Image.open(path))
            light = linear(np.asarray(turned), 255).transpose(2, 0, 1)
            size = {"width": turned.width, "height": turned.height}
            check(path, tolerance=0.02, kind="rgb", ranges=ranges(light), **size)


def radiance():
    """Pictures that Radiance made, against its own `pvalue -o`, which undoes the exposure."""
    import pyradiance

    pixels = RANDOM.integers(0, 256, (20, 30, 4)).astype(np.uint8)
    pixels[..., 3] = 125 + pixels[..., 3] % 10
    pixels[..., 0] |= 128
    flat = FOLDER / "radiance_flat.hdr"
    lines = "#?RADIANCE\nsource.hdr:\n\tEXPOSURE=2.5\nrpict a.oct\nSOFTWARE= RADIANCE 5.4a\n"
    lines += "EXPOSURE=0.75\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 20 +X 30\n"
    flat.write_bytes(lines.encode() + pixels.tobytes())
    packed = FOLDER / "radiance_packed.hdr"
    packed.write_bytes(pyradiance.pfilt(str(flat), one_pass=True))
    for path in (flat, packed):
        told = pyradiance.pvalue(str(path), original=True, header=False, resstr=False, outform="f")
        values = np.frombuffer(told, np.float32).reshape(-1, 3).T
        stdprims = [[0.64, 0.33], [0.29, 0.6], [0.15, 0.06], [1 / 3, 1 / 3]]
        check(path, tolerance=1e-5 * values.max(), kind="rgb", ranges=ranges(values))
        check(path, white_cd_m2=179.0, primaries=stdprims)


def envi_keys():
    """Bands that are marked bad, and those with gains and offsets, against Spectral Python."""
    from spectral.io import envi

    image = RANDOM.integers(0, 30000, (5, 7, 4)).astype(np.int16)
    metadata = {"wavelength": [450, 520, 590, 660], "wavelength units": "Nanometers", "bbl": [1, 0, 1, 1]}
    path = FOLDER / "envi_bbl.hdr"
    envi.save_image(str(path), image, interleave="bip", metadata=metadata, dtype=np.int16)
    planes = image.transpose(2, 0, 1)[[0, 2, 3]]
    check(path, kind="spectral", centres_nm=[450, 590, 660], ranges=ranges(planes))
    del metadata["bbl"]
    gains, offsets = np.array([0.5, 1, 2, 0.01]), np.array([1.0, 0, -3, 7])
    metadata |= {"data gain values": gains.tolist(), "data offset values": offsets.tolist()}
    path = FOLDER / "envi_gains.hdr"
    envi.save_image(str(path), image, interleave="bsq", metadata=metadata, dtype=np.int16)
    planes = (image * gains + offsets).transpose(2, 0, 1)
    check(path, kind="spectral", ranges=ranges(planes))


PARTS = (openexr, mitsuba, colour_science, spectral_python, envi_keys, imageio_png, pillow, radiance)
for part in PARTS:
    try:
        part()
    except ImportError as missing:
        print(f"{part.__name__}: skipped, {missing}")
print("\n".join(FAILURES) or "everything is read as it was written")
sys.exit(bool(FAILURES))
