"""Judges a STEP file of curves and hatches against its build: check_step_curves.py BUILD FILE.

A parser of the text says which layer and material every curve is of, and how long each is by its own numbers; gmsh, with its
OpenCASCADE kernel, has to find as many and as long ones; hatches are those of the build."""

import re
import sys
from collections import defaultdict

import gmsh
import numpy as np

from vector_build import Build

SAMPLES = 4001


class File:
    def __init__(self, path):
        with open(path, encoding="ascii") as stream:
            self.entities = dict(re.findall(r"^#(\d+)=((?:[^;']|'(?:[^']|'')*')*);", stream.read(), re.M))

    def of(self, keyword):
        return [n for n, text in self.entities.items() if text.startswith(keyword + "(")]

    def references(self, number):
        return re.findall(r"#(\d+)", re.sub(r"'(?:[^']|'')*'", "", self.entities[number]))

    def numbers(self, number):
        text = re.sub(r"#\d+|'(?:[^']|'')*'", "", self.entities[number])
        return [float(v) for v in re.findall(r"-?\d+\.\d*(?:E-?\d+)?", text)]

    def name(self, number):
        name = re.match(r"[A-Z_]+\('((?:[^']|'')*)'", self.entities[number])[1]
        name = re.sub(r"\\X2\\([0-9A-F]+)\\X0\\", lambda hexes: bytes.fromhex(hexes[1]).decode("utf-16-be"), name)
        return name.replace("''", "'").replace("\\\\", "\\")

    def points(self, numbers):
        return np.array([self.numbers(n) for n in numbers])


def conic_points(file, number, begin, end):
    placement = file.references(number)[0]
    center, axis, x = [np.array(file.numbers(n)) for n in file.references(placement)]
    y = np.cross(axis, x)
    radii = file.numbers(number)
    assert abs(np.linalg.norm(x) - 1.0) < 1e-12 and len(radii) in (1, 2)
    angle = np.linspace(begin, end, SAMPLES)[:, None]
    return center + radii[0] * np.cos(angle) * x + radii[-1] * np.sin(angle) * y


def spline_points(file, number):
    """By De Boor's recursion, evaluated within every span of knots."""
    poles = file.points(re.findall(r"#(\d+)", file.entities[number].split("),")[0]))
    multiplicities, knots = re.search(r"\(([0-9,]+)\),\(([0-9.,E+-]+)\),\.UNSPECIFIED\.\)$",
                                      file.entities[number]).groups()
    multiplicities, knots = [int(m) for m in multiplicities.split(",")], [float(k) for k in knots.split(",")]
    assert multiplicities == [6] + [4] * (len(knots) - 2) + [6]
    vector = np.repeat(knots, multiplicities)
    assert len(poles) == len(vector) - 6 and np.all(np.diff(knots) > 0)
    points = []
    for lo, hi in zip(knots, knots[1:]):
        at = int(np.searchsorted(vector, lo, side="right")) - 1
        t = np.linspace(lo, hi, 401)[:, None]
        rest = [np.broadcast_to(poles[at - 5 + j], (len(t), 3)) for j in range(6)]
        for level in range(1, 6):
            for j in range(5, level - 1, -1):
                left, right = vector[at - 5 + j], vector[at + 1 + j - level]
                alpha = (t - left) / (right - left)
                rest[j] = (1.0 - alpha) * rest[j - 1] + alpha * rest[j]
        points.append(rest[5])
    return np.concatenate(points)


def rational_points(file, number):
    text = file.entities[number]
    poles = file.points(re.findall(r"#(\d+)", re.search(r"B_SPLINE_CURVE\(2,\(([^)]*)\)", text)[1]))
    weights = [float(w) for w in re.search(r"RATIONAL_B_SPLINE_CURVE\(\(([^)]*)\)", text)[1].split(",")]
    assert len(poles) == len(weights) == 3 and min(weights) > 0.0
    assert "B_SPLINE_CURVE_WITH_KNOTS((3,3),(0.,1.)," in text
    t = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    blend = [(1.0 - t) ** 2 * weights[0], 2.0 * t * (1.0 - t) * weights[1], t**2 * weights[2]]
    return sum(b * pole for b, pole in zip(blend, poles)) / sum(blend)


def curve_points(file, number):
    text = file.entities[number]
    if text.startswith("(BOUNDED_CURVE()B_SPLINE_CURVE("):
        return rational_points(file, number)
    if text.startswith("POLYLINE("):
        return file.points(file.references(number))
    if text.startswith(("CIRCLE(", "ELLIPSE(")):
        return conic_points(file, number, 0.0, 2.0 * np.pi)
    if text.startswith("TRIMMED_CURVE("):
        begin, end = [float(v) for v in re.findall(r"PARAMETER_VALUE\(([^)]+)\)", text)]
        assert begin < end <= begin + 2.0 * np.pi + 1e-9
        return conic_points(file, file.references(number)[0], begin, end)
    assert text.startswith("B_SPLINE_CURVE_WITH_KNOTS('',5,"), text
    return spline_points(file, number)


