"""Judges a STEP file of layers against its build: check_step.py BUILD FILE [FIRST LAST].

gmsh reads it with its OpenCASCADE kernel. Every curve is a polygon; its corners come back from the curve itself. Material
properties, which OpenCASCADE reads of solids only, are looked up in the text."""

import re
import sys

import gmsh
import numpy as np

from vector_build import GRID, Build, distance, voxels_of_polygons, voxels_of_rows

READ = 2e-6  # mm: coordinates have six decimals


def corners(tag):
    """Corners of a polygon that is a spline of degree 1 with a knot for each, or a line."""
    lo, hi = gmsh.model.getParametrizationBounds(1, tag)
    count = int(round(hi[0] - lo[0]))
    parameters = np.linspace(lo[0], hi[0], count + 1)
    return np.array(gmsh.model.getValue(1, tag, parameters)).reshape(-1, 3)


def read_polygons(path):
    """Closed polygons by height."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    gmsh.model.occ.importShapes(path, highestDimOnly=False)
    gmsh.model.occ.synchronize()
    polygons = {}
    for dim, tag in gmsh.model.getEntities(1):
        points = corners(tag)
        assert np.array_equal(points[0], points[-1]), "a curve that doesn't close"
        assert np.all(points[:, 2] == points[0, 2]), "a curve that isn't level"
        polygons.setdefault(points[0, 2], []).append(points[:-1, :2])
    gmsh.finalize()
    return polygons


def check_properties(build, path):
    """Every product has the name and the density of a material, in g/cm^3."""
    with open(path, encoding="ascii") as stream:
        entities = dict(re.findall(r"^#(\d+)=((?:[^;']|'(?:[^']|'')*')*);", stream.read(), re.M))
    # By id: what refers to it.
    users = {}
    for number, text in entities.items():
        for reference in re.findall(r"#(\d+)", text):
            users.setdefault(reference, []).append(number)

    def used_by(number, keyword):
        return [n for n in users.get(number, []) if entities[n].startswith(keyword + "(")]

    names = []
    for number, text in entities.items():
        if not text.startswith("PRODUCT("):
            continue
        name = re.match(r"PRODUCT\('((?:[^']|'')*)'", text)[1]
        names.append(name)
        (formation,) = used_by(number, "PRODUCT_DEFINITION_FORMATION")
        (definition,) = used_by(formation, "PRODUCT_DEFINITION")
        items = {}
        for prop in used_by(definition, "PROPERTY_DEFINITION"):
            what = re.match(r"PROPERTY_DEFINITION\('material property','([a-z ]+)'", entities[prop])[1]
            (of_property,) = used_by(prop, "PROPERTY_DEFINITION_REPRESENTATION")
            representation = re.findall(r"#(\d+)", entities[of_property])[1]
            items[what] = entities[re.findall(r"#(\d+)", entities[representation])[0]]
        assert items["material name"] == f"DESCRIPTIVE_REPRESENTATION_ITEM('{name}','{name}')", items
        density = build.densities[build.materials.index(name)]
        if np.isnan(density):
            assert "density" not in items
            continue
        stated = float(re.search(r"POSITIVE_RATIO_MEASURE\(([0-9.]+)\)", items["density"])[1])
        assert abs(stated - density) < 1e-6, (stated, density)
        unit = entities[re.findall(r"#(\d+)", items["density"])[-1]]
        parts = sorted(re.search(r",(-?[0-9.]+)\)", entities[n])[1] for n in re.findall(r"#(\d+)", unit))
        assert parts == ["-3.", "1."], parts
    assert names and len(set(names)) == len(names)


def compare_outlines(build, layer, polygons, slack):
    """A point lies in one material, or in none: by parity of all polygons together, which share edges but no area."""
    centres = build.origin[0] + (np.arange(build.size[0]) + 0.5) * build.pitch[0]
    compared = excused = 0
    for row in range(build.size[1]):
        by_polygons = voxels_of_polygons(build, polygons, row)
        by_rows = np.zeros(build.size[0], bool)
        for material in range(len(build.materials)):
            by_rows |= voxels_of_rows(build, layer.raster, row, material)
        compared += build.size[0]
        for i in np.nonzero(by_polygons != by_rows)[0]:
            point = np.array([centres[i], build.origin[1] + (row + 0.5) * build.pitch[1]])
            off = distance(polygons, point)
            assert off <= slack, f"layer {layer.index}, row {row}, pixel {i}: {off} mm inside"
            excused += 1
    return compared, excused


def main():
    build = Build(sys.argv[1])
    first, last = [int(a) for a in sys.argv[3:5]] or (0, len(build.layers))
    check_properties(build, sys.argv[2])
    polygons = read_polygons(sys.argv[2])
    heights = sorted(polygons)
    layers = [layer for layer in build.layers[first:last] if layer.loops]
    assert len(heights) == len(layers), (len(heights), len(layers))
    compared = excused = 0
    for z, layer in zip(heights, layers):
        assert abs(z - layer.z_sample) <= READ, (z, layer.z_sample)
        counts = compare_outlines(build, layer, polygons[z], build.chord_error + 4 * GRID + READ)
        compared, excused = compared + counts[0], excused + counts[1]
    assert compared > 0 and excused <= 0.02 * compared, (compared, excused)
    print(len(layers), "layers", compared, "voxels", excused, "within the chord error of an edge")


main()
