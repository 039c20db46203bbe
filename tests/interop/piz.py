"""PIZ against OpenEXR, both ways, to the bit: piz.py SUNGAZE FOLDER [FILES] [SEED].

Random files of every type of sample, odd sizes, data windows off the origin, many channels and extreme values are written with PIZ by OpenEXR, pass
through `sungaze run`, which reads them and writes them with PIZ again, and are read by OpenEXR. Nothing is bleached: every sample must come back.
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
COUNT = int(sys.argv[3]) if len(sys.argv) > 3 else 60
SEED = int(sys.argv[4]) if len(sys.argv) > 4 else 20261126
UNSIGNED = {"half": np.uint16, "float": np.uint32, "uint": np.uint32}
FINAL = {"half": np.float16, "float": np.float32, "uint": np.uint32}


def bits(random, kind, shape):
    """Samples of one channel as bit patterns: PIZ is a wavelet over 16-bit words, a table of those that occur, and a Huffman code."""
    whole = np.iinfo(UNSIGNED[kind]).max
    y, x = np.mgrid[: shape[0], : shape[1]]
    few = random.integers(0, whole, 3, endpoint=True)
    made = {
        "noise": lambda: random.integers(0, whole, shape, endpoint=True),
        "constant": lambda: np.full(shape, few[0]),
        "ramp": lambda: (x * int(few[0] % 97) + y * int(few[1] % 31)) & whole,
        "few values": lambda: random.choice(few, shape),
        "sparse": lambda: np.where(random.random(shape) < 0.01, few[0], 0),
        "extremes": lambda: random.choice([0, 1, whole, whole // 2, whole // 2 + 1, whole - 1], shape),
        "zero": lambda: np.zeros(shape, np.int64),
    }
    return made[random.choice(list(made))]().astype(UNSIGNED[kind])


def colour(random, kind, shape):
    """Finite samples: those of a picture. Among them denormals, minus zero and the largest half."""
    values = [0.0, -0.0, 6e-8, 6.1e-5, 1.0, -1.5, 65504.0, -65504.0, 0.18]
    edges = random.choice(values, shape)
    smooth = random.normal(1.0, 0.3, shape)
    made = np.where(random.random(shape) < random.choice([0.0, 0.05, 1.0]), edges, smooth)
    return made.astype(FINAL[kind])


def written(random, path):
    height, width = (int(side) for side in random.integers(1, [90, 150]))
    if random.random() < 0.2:
        width, height = int(random.choice([1, 2, 3, 257])), int(random.choice([1, 31, 32, 33, 65]))
    left, top = (int(at) for at in random.integers(-40, 40, 2))
    kind = str(random.choice(["half", "float"]))
    channels = {name: colour(random, kind, (height, width)) for name in "RGB"}
    for i in range(random.integers(0, 14)):
        kind = str(random.choice(list(FINAL)))
        channels[f"aov{i}.x"] = bits(random, kind, (height, width)).view(FINAL[kind])
    window = np.array([left, top], np.int32), np.array([left + width - 1, top + height - 1], np.int32)
    header = {"compression": OpenEXR.PIZ_COMPRESSION, "type": OpenEXR.scanlineimage, "dataWindow": window, "displayWindow": window}
    if random.random() < 0.3:
        header |= {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
    OpenEXR.File(header, channels).write(str(path))


def samples(path):
    """Every channel of a file as bit patterns."""
    channels = OpenEXR.File(str(path), separate_channels=True).channels()
    return {name: channel.pixels.view(f"u{channel.pixels.dtype.itemsize}") for name, channel in channels.items()}


def failure(path, out):
    sets = ["numerics.model=none", "output.compression=piz", "output.display=none", "output.page=false", "output.state=none"]
    sets = [word for one in sets for word in ("--set", one)]
    command = [SUNGAZE, "run", str(path), "--fov", "10", "--white", "100", "--for", "1", "--fps", "1", "--quiet", "--overwrite", "--out", str(out)]
    run = subprocess.run(command + sets, capture_output=True, text=True)
    if run.returncode:
        return run.stderr.strip()
    seen = out / "seen.0001.exr"
    if OpenEXR.File(str(seen)).header()["compression"] != OpenEXR.PIZ_COMPRESSION:
        return "was not written with PIZ"
    before, after = samples(path), samples(seen)
    differ = [name for name in before if name not in after or not np.array_equal(before[name], after[name])]
    return f"differs in {', '.join(differ)}" if differ else None


failures = 0
for number in range(COUNT):
    path = FOLDER / f"piz.{number}.exr"
    written(np.random.default_rng([SEED, number]), path)
    if problem := failure(path, FOLDER / "out"):
        failures += 1
        print(f"file {number} of seed {SEED}: {problem}")
print(f"piz: {COUNT - failures} of {COUNT} files equal to the bit, both ways")
sys.exit(failures > 0)
