"""Prints an upper layer of a small two-material part as each format has it, one picture per format, largest y at the top.

    orientation.py FOLDER NX NY

Readers: Pillow, tifffile, teem, Python's own XML parser and pyopenvdb. `.` is void, `0` and `1` are the materials.
"""

import pathlib
import subprocess
import sys
import xml.etree.ElementTree as tree

import numpy
import pyopenvdb
from PIL import Image

folder, nx, ny = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
SLICES = "{urn:lamella:slices:1}"


def show(name, rows):
    """`rows` from the top, labels 0 (void), 1, 2."""
    print(name)
    for row in rows:
        print("".join(".01"[int(label)] for label in row))


def png_stacks():
    picture = numpy.zeros((ny, nx), dtype=int)
    for label, material in ((1, "steel"), (2, "marker")):
        picture += label * numpy.asarray(Image.open(f"{folder}/png/{material}/layer_000001.png")).astype(int)
    return picture


def xml_slices():
    root = tree.parse(f"{folder}/slices.xml").getroot()
    grid = root.find(f"{SLICES}header/{SLICES}grid")
    origin, pitch = (float(grid.get(key).split()[0]) for key in ("origin", "pitch"))
    centres = origin + (numpy.arange(nx) + 0.5) * pitch
    picture = numpy.zeros((ny, nx), dtype=int)
    for row in root.findall(f"{SLICES}layer")[1].iter(f"{SLICES}row"):
        x = [float(value) for value in row.find(f"{SLICES}x").text.split()]
        for n, material in enumerate(row.find(f"{SLICES}material").text.split()):
            inside = (x[2 * n] <= centres) & (centres < x[2 * n + 1])
            picture[int(row.get("index")), inside] = 1 + int(material)
    return picture[::-1]  # rows ascend with y


def vdb():
    voxels = numpy.zeros((nx, ny, 2), dtype=numpy.float32)
    pyopenvdb.read(f"{folder}/a.vdb", "material").copyToArray(voxels)
    return voxels[:, :, 1].T[::-1]


def grey_stacks(name):
    picture = numpy.zeros((ny, nx), dtype=int)
    for label, material in ((1, "steel"), (2, "marker")):
        picture += label * (numpy.asarray(Image.open(f"{folder}/{name}/{material}/layer_000001.png")) == 255)
    return picture


def read_by(script, *arguments):
    """The labels that another script of this folder reads, by slice."""
    command = ["/usr/bin/python3", pathlib.Path(__file__).parent / script, *arguments]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def volume(file):
    read_by("read_volume.py", f"{folder}/{file}", f"{folder}/labels")
    return numpy.fromfile(f"{folder}/labels", dtype="<u2").reshape(2, ny, nx)[1, ::-1]


def printer(kind, layer):
    read_by("read_printer_format.py", kind, f"{folder}/{kind}", f"{folder}/labels", "steel", "marker")
    return numpy.fromfile(f"{folder}/labels", dtype=numpy.uint8).reshape(-1, ny, nx)[layer]


show("png", png_stacks())
show("png-indexed", numpy.asarray(Image.open(f"{folder}/indexed/layer_000001.png")))
show("xml", xml_slices())
show("vdb", vdb())
show("grey", grey_stacks("grey"))
show("coverage", grey_stacks("coverage"))
show("polyjet", printer("polyjet", 15))
show("sl1", printer("sl1", 1))
for file in ("a.tif", "a.nrrd", "a.mhd", "a.vti"):
    show(file, volume(file))