def kind_of(text):
    return "RATIONAL_B_SPLINE_CURVE" if text.startswith("(") else re.match("[A-Z_]+", text)[0]


def length(points):
    return float(np.sum(np.linalg.norm(np.diff(points, axis=0), axis=1)))


def curves_of(file, element):
    if not file.entities[element].startswith("COMPOSITE_CURVE("):
        return [element]
    return [file.references(segment)[0] for segment in file.references(element)]


def check_loop(file, element):
    """Every curve begins where the one before ends; outer loops run counterclockwise."""
    stretches = [curve_points(file, n) for n in curves_of(file, element)]
    for a, b in zip(stretches, stretches[1:] + stretches[:1]):
        assert np.linalg.norm(b[0] - a[-1]) <= 1.001e-6, (element, a[-1], b[0])
    points = np.concatenate(stretches)
    x, y = points[:, 0], points[:, 1]
    area = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    assert (area > 0.0) == (file.name(element) == "outer") and file.name(element) in ("outer", "hole")


def hatch_lengths(layer, materials):
    rows = layer.hatch
    return np.bincount(rows.material, rows.x1 - rows.x0, materials), np.bincount(rows.material, minlength=materials)


def read_with_gmsh(path, heights):
    """The lengths of all curves by the height that is nearest: hatches have theirs to 1e-6 only."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    gmsh.model.occ.importShapes(path, highestDimOnly=False)
    gmsh.model.occ.synchronize()
    found = defaultdict(list)
    for _, tag in gmsh.model.getEntities(1):
        lo, hi = gmsh.model.getParametrizationBounds(1, tag)
        z = gmsh.model.getValue(1, tag, [lo[0]])[2]
        found[min(heights, key=lambda height: abs(height - z))].append(gmsh.model.occ.getMass(1, tag))
    gmsh.finalize()
    return found


def main():
    build = Build(sys.argv[1])
    file = File(sys.argv[2])
    materials = len(build.materials)
    product_of = {}
    for number in file.of("GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION"):
        for item in file.references(number)[1:-1]:
            product_of[item] = file.name(number)
    color_of = {}
    for number in file.of("STYLED_ITEM"):
        style, item = file.references(number)
        curve = file.references(style)[0]
        color_of[item] = file.name(file.references(curve)[1])
    found = read_with_gmsh(sys.argv[2], [float(layer.z_sample) for layer in build.layers])
    kinds = defaultdict(int)
    compared = 0
    layers = {f"layer {layer.index}": layer for layer in build.layers}
    for assignment in file.of("PRESENTATION_LAYER_ASSIGNMENT"):
        layer = layers.pop(file.name(assignment))
        lengths = []
        hatched = np.zeros(materials)
        hatch_count = np.zeros(materials, int)
        for curve_set in file.references(assignment):
            of_layer, material = file.name(curve_set).split(", ", 1)
            is_hatch = material.endswith(", hatch")
            material = material.removesuffix(", hatch")
            assert of_layer == f"layer {layer.index}"
            assert product_of[curve_set] == color_of[curve_set] == material, (curve_set, material)
            index = build.materials.index(material)
            for element in file.references(curve_set):
                if is_hatch:
                    lengths.append(length(curve_points(file, element)))
                    hatched[index] += lengths[-1]
                    hatch_count[index] += 1
                    continue
                check_loop(file, element)
                for curve in curves_of(file, element):
                    points = curve_points(file, curve)
                    assert np.all(np.abs(points[:, 2] - layer.z_sample) < 2e-6)
                    lengths.append(length(points))
                    kinds[kind_of(file.entities[curve])] += 1
        by_build, count = hatch_lengths(layer, materials)
        assert np.array_equal(count, hatch_count) and np.all(np.abs(hatched - by_build) < 2e-6 * (count + 1))
        by_gmsh = found.pop(float(layer.z_sample))
        assert len(by_gmsh) == len(lengths), (layer.index, len(by_gmsh), len(lengths))
        # Sampled arcs are short by 1e-7 of their length.
        assert np.all(np.abs(np.sort(by_gmsh) - np.sort(lengths)) <= 2e-6 * (1.0 + np.sort(lengths))), layer.index
        compared += len(lengths)
    assert not found and all(not layer.loops for layer in layers.values())
    assert compared > 0 and hatch_count is not None
    print(compared, "curves", dict(kinds))


main()
