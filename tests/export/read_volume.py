"""Describes a volume of labels as other programs read it, for volume_test.cpp.

    read_volume.py FILE LABELS

prints `size`, `pitch` and `origin` (of the lower corner) along x, y, z, the `rotation` if there is one and the `name` of each label, and writes the labels as 16-bit
numbers, x fastest, to LABELS. TIFF is read with tifffile, NRRD with teem; MetaImage and VTK image data, whose readers are heavy
(read_volume_paraview.py), by their definition.
"""

import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree as tree
import zlib

import numpy

path = pathlib.Path(sys.argv[1])


def show(item, values):
    print(item, *values)


def show_rotation(found):
    """The nine numbers by rows, if the file has them."""
    assert len(found) <= 1, found
    for text in found:
        show("rotation", text.split())


def read_tiff():
    import tifffile

    with tifffile.TiffFile(path) as file:
        about = file.imagej_metadata
        assert about["images"] == about["slices"] == len(file.pages) and about["unit"] == "mm", about
        page = file.pages[0]
        per_mm = [page.tags[tag].value for tag in ("XResolution", "YResolution")]
        assert all(p.shape == page.shape and p.dtype == page.dtype for p in file.pages)
        assert file.is_bigtiff == ("big" in path.name)
        labels = numpy.stack([p.asarray() for p in file.pages])
        show("pitch", [per_mm[0][1] / per_mm[0][0], per_mm[1][1] / per_mm[1][0], about["spacing"]])
        origin = [float(value) for value in str(about["origin_mm"]).split()]
        show_rotation([str(about[key]) for key in about if key == "rotation"])
        names = [about[f"material_{label}"] for label in range(1, 1 + sum(k.startswith("material_") for k in about))]
    return labels, origin, names


def read_nrrd():
    head = subprocess.run(["teem-unu", "head", path], check=True, capture_output=True, text=True).stdout
    assert "space: left-posterior-superior" in head, head
    pitch = [float(v) for v in re.findall(r"[^,() ]+", head.split("space directions:")[1].split("\n")[0])][::4]
    centre = [float(v) for v in re.findall(r"[^,() ]+", head.split("space origin:")[1].split("\n")[0])]
    raw = subprocess.run(["teem-unu", "save", "-f", "nrrd", "-e", "raw", "-i", path], check=True, capture_output=True)
    text, data = raw.stdout.split(b"\n\n", 1)
    sizes = [int(v) for v in re.search(rb"sizes: (.*)", text)[1].split()]
    kind = numpy.uint8 if b"type: unsigned char" in text else numpy.uint16
    show("pitch", pitch)
    show_rotation(re.findall(r"^rotation:=(.*)$", head, re.MULTILINE))
    names = re.findall(r"Segment\d+_Name:=(.*)", head)
    assert re.findall(r"Segment\d+_LabelValue:=(.*)", head) == [str(1 + n) for n in range(len(names))]
    return numpy.frombuffer(data, kind).reshape(sizes[::-1]), [c - p / 2 for c, p in zip(centre, pitch)], names


def read_mhd():
    lines = [line.split(" = ", 1) for line in path.read_text().splitlines()]
    head = dict(lines)
    # The data's name ends a header; what is unknown to a reader of the format's family is skipped by lines of 500 bytes.
    assert lines[-1][0] == "ElementDataFile" and all(len(" = ".join(line).encode()) < 500 for line in lines)
    names = [head[f"Material{label}"] for label in range(1, 1 + sum(k.startswith("Material") for k in head))]
    show_rotation([head["Rotation"]] if "Rotation" in head else [])
    data = (path.parent / head["ElementDataFile"]).read_bytes()
    if head["CompressedData"] == "True":
        assert int(head["CompressedDataSize"]) == len(data)
        data = zlib.decompress(data)
    pitch = [float(v) for v in head["ElementSpacing"].split()]
    show("pitch", pitch)
    kind = {"MET_UCHAR": numpy.uint8, "MET_USHORT": numpy.uint16}[head["ElementType"]]
    labels = numpy.frombuffer(data, kind).reshape([int(v) for v in head["DimSize"].split()][::-1])
    return labels, [float(c) - p / 2 for c, p in zip(head["Offset"].split(), pitch)], names


def read_vti():
    text, data = path.read_bytes().split(b'<AppendedData encoding="raw">', 1)
    root = tree.fromstring(text + b"</VTKFile>")
    image = root.find("ImageData")
    array = image.find("Piece/CellData/DataArray")
    kind = {"UInt8": numpy.uint8, "UInt16": numpy.uint16}[array.get("type")]
    extent = [int(v) for v in image.get("WholeExtent").split()]
    data = data[data.index(b"_") + 1 + int(array.get("offset")):]
    words = numpy.frombuffer(data[: len(data) // 8 * 8], numpy.uint64)
    if root.get("compressor"):
        count, block, rest = (int(w) for w in words[:3])
        ends = numpy.cumsum(words[3 : 3 + count]) + numpy.uint64(8 * (3 + count))
        starts = numpy.concatenate([[8 * (3 + count)], ends[:-1]])
        blocks = [zlib.decompress(data[int(a) : int(b)]) for a, b in zip(starts, ends)]
        assert rest == 0 and all(len(b) == block for b in blocks)
        data = b"".join(blocks)
    else:
        data = data[8 : 8 + int(words[0])]
    show("pitch", [float(v) for v in image.get("Spacing").split()])
    show_rotation([a.text for a in image.findall("FieldData/DataArray") if a.get("Name") == "rotation"])
    codes = bytes(int(v) for v in image.find("FieldData/Array").text.split())
    names = codes.decode().split("\0")[1:-1]
    return numpy.frombuffer(data, kind).reshape(extent[5], extent[3], extent[1]), image.get("Origin").split(), names


labels, origin, names = {".tif": read_tiff, ".nrrd": read_nrrd, ".mhd": read_mhd, ".vti": read_vti}[path.suffix]()
show("origin", origin)
show("size", labels.shape[::-1])
show("type", [labels.dtype])
for label, name in enumerate(names, 1):
    print(f"name{label}", name)
labels.astype("<u2").tofile(sys.argv[2])
