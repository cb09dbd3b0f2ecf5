"""Judges a 3MF file against its build: check_3mf.py BUILD FILE [FIRST LAST].

lib3mf reads it in strict mode (check_3mf.mjs), and what lib3mf writes of what it has read must be the file's own text to
the six digits that it gives to slices; that text is compared with the build. Exit code 77 says that lib3mf isn't there."""

import json
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
import zipfile

import numpy as np

from vector_build import GRID, Build, area, compare_areas, compare_voxels

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
SLICE = "{http://schemas.microsoft.com/3dmanufacturing/slice/2015/07}"
BLOCKS = 64


def model_of(path):
    with zipfile.ZipFile(path) as package:
        name = next(n for n in package.namelist() if n.endswith(".model"))
        return ET.fromstring(package.read(name))


def compare_models(ours, theirs, slack):
    """The same slices and the same mesh, object by object."""
    for kind in ("vertex", "triangle"):
        a, b = (np.array([[float(v) for v in e.attrib.values()][:3] for e in model.iter(CORE + kind)])
                for model in (ours, theirs))
        assert a.shape == b.shape and np.max(np.abs(a - b)) <= slack, kind
    a, b = ([[float(v.get("x")), float(v.get("y"))] for v in model.iter(SLICE + "vertex")] for model in (ours, theirs))
    assert len(a) == len(b) and np.max(np.abs(np.array(a) - np.array(b))) <= slack, "vertices of slices"
    a, b = ([s.get("v2") for s in model.iter(SLICE + "segment")] for model in (ours, theirs))
    assert a == b, "segments of slices"


def read_with_lib3mf(path):
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "check_3mf.mjs")
    with tempfile.TemporaryDirectory() as folder:
        again = os.path.join(folder, "again.3mf")
        run = subprocess.run(["node", script, path, again], capture_output=True, text=True)
        if run.returncode == 77:
            sys.exit(77)
        assert run.returncode == 0, run.stderr
        return json.loads(run.stdout), model_of(again)


def slices_of(stack):
    """Upper heights and polygons, and the stack's bottom."""
    slices = []
    for element in stack.findall(SLICE + "slice"):
        vertices = np.array([[float(v.get("x")), float(v.get("y"))] for v in element.iter(SLICE + "vertex")])
        polygons = []
        for polygon in element.iter(SLICE + "polygon"):
            order = [int(polygon.get("startv"))] + [int(s.get("v2")) for s in polygon.iter(SLICE + "segment")]
            assert order[0] == order[-1], "a polygon that doesn't close"
            polygons.append(vertices[order[:-1]])
        slices.append((float(element.get("ztop")), polygons))
    return float(stack.get("zbottom")), slices


def mesh_volume(mesh):
    points = np.array([[float(v.get(a)) for a in "xyz"] for v in mesh.iter(CORE + "vertex")])
    corners = np.array([[int(t.get(c)) for c in ("v1", "v2", "v3")] for t in mesh.iter(CORE + "triangle")])
    # Every side once in each direction: closed and oriented.
    sides = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    there = {tuple(side) for side in sides}
    assert len(there) == len(sides) and all((b, a) in there for a, b in there), "the mesh isn't closed"
    a, b, c = (points[corners[:, k]] for k in range(3))
    a, b, c = a - points[0], b - points[0], c - points[0]
    return float(np.sum(a * np.cross(b, c)) / 6.0)


def check_mesh(build, mesh, layers, areas):
    """Blocks of layers, each as high as its layers together and as large as the fullest of them."""
    per_block = -(-len(build.layers) // BLOCKS)
    expected = 0.0
    for block in {layer.index // per_block for layer in layers}:
        members = [(a, layer) for a, layer in zip(areas, layers) if layer.index // per_block == block]
        expected += max(a for a, _ in members) * (members[-1][1].z_top - members[0][1].z_bottom)
    volume = mesh_volume(mesh)
    assert abs(volume - expected) <= 1e-4 * expected + 1e-6, (volume, expected)


def main():
    build = Build(sys.argv[1])
    first, last = [int(a) for a in sys.argv[3:5]] or (0, len(build.layers))
    layers = build.layers[first:last]
    model = model_of(sys.argv[2])
    seen, again = read_with_lib3mf(sys.argv[2])
    bases = [b for b in model.iter(CORE + "base")]
    assert [b.get("name") for b in bases] == build.materials
    for base, color in zip(bases, build.colors):
        assert base.get("displaycolor")[:7].lower() == "#" + "".join(f"{round(255 * c):02x}" for c in color)
    stacks = {s.get("id"): slices_of(s) for s in model.iter(SLICE + "slicestack")}
    objects = {int(o.get("pindex")): o for o in model.iter(CORE + "object")}
    assert len(list(model.iter(CORE + "item"))) == len(objects) == len(seen)
    # lib3mf keeps 32-bit floats.
    reach = max(np.max(np.abs(l[3])) for layer in layers for l in layer.loops)
    reach = max(reach, abs(layers[0].z_bottom), abs(layers[-1].z_top))
    rounding = 1e-6 + 2.0 ** -23 * reach
    compare_models(model, again, 1e-5 * reach)
    polygons_of = [{} for _ in layers]
    for material, found in zip(sorted(objects), seen):
        assert found["name"] == build.materials[material] and found["closed"] and found["valid"] and found["lowres"]
        bottom, slices = stacks[objects[material].get(SLICE + "slicestackid")]
        assert abs(found["bottom"] - layers[0].z_bottom) <= rounding and abs(bottom - layers[0].z_bottom) <= rounding
        assert len(slices) == len(layers) == len(found["slices"])
        for k, (layer, (z_top, polygons)) in enumerate(zip(layers, slices)):
            assert abs(z_top - layer.z_top) <= rounding and abs(found["slices"][k][0] - layer.z_top) <= rounding
            assert found["slices"][k][1:] == [sum(len(p) for p in polygons), len(polygons)]
            polygons_of[k][material] = polygons
        areas = [sum(area(p) for p in polygons) for _, polygons in slices]
        check_mesh(build, objects[material].find(CORE + "mesh"), layers, areas)
    compared = excused = 0
    for layer, polygons in zip(layers, polygons_of):
        compare_areas(build, layer, polygons)
        counts = compare_voxels(build, layer, polygons, build.chord_error + 4 * GRID + rounding)
        compared, excused = compared + counts[0], excused + counts[1]
    assert compared > 0 and excused <= 0.02 * compared, (compared, excused)
    print(len(seen), "objects", len(layers), "layers", compared, "voxels", excused, "within the chord error of an edge")


main()
