"""Describes a level set as pyopenvdb reads it and writes its values as 32-bit floats, x fastest, for vdb_sink_test.cpp.

    read_level_set.py FILE GRID SIDE VALUES
"""

import sys

import numpy
import pyopenvdb

grid = pyopenvdb.read(sys.argv[1], sys.argv[2])
side = int(sys.argv[3])
print(grid.gridClass, grid["material_name"], grid["unit"], f"{grid.background:.6g}")
values = numpy.zeros((side, side, side), dtype=numpy.float32)
grid.copyToArray(values)
values.transpose(2, 1, 0).tofile(sys.argv[4])
