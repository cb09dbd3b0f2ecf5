"""Judges a CLI file against its build: check_cli.py BUILD FILE [FIRST LAST]."""

import sys

import numpy as np

from decode_cli import CliFile
from vector_build import GRID, Build, area, compare_areas, compare_voxels, tracks


def check_polylines(build, layer, found, rounding):
    polygons = {}
    for label, direction, points in found.polylines:
        assert direction == (1 if area(points[:-1]) > 0 else 0), "direction and sense disagree"
        polygons.setdefault(label - 1, []).append(points[:-1])
    if build.chord_error is None:
        assert not polygons
        return 0, 0
    compare_areas(build, layer, polygons)
    return compare_voxels(build, layer, polygons, build.chord_error + 4 * GRID + rounding)


def check_hatches(build, layer, found, rounding):
    expected = tracks(build, layer)
    assert [label - 1 for label, _ in found.hatches] == sorted(expected), "materials of hatches"
    for label, ends in found.hatches:
        wanted = expected[label - 1]
        assert ends.shape == wanted.shape, (ends.shape, wanted.shape)
        assert np.max(np.abs(ends - wanted)) <= rounding, np.max(np.abs(ends - wanted))
    return sum(len(ends) for _, ends in found.hatches)


def main():
    build = Build(sys.argv[1])
    file = CliFile(sys.argv[2])
    first, last = [int(a) for a in sys.argv[3:5]] or (0, len(build.layers))
    reach = np.max(np.abs(file.dimension))
    rounding = reach * 2.0 ** -23 if file.is_binary else 1e-6
    plain = [name.encode("ascii", "replace").decode() for name in build.materials]
    for label, name in enumerate(plain, 1):
        assert len(file.labels[label]) >= len(name) and file.labels[label][:3] == name[:3], (file.labels, name)
    layers = build.layers[first:last]
    assert file.layer_count == len(file.layers) == len(layers) + 1, (file.layer_count, len(file.layers))
    zero = file.layers[0]
    assert abs(zero.z - layers[0].z_bottom) <= rounding and not zero.polylines and not zero.hatches
    compared = excused = hatches = 0
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for layer, found in zip(layers, file.layers[1:]):
        assert abs(found.z - layer.z_top) <= rounding, (found.z, layer.z_top)
        counts = check_polylines(build, layer, found, rounding)
        compared, excused = compared + counts[0], excused + counts[1]
        hatches += check_hatches(build, layer, found, rounding)
        for points in [p for _, _, p in found.polylines] + [h.reshape(-1, 2) for _, h in found.hatches]:
            low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    assert np.allclose(file.dimension[:2], low, atol=2 * rounding), (file.dimension, low)
    assert np.allclose(file.dimension[3:5], high, atol=2 * rounding), (file.dimension, high)
    assert hatches > 0 and excused <= 0.02 * max(compared, 1), (hatches, compared, excused)
    print(len(layers), "layers", hatches, "hatches", compared, "voxels", excused, "within the chord error of an edge")


main()
