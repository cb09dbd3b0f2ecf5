"""Describes a VDB as pyopenvdb reads it, for vdb_sink_test.cpp.

    read_vdb.py FILE NX NY NZ LABELS

prints one line per grid and item, and writes the grid `material` as unsigned bytes, x fastest, to LABELS.
"""

import sys

import numpy
import pyopenvdb

path, labels_path = sys.argv[1], sys.argv[5]
size = tuple(int(n) for n in sys.argv[2:5])

names = ["density", "material"]
table = pyopenvdb.read(path, "material")
count = 0
while f"material_{count + 1}" in table:
    count += 1
    print("name", count, table[f"material_{count}"])

if "rotation" in table:
    print("rotation", "material", table["rotation"])
    assert pyopenvdb.readMetadata(path)["rotation"] == table["rotation"]

for name in names + sys.argv[6:]:
    grid = pyopenvdb.read(path, name)
    print("grid", name, grid.gridClass, grid.creator, grid["unit"])
    print("active", name, grid.activeVoxelCount())
    print("pitch", name, *(repr(p) for p in grid.transform.voxelSize()))
    print("centre", name, *(repr(c) for c in grid.transform.indexToWorld((0, 0, 0))))
    array = numpy.zeros(size, dtype=numpy.float32)
    grid.copyToArray(array)
    print("sum", name, int(array.sum(dtype=numpy.float64)))
    if name == "material":
        array.transpose(2, 1, 0).astype(numpy.uint8).tofile(labels_path)
