"""Reads the pictures of a printer's format with Pillow, for printer_formats_test.cpp.

    read_printer_format.py polyjet|sl1 PLACE LABELS MATERIAL...

prints what the pictures are, and writes the label of each pixel as a byte, pictures from the first to the last, to LABELS.
"""

import csv
import io
import pathlib
import sys
import zipfile

import numpy
from PIL import Image

kind, place, output, materials = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3], sys.argv[4:]


def polyjet():
    count = len(list(place.glob("*.png")))
    pictures = [Image.open(place / f"layer_{number}.png") for number in range(count)]
    assert all((p.mode, p.size) == (pictures[0].mode, pictures[0].size) for p in pictures)
    pixels = numpy.stack([numpy.asarray(p) for p in pictures])
    opaque = (pixels[..., 3] == 255).all()
    labels = numpy.full(pixels.shape[:3], 255, dtype=numpy.uint8)
    labels[(pixels[..., :3] == 0).all(axis=-1)] = 0
    with open(place / "materials.csv", newline="") as table:
        for row in csv.DictReader(table):
            color = [int(row[channel]) for channel in ("red", "green", "blue")]
            labels[(pixels[..., :3] == color).all(axis=-1)] = 1 + materials.index(row["name"])
    print(pictures[0].mode, *pictures[0].size, count, "opaque" if opaque else "transparent")
    return labels


def sl1():
    labels = None
    for label, material in enumerate(materials, 1):
        with zipfile.ZipFile(place / f"{material}.sl1") as archive:
            assert archive.testzip() is None
            names = sorted(name for name in archive.namelist() if name.endswith(".png"))
            pictures = [Image.open(io.BytesIO(archive.read(name))) for name in names]
            keys = {}
            for table in ("config.ini", "prusaslicer.ini"):
                keys |= dict(line.split(" = ", 1) for line in archive.read(table).decode().splitlines())
        assert int(keys["numFast"]) == len(pictures)
        assert names == [f"{keys['jobDir']}{number:05}.png" for number in range(len(names))]
        masks = numpy.stack([numpy.asarray(p) for p in pictures])
        assert set(numpy.unique(masks)) <= {0, 255}
        labels = numpy.zeros(masks.shape, dtype=numpy.uint8) if labels is None else labels
        assert not labels[masks == 255].any()
        labels[masks == 255] = label
        print(pictures[0].mode, *pictures[0].size, len(pictures))
        for key, value in keys.items():
            print(key, value)
    return labels


(polyjet if kind == "polyjet" else sl1)().tofile(output)
