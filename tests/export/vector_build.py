"""A build as a judge of vector formats sees it: read with h5py and ElementTree, nothing of Lamella's own."""

import os
import xml.etree.ElementTree as ET

import h5py
import numpy as np

NAMESPACE = "{urn:lamella:build:1}"
GRID = 2.0 ** -20  # mm, what corners of material contours are rounded to


class Layer:
    def __init__(self, group):
        self.index = int(group.attrs["index"])
        self.z_bottom = float(group.attrs["z_bottom"])
        self.z_sample = float(group.attrs["z_sample"])
        self.z_top = float(group.attrs["z_top"])
        self.raster = Rows(group["raster"])
        self.hatch = Rows(group["hatch"]) if "hatch" in group else None
        self.loops = read_loops(group["contours"]) if "contours" in group else None


class Rows:
    def __init__(self, group):
        self.start = group["row_start"][:].astype(int)
        self.x0 = group["x_begin"][:]
        self.x1 = group["x_end"][:]
        self.material = group["material"][:].astype(int)
        self.solid = group["solid"][:].astype(int)
        self.angle = float(group.attrs.get("angle", 0.0))
        self.spacing = float(group.attrs.get("spacing", 0.0))
        self.first_row = int(group.attrs.get("first_row", 0))

    def __len__(self):
        return len(self.start) - 1


def read_loops(group):
    start = group["point_start"][:].astype(int)
    points = np.stack([group["x"][:], group["y"][:]], axis=1)
    return [(int(solid), int(parent), float(area), points[start[i]:start[i + 1]])
            for i, (solid, parent, area) in enumerate(zip(group["solid"][:], group["parent"][:], group["area"][:]))]


class Build:
    def __init__(self, folder):
        root = ET.parse(os.path.join(folder, "build.xml")).getroot()
        self.materials = [m.get("name") for m in root.iter(NAMESPACE + "material")]
        self.densities = [float(m.get("density", "nan")) for m in root.iter(NAMESPACE + "material")]
        self.colors = [[float(m.get(c)) for c in ("red", "green", "blue")] for m in root.iter(NAMESPACE + "material")]
        self.solids = [(s.get("path"), int(s.get("material"))) for s in root.iter(NAMESPACE + "solid")]
        grid = next(root.iter(NAMESPACE + "grid"))
        self.origin = np.array([float(grid.get("origin_" + a)) for a in "xyz"])
        self.pitch = np.array([float(grid.get("pitch_" + a)) for a in "xyz"])
        self.size = [int(grid.get("size_" + a)) for a in "xyz"]
        contours = next(root.iter(NAMESPACE + "contours"), None)
        self.chord_error = float(contours.get("chord_error")) if contours is not None else None
        with h5py.File(os.path.join(folder, "layers.h5"), "r") as layers:
            self.layers = [Layer(layers[name]) for name in sorted(layers) if name.startswith("layer_")]

    def used_materials(self):
        return sorted({material for _, material in self.solids})

    def row_volumes(self):
        """Of each material, by the raster rows: mm^3."""
        volumes = np.zeros(len(self.materials))
        for layer in self.layers:
            lengths = np.bincount(layer.raster.material, layer.raster.x1 - layer.raster.x0, len(self.materials))
            volumes += lengths * self.pitch[1] * (layer.z_top - layer.z_bottom)
        return volumes


def area(polygon):
    x, y = polygon[:, 0], polygon[:, 1]
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def edges(polygons):
    """Begins and ends of all sides."""
    if not polygons:
        return np.zeros((0, 2)), np.zeros((0, 2))
    return np.concatenate(polygons), np.concatenate([np.roll(p, -1, axis=0) for p in polygons])


def crossings(polygons, y):
    """Where the sides cross the line at height y, ascending; half-open, so that every row closes."""
    a, b = edges(polygons)
    crossed = (a[:, 1] <= y) != (b[:, 1] <= y)
    a, b = a[crossed], b[crossed]
    return np.sort(a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))


