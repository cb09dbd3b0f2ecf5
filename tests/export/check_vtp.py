"""Judges a folder of VTK layers against its build: check_vtp.py BUILD FOLDER [FIRST LAST]."""

import os
import sys

import numpy as np

from decode_vtp import Lines, series
from vector_build import GRID, Build, compare_areas, compare_voxels


def check_segments(build, layer, found):
    """One line a segment, in the order of the rows, ends to the last bits."""
    rows = layer.hatch or layer.raster
    c, s = np.cos(rows.angle), np.sin(rows.angle)
    row = np.repeat(np.arange(len(rows)), np.diff(rows.start))
    across = (rows.first_row + row + 0.5) * rows.spacing if layer.hatch else \
        build.origin[1] + (row + 0.5) * build.pitch[1]
    is_segment = found.kind == 0
    ends = np.array([line for line, kind in zip(found.lines, found.kind) if kind == 0], int).reshape(-1, 2)
    assert len(ends) == len(rows.x0), (len(ends), len(rows.x0))
    for end, x in ((0, rows.x0), (1, rows.x1)):
        points = found.points[ends[:, end]]
        wanted = np.stack([x * c - across * s, x * s + across * c, np.full(len(x), layer.z_sample)], axis=1)
        assert len(x) == 0 or np.max(np.abs(points - wanted)) < 1e-9, np.max(np.abs(points - wanted))
    assert np.array_equal(found.material[is_segment], rows.material)
    assert np.array_equal(found.solid[is_segment], rows.solid)
    return len(ends)


def check_contours(build, layer, found):
    polygons = {}
    for line, material, solid, kind in zip(found.lines, found.material, found.solid, found.kind):
        if kind == 1:
            assert line[0] == line[-1] and solid == -1
            assert np.all(found.points[line][:, 2] == layer.z_sample)
            polygons.setdefault(int(material), []).append(found.points[line[:-1], :2])
    if build.chord_error is None:
        assert not polygons
        return 0, 0
    compare_areas(build, layer, polygons)
    return compare_voxels(build, layer, polygons, build.chord_error + 4 * GRID)


def main():
    build = Build(sys.argv[1])
    folder = sys.argv[2]
    first, last = [int(a) for a in sys.argv[3:5]] or (0, len(build.layers))
    files = series(os.path.join(folder, "layers.pvd"))
    assert len(files) == last - first
    segments = compared = excused = 0
    for (time, name), layer in zip(files, build.layers[first:last]):
        assert abs(time - layer.z_sample) < 1e-9
        found = Lines(os.path.join(folder, name))
        assert found.materials == build.materials and found.solids == [path for path, _ in build.solids]
        segments += check_segments(build, layer, found)
        counts = check_contours(build, layer, found)
        compared, excused = compared + counts[0], excused + counts[1]
    assert segments > 0 and excused <= 0.02 * max(compared, 1), (segments, compared, excused)
    print(len(files), "layers", segments, "segments", compared, "voxels", excused, "within the chord error of an edge")


main()
