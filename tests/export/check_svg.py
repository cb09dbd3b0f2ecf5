"""Judges a folder of SVG layers against its build: check_svg.py BUILD FOLDER [FIRST LAST].

The files are read by printrun's projectlayer, as a user of a projector would, and every voxel is compared."""

import csv
import os
import sys

import numpy as np
from printrun.projectlayer import DisplayFrame, SettingsFrame

from vector_build import GRID, Build, area, compare_areas, compare_voxels

SVG = "{http://www.w3.org/2000/svg}"


def read_with_printrun(path):
    parse = next(f.parse_svg for f in (SettingsFrame, DisplayFrame) if hasattr(f, "parse_svg"))
    layers, height, slicer = parse(None, path)
    assert slicer == "Slic3r", slicer
    return layers, height


def polygons_of(path_data):
    numbers = path_data.replace("M", " ").replace("L", " ").split("Z")
    return [np.array([float(n) for n in part.split()]).reshape(-1, 2) for part in numbers if part.strip()]


def check_layer(build, layer, path):
    layers, thickness = read_with_printrun(path)
    assert len(layers) == 1, f"{len(layers)} layers in {path}"
    picture = layers[0]
    size = [float(picture.get(k)[:-2]) for k in ("width", "height")]
    assert np.allclose(size, [build.size[a] * build.pitch[a] for a in (0, 1)], atol=1e-6), size
    # printrun takes the last z of a file for a layer's thickness; ours has one layer, so it is that layer's top.
    assert abs(thickness - layer.z_top) < 1e-6, (thickness, layer.z_top)
    left = build.origin[0]
    top = build.origin[1] + build.size[1] * build.pitch[1]
    group = picture.find(SVG + "g")
    assert group.get("id") == f"layer{layer.index}"
    found = {}
    for material in group.findall(SVG + "g"):
        number = build.materials.index(material.findtext(SVG + "title"))
        colour = "#" + "".join(f"{round(255 * c):02x}" for c in build.colors[number])
        assert material.get("fill") == colour, (material.get("fill"), colour)
        for path_element in material.findall(SVG + "path"):
            polygons = polygons_of(path_element.get("d"))
            for polygon in polygons:
                found.setdefault(number, []).append(np.stack([left + polygon[:, 0], top - polygon[:, 1]], axis=1))
            areas = [area(polygon) for polygon in found[number][-len(polygons):]]
            assert areas[0] > 0 and all(hole < 0 for hole in areas[1:]), areas
    compare_areas(build, layer, found)
    return compare_voxels(build, layer, found, build.chord_error + 4 * GRID + 1e-6)


def main():
    build = Build(sys.argv[1])
    folder = sys.argv[2]
    first, last = [int(a) for a in sys.argv[3:5]] or (0, len(build.layers))
    with open(os.path.join(folder, "layers.csv"), newline="") as table:
        rows = list(csv.DictReader(table))
    assert [int(row["index"]) for row in rows] == list(range(first, last)), rows
    compared = excused = 0
    for row in rows:
        layer = build.layers[int(row["index"])]
        counts = check_layer(build, layer, os.path.join(folder, row["file"]))
        compared, excused = compared + counts[0], excused + counts[1]
    assert compared > 0 and excused <= 0.02 * compared, (compared, excused)
    print(len(rows), "layers", compared, "voxels", excused, "within the chord error of an edge")


main()