def distance(polygons, point):
    """From the nearest side."""
    a, b = edges(polygons)
    if len(a) == 0:
        return np.inf
    along = b - a
    t = np.clip(np.sum((point - a) * along, axis=1) / np.maximum(np.sum(along * along, axis=1), 1e-300), 0.0, 1.0)
    return float(np.min(np.linalg.norm(a + t[:, None] * along - point, axis=1)))


def voxels_of_polygons(build, polygons, row):
    """Which pixels of a row have their centre inside, by parity."""
    centres = build.origin[0] + (np.arange(build.size[0]) + 0.5) * build.pitch[0]
    y = build.origin[1] + (row + 0.5) * build.pitch[1]
    return np.searchsorted(crossings(polygons, y), centres, side="right") % 2 == 1


def voxels_of_rows(build, rows, row, material):
    centres = build.origin[0] + (np.arange(build.size[0]) + 0.5) * build.pitch[0]
    inside = np.zeros(build.size[0], bool)
    for i in range(rows.start[row], rows.start[row + 1]):
        if rows.material[i] == material:
            inside |= (rows.x0[i] <= centres) & (centres < rows.x1[i])
    return inside


def compare_voxels(build, layer, polygons_of, slack):
    """Every voxel has the material that the rows give it, but for those whose centre lies within `slack` of a side of
    any polygon. Returns how many were compared and how many of them excused."""
    compared = excused = 0
    everything = [polygon for polygons in polygons_of.values() for polygon in polygons]
    for row in range(build.size[1]):
        y = build.origin[1] + (row + 0.5) * build.pitch[1]
        for material in range(len(build.materials)):
            by_polygons = voxels_of_polygons(build, polygons_of.get(material, []), row)
            by_rows = voxels_of_rows(build, layer.raster, row, material)
            compared += build.size[0]
            for i in np.nonzero(by_polygons != by_rows)[0]:
                point = np.array([build.origin[0] + (i + 0.5) * build.pitch[0], y])
                off = distance(everything, point)
                assert off <= slack, f"layer {layer.index}, row {row}, pixel {i}, material {material}: " \
                                     f"{by_polygons[i]} by contours, {off} mm inside"
                excused += 1
    return compared, excused


def compare_areas(build, layer, polygons_of):
    """The rows' areas are midpoint sums of the contours': off by half a pitch times the width's variation at most."""
    for material in range(len(build.materials)):
        polygons = polygons_of.get(material, [])
        a, b = edges(polygons)
        bound = 0.5 * build.pitch[1] * float(np.sum(np.abs(b[:, 0] - a[:, 0])))
        length = float(np.sum(np.linalg.norm(b - a, axis=1)))
        # Rows know nothing of chords; both sides of an edge between materials may be off.
        bound += 2.0 * build.chord_error * (length + 1.0)
        rows = layer.raster
        by_rows = float(np.sum((rows.x1 - rows.x0)[rows.material == material])) * build.pitch[1]
        by_contours = sum(area(polygon) for polygon in polygons)
        assert abs(by_rows - by_contours) <= bound, f"layer {layer.index}, material {material}: {by_contours} mm^2 " \
                                                     f"by contours, {by_rows} by rows, bound {bound}"


def tracks(build, layer, rows=None):
    """Ends of all runs of one material on the hatch rows, or the raster rows: material -> array of x0,y0,x1,y1."""
    rows = rows or layer.hatch or layer.raster
    is_hatch = rows is layer.hatch
    c, s = np.cos(rows.angle), np.sin(rows.angle)
    found = {}
    for r in range(len(rows)):
        runs = []
        for i in range(rows.start[r], rows.start[r + 1]):
            if runs and runs[-1][0] == rows.material[i] and runs[-1][2] == rows.x0[i]:
                runs[-1][2] = rows.x1[i]
            else:
                runs.append([rows.material[i], rows.x0[i], rows.x1[i]])
        across = (rows.first_row + r + 0.5) * rows.spacing if is_hatch \
            else build.origin[1] + (r + 0.5) * build.pitch[1]
        for material, x0, x1 in runs:
            found.setdefault(int(material), []).append(
                [x0 * c - across * s, x0 * s + across * c, x1 * c - across * s, x1 * s + across * c])
    return {material: np.array(runs) for material, runs in found.items()}
