"""Uncompressed scanline OpenEXR files (openexr.com, "OpenEXR File Layout"), written here so that no
other writer stands between an array and a run."""

import struct

import numpy as np


def write(path, frame, names="RGB"):
    """`frame`: (h, w, channels), float16 or float32; a name each."""
    order = sorted(range(len(names)), key=lambda i: names[i])
    rows = np.ascontiguousarray(frame[:, :, order].transpose(0, 2, 1))
    head = header(frame, [names[i] for i in order])
    first = len(head) + 8 * len(rows)
    offsets = [first + y * (8 + rows[0].nbytes) for y in range(len(rows))]
    chunks = [struct.pack("<ii", y, row.nbytes) + row.tobytes() for y, row in enumerate(rows)]
    path.write_bytes(head + struct.pack(f"<{len(rows)}Q", *offsets) + b"".join(chunks))


def header(frame, names):
    height, width, _ = frame.shape
    kind = 1 if frame.dtype == np.float16 else 2
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    channels = [name.encode() + struct.pack("<xiiii", kind, 0, 1, 1) for name in names]
    attributes = [
        ("channels", "chlist", b"".join(channels) + b"\0"),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]
    packed = [
        f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value
        for name, kind, value in attributes
    ]
    return struct.pack("<ii", 20000630, 2) + b"".join(packed) + b"\0"
