"""Judges a folder of SLC files against its build: check_slc.py BUILD FOLDER [FIRST LAST]."""

import os
import sys

import numpy as np

from decode_slc import SlcFile
from vector_build import GRID, Build, area, compare_areas, compare_voxels


def file_of(folder, name):
    """The file whose name is the material's, with what paths don't take replaced."""
    wanted = "".join(c if c.isalnum() or c in "-+.()" else "_" for c in name)
    found = [f for f in os.listdir(folder) if "".join(c if c.isalnum() or c in "-+.()" else "_" for c in f[:-4]) == wanted]
    assert len(found) == 1, (name, os.listdir(folder))
    return os.path.join(folder, found[0])


def main():
    build = Build(sys.argv[1])
    folder = sys.argv[2]
    first, last = [int(a) for a in sys.argv[3:5]] or (0, len(build.layers))
    files = {m: SlcFile(file_of(folder, build.materials[m])) for m in build.used_materials()}
    assert len(os.listdir(folder)) == len(files)
    layers = build.layers[first:last]
    rounding = max(np.max(np.abs(file.extents)) for file in files.values()) * 2.0 ** -23
    compared = excused = 0
    for file in files.values():
        assert len(file.layers) == len(layers) and len(file.table) == 1
        assert abs(file.table[0][0] - build.layers[0].z_bottom) <= rounding
        assert abs(file.table[0][1] - build.pitch[2]) <= rounding and file.table[0][2:] == (0.0, 0.0)
        assert abs(file.z_max - layers[-1].z_top) <= rounding
        points = np.concatenate([b for _, boundaries in file.layers for b in boundaries])
        assert np.allclose(file.extents[:2].T, [points.min(axis=0), points.max(axis=0)], atol=2 * rounding)
    for k, layer in enumerate(layers):
        polygons = {}
        for material, file in files.items():
            z, boundaries = file.layers[k]
            assert abs(z - layer.z_bottom) <= rounding, (z, layer.z_bottom)
            # A hole follows the outer boundary that it lies in.
            assert not boundaries or area(boundaries[0]) > 0
            polygons[material] = boundaries
        compare_areas(build, layer, polygons)
        counts = compare_voxels(build, layer, polygons, build.chord_error + 4 * GRID + rounding)
        compared, excused = compared + counts[0], excused + counts[1]
    assert compared > 0 and excused <= 0.02 * compared, (compared, excused)
    print(len(files), "files", len(layers), "layers", compared, "voxels", excused, "within the chord error of an edge")


main()
