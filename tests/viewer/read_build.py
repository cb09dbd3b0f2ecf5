"""What pages are compared with, read from builds and pictures without Lamella: by h5py and PIL.

read_build.py pictures FOLDER OUT     all PNGs as RGBA, one after the other from the top row; prints [count, height, width]
read_build.py segments BUILD LAYER    prints the rows of a layer as [[begin, end, material, solid], ...]
read_build.py hatch BUILD LAYER       prints the hatch segments of a layer as [[x0, y0, x1, y1, material], ...], mm
read_build.py mixed BUILD LAYER OUT   colours of the pixels of a layer, mixtures blended, as RGBA from the top row
read_build.py areas BUILD             prints the area of each material on each layer, mm^2
"""
import json
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import numpy
from PIL import Image

SPACE = "{urn:lamella:build:1}"


def pictures(folder, out):
    images = [numpy.array(Image.open(path).convert("RGBA")) for path in sorted(pathlib.Path(folder).glob("*.png"))]
    pathlib.Path(out).write_bytes(b"".join(image.tobytes() for image in images))
    print(json.dumps([len(images), *images[0].shape[:2]]))


def raster(build, layer):
    group = h5py.File(pathlib.Path(build) / "layers.h5")[f"layer_{layer:06d}/raster"]
    return {name: group[name][:] for name in group}


def rows_of(data):
    start = data["row_start"]
    for row in range(len(start) - 1):
        yield [int(i) for i in range(start[row], start[row + 1])]


def segments(build, layer):
    data = raster(build, int(layer))
    columns = [data[name].tolist() for name in ("x_begin", "x_end", "material", "solid")]
    print(json.dumps([[[column[i] for column in columns] for i in row] for row in rows_of(data)]))


def hatch(build, layer):
    group = h5py.File(pathlib.Path(build) / "layers.h5")[f"layer_{int(layer):06d}/hatch"]
    angle, spacing, first = (group.attrs[name] for name in ("angle", "spacing", "first_row"))
    data = {name: group[name][:] for name in group}
    along = numpy.array([numpy.cos(angle), numpy.sin(angle)])
    across = numpy.array([-along[1], along[0]])
    lines = []
    for row, numbers in enumerate(rows_of(data)):
        foot = (first + row + 0.5) * spacing * across
        for i in numbers:
            a, b = (data[name][i] * along + foot for name in ("x_begin", "x_end"))
            lines.append([*a.tolist(), *b.tolist(), int(data["material"][i])])
    print(json.dumps(lines))


class Header:
    def __init__(self, build):
        root = ElementTree.parse(pathlib.Path(build) / "build.xml").getroot()
        self.materials = root.findall(f"{SPACE}materials/{SPACE}material")
        self.colors = [[255 * float(m.get(name)) for name in ("red", "green", "blue")] for m in self.materials]
        self.components = [[int(c.get("id")) for c in m.findall(f"{SPACE}component")] for m in self.materials]
        self.layers = len(root.findall(f"{SPACE}layers/{SPACE}shard/{SPACE}layer"))
        grid = root.find(f"{SPACE}plan/{SPACE}grid")
        self.grid = {key: float(value) for key, value in grid.attrib.items()}


def fractions_at(data, graded, count, x):
    first, last = int(data["knot_start"][graded]), int(data["knot_start"][graded + 1])
    knots = data["knot_x"][first:last]
    at = int(data["fraction_start"][graded])
    values = data["fraction"][at:at + len(knots) * count].reshape(len(knots), count)
    return numpy.stack([numpy.interp(x, knots, values[:, c]) for c in range(count)], axis=-1)


def mixed(build, layer, out):
    header = Header(build)
    data = raster(build, int(layer))
    width, height = int(header.grid["size_x"]), int(header.grid["size_y"])
    centres = header.grid["origin_x"] + (numpy.arange(width) + 0.5) * header.grid["pitch_x"]
    picture = numpy.zeros((height, width, 4))
    graded = {int(number): g for g, number in enumerate(data.get("graded_segment", []))}
    for row, numbers in enumerate(rows_of(data)):
        for i in numbers:
            inside = (centres >= data["x_begin"][i]) & (centres < data["x_end"][i])
            material = data["material"][i]
            color = numpy.round(header.colors[material])
            if i in graded:
                parts = header.components[material]
                mix = fractions_at(data, graded[i], len(parts), centres[inside])
                color = mix @ numpy.round([header.colors[part] for part in parts])
            picture[height - 1 - row, inside, :3] = color
            picture[height - 1 - row, inside, 3] = 255
    pathlib.Path(out).write_bytes(numpy.round(picture).astype("uint8").tobytes())
    print(json.dumps([1, height, width]))


def areas(build):
    header = Header(build)
    table = numpy.zeros((len(header.materials), header.layers))
    for layer in range(header.layers):
        data = raster(build, layer)
        numpy.add.at(table[:, layer], data["material"], (data["x_end"] - data["x_begin"]) * header.grid["pitch_y"])
    print(json.dumps(table.tolist()))


if __name__ == "__main__":
    {"pictures": pictures, "segments": segments, "hatch": hatch, "mixed": mixed, "areas": areas}[sys.argv[1]](*sys.argv[2:])
