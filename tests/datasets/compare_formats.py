"""Compares a build's volumes and pictures with its segments, voxel by voxel.

    compare_formats.py BUILD FOLDER [dithered]

FOLDER holds `png-indexed`, `sl1`, `a.tif`, `a.nrrd`, `a.mhd`, `a.vti` and `a.vdb` of the build. Labels are made from the segments
that h5py reads from the store, by the definition: a voxel has the material of the segment that holds its centre. Prints a line for each
format and one with the number of voxels of each material; fails with the first voxel that differs. Of dithered builds the pictures are
what the others are compared with, and must have material where the segments have.
"""

import csv
import pathlib
import subprocess
import sys
import xml.etree.ElementTree as tree

import h5py
import numpy
from PIL import Image

build, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
readers = pathlib.Path(__file__).parent.parent / "export"
store = tree.parse(build / "build.xml").getroot()
space = {"b": "urn:lamella:build:1"}
grid = store.find(".//b:grid", space)
origin, pitch = ([float(grid.get(f"{key}_{axis}")) for axis in "xyz"] for key in ("origin", "pitch"))
nx, ny, nz = (int(grid.get(f"size_{axis}")) for axis in "xyz")
materials = [m.get("name") for m in store.findall("b:materials/b:material", space)]

expected = numpy.zeros((nz, ny, nx), dtype=numpy.uint16)
centres = origin[0] + (numpy.arange(nx) + 0.5) * pitch[0]
with h5py.File(build / "layers.h5") as layers:
    for k, name in enumerate(sorted(name for name in layers if name.startswith("layer_"))):
        rows = layers[name]["raster"]
        start = rows["row_start"][:]
        first = numpy.searchsorted(centres, rows["x_begin"][:], side="left")
        last = numpy.searchsorted(centres, rows["x_end"][:], side="left")
        material = rows["material"][:]
        for j in range(ny):
            for n in range(start[j], start[j + 1]):
                expected[k, j, first[n] : last[n]] = 1 + material[n]


def check(name, labels):
    differ = numpy.argwhere(labels != expected)
    assert labels.shape == expected.shape, (name, labels.shape, expected.shape)
    assert len(differ) == 0, f"{name}: {len(differ)} voxels differ, the first is (k, j, i) = {differ[0]}"
    print(name)


def by_script(script, *arguments):
    out = folder / "labels"
    subprocess.run(["/usr/bin/python3", readers / script, *arguments], check=True, stdout=subprocess.DEVNULL)
    return out


pictures = numpy.stack([
    numpy.asarray(Image.open(folder / "png-indexed" / f"layer_{k:06}.png"))[::-1] for k in range(nz)])
if "dithered" in sys.argv:
    assert ((pictures > 0) == (expected > 0)).all()
    graded = [n for n, m in enumerate(store.findall("b:materials/b:material", space), 1) if m.find("b:component", space) is not None]
    inside = numpy.isin(expected, graded)
    shares = [(pictures[inside] == label).mean() for label in numpy.unique(pictures[inside])]
    assert len(shares) > 1 and min(shares) > 0.01, shares
    materials = [m for n, m in enumerate(materials, 1) if n not in graded]
    expected = pictures.astype(numpy.uint16)
check("png-indexed", pictures)
for file in ("a.tif", "a.nrrd", "a.mhd", "a.vti"):
    labels = by_script("read_volume.py", folder / file, folder / "labels")
    check(file, numpy.fromfile(labels, dtype="<u2").reshape(nz, ny, nx))
with open(folder / "png-indexed" / "materials.csv", newline="") as table:
    assert [row["name"] for row in csv.DictReader(table)] == materials
assert len(list((folder / "sl1").iterdir())) == len(materials)
labels = by_script("read_vdb.py", folder / "a.vdb", str(nx), str(ny), str(nz), folder / "labels")
check("a.vdb", numpy.fromfile(labels, dtype=numpy.uint8).reshape(nz, ny, nx))
with open(folder / "png" / "materials.csv", newline="") as table:
    folders = [row["folder"] for row in csv.DictReader(table)]
labels = by_script("read_printer_format.py", "sl1", folder / "sl1", folder / "labels", *folders)
check("sl1", numpy.fromfile(labels, dtype=numpy.uint8).reshape(nz, ny, nx)[:, ::-1])
print("voxels", *numpy.bincount(expected.ravel(), minlength=1 + len(materials))[1:])
