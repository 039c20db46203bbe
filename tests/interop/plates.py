"""Frames that carry more than colours through `sungaze run`, compared by OpenEXR's own reader: plates.py SUNGAZE FOLDER.

A plate as Nuke writes it, a multilayer file as Blender does, AOVs as Mitsuba does, PIZ of every type of sample. All but the picture's R, G, B must
come back equal, and these too, since nothing is bleached.
"""

import subprocess
import sys
from pathlib import Path

try:
    import numpy as np
    import OpenEXR
except ImportError as missing:
    print(f"skipped: {missing} (pip install OpenEXR numpy)")
    sys.exit(0)

SUNGAZE, FOLDER = sys.argv[1], Path(sys.argv[2])
RANDOM = np.random.default_rng(11)
FAILURES = []
#: Attributes of how a file is stored, and ours.
STORAGE = {"compression", "lineOrder", "type", "chunkCount", "tiles", "sungaze", "channels", "version"}


def half(height, width):
    return RANDOM.uniform(0, 2, (height, width)).astype(np.float16)


def single(height, width):
    return RANDOM.uniform(0, 100, (height, width)).astype(np.float32)


def window(left, top, right, bottom):
    return np.array([left, top], np.int32), np.array([right, bottom], np.int32)


def nuke():
    h, w = 94, 140
    attributes = {
        "dataWindow": window(-6, -8, w - 7, h - 9),
        "displayWindow": window(0, 0, 127, 71),
        "timeCode": OpenEXR.TimeCode(1, 2, 3, 4, *[0] * 6, *range(8)),
        "nuke/node_hash": "1234abcd",
        "nuke/version": "15.1v3",
        "colorspace": "ACES - ACEScg",
        "cameraFocalLength": 35.0,
        "worldToCamera": np.arange(16, dtype=np.float32).reshape(4, 4),
        "chromaticities": (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767),
        "multiView": ["left", "right"],
    }
    first = {name: half(h, w) for name in "RGBA"}
    first |= {"Z": single(h, w)} | {f"diffuse.{name}": half(h, w) for name in "RGB"}
    beauty = {**attributes, "name": "rgba", "type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIPS_COMPRESSION}
    other = {
        **attributes,
        "name": "cryptomatte",
        "type": OpenEXR.tiledimage,
        "tiles": OpenEXR.TileDescription(),
        "compression": OpenEXR.PIZ_COMPRESSION,
    }
    parts = [
        OpenEXR.Part(beauty, first),
        OpenEXR.Part(other, {f"crypto00.{name}": single(h, w) for name in "RGBA"}),
    ]
    return OpenEXR.File(parts)


def blender():
    h, w = 60, 80
    layers = [f"ViewLayer.{one}" for one in ("Combined", "DiffDir", "Emit")]
    channels = {f"{layer}.{name}": half(h, w) for layer in layers for name in "RGBA"}
    channels |= {"ViewLayer.Depth.Z": single(h, w)}
    channels |= {f"ViewLayer.Normal.{name}": single(h, w) for name in "XYZ"}
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "BlenderMultiChannel": "Blender V2.55.1 and newer",
        "Camera": "Camera",
        "Frame": "001",
        "xDensity": 72.0,
    }
    return OpenEXR.File(header, channels)


def mitsuba():
    h, w = 64, 96
    channels = {name: half(h, w) for name in "RGB"}
    channels |= {"dd.y": half(h, w), "alpha": half(h, w)}
    channels |= {f"nn.{name}": half(h, w) for name in "XYZ"}
    header = {
        "compression": OpenEXR.PIZ_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "generatedBy": "Mitsuba version 3.5.2",
        "log": "rendered",
    }
    return OpenEXR.File(header, channels)


def piz():
    h, w = 75, 131
    channels = {name: half(h, w) for name in "RGB"}
    channels |= {f"smooth.{name}": np.linspace(0, 9, h * w, dtype=np.float32).reshape(h, w) for name in "RGB"}
    channels |= {"noise": single(h, w), "id": RANDOM.integers(0, 2**32, (h, w), dtype=np.uint32)}
    channels |= {"flat": np.zeros((h, w), np.float16)}
    return OpenEXR.File({"compression": OpenEXR.PIZ_COMPRESSION, "type": OpenEXR.scanlineimage}, channels)


def equal(a, b):
    if b is None:
        return False
    if isinstance(a, (tuple, list)):
        return len(a) == len(b) and all(equal(x, y) for x, y in zip(a, b))
    if isinstance(a, np.ndarray):
        return a.shape == b.shape and a.dtype == b.dtype and np.array_equal(a, b)
    return str(a) == str(b)


def compare(name, source, seen):
    with OpenEXR.File(str(source), separate_channels=True) as before, OpenEXR.File(
        str(seen), separate_channels=True
    ) as after:
        if len(before.parts) != len(after.parts):
            FAILURES.append(f"{name}: {len(after.parts)} parts, should be {len(before.parts)}")
        for old, new in zip(before.parts, after.parts):
            for key, value in old.header.items():
                if key not in STORAGE and not equal(value, new.header.get(key)):
                    FAILURES.append(f"{name}: {key} is {new.header.get(key)}, should be {value}")
            if set(old.channels) != set(new.channels):
                FAILURES.append(f"{name}: channels {sorted(new.channels)}, should be {sorted(old.channels)}")
            for key in set(old.channels) & set(new.channels):
                if not equal(old.channels[key].pixels, new.channels[key].pixels):
                    FAILURES.append(f"{name}: channel {key} differs")
    told = [failure for failure in FAILURES if failure.startswith(f"{name}:")]
    print(f"{name}: {'FAILED' if told else 'all that it carries comes back'}")


def main():
    layers = {"blender": "ViewLayer.Combined"}
    for make in (nuke, blender, mitsuba, piz):
        name = make.__name__
        source, out = FOLDER / f"{name}.exr", FOLDER / f"{name}_out"
        make().write(str(source))
        settings = [
            f"input.frames='{source}'",
            "input.white_cd_m2=100",
            "input.horizontal_fov_deg=40",
            f"input.layer='{layers.get(name, '')}'",
            "numerics.model='none'",
            "time.duration_s=0.04",
            "output.display='none'",
        ]
        command = [SUNGAZE, "run", "--quiet", "--out", str(out)]
        run = subprocess.run(command + [x for s in settings for x in ("--set", s)], capture_output=True, text=True)
        if run.returncode:
            FAILURES.append(f"{name}: {run.stderr.strip()}")
            continue
        for seen in sorted(out.glob("seen.0*.exr")):
            compare(name, source, seen)
    print("\n".join(FAILURES))
    return bool(FAILURES)


sys.exit(main())
