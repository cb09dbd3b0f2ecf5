"""Damages layer 0 of a build in one way and mends its checksums: damage_store.py BUILD KIND.

The layer's digest is computed as docs/formats/store.md states it, so this is also an independent check of that page.
"""

import hashlib
import re
import struct
import sys

import h5py
import numpy as np

ARRAYS = ("row_start", "x_begin", "x_end", "material", "solid")


def replace(rows, name, data, **options):
    del rows[name]
    rows.create_dataset(name, data=data, **options)


def damage(file, kind):
    layer = file["layer_000000"]
    rows = layer["raster"]
    values = {name: rows[name][:] for name in ARRAYS}
    if kind == "nan":
        values["x_end"][3] = np.nan
    elif kind == "infinite":
        values["x_end"][int(values["row_start"][1]) - 1] = np.inf
    elif kind == "reversed":
        values["x_begin"][3], values["x_end"][3] = values["x_end"][3], values["x_begin"][3]
    elif kind == "overlapping":
        values["x_begin"][1] = values["x_begin"][0]
    elif kind == "row_start_falls":
        values["row_start"][5] = values["row_start"][4] - 1
    elif kind == "row_start_ends_elsewhere":
        values["row_start"][-1] += 1000
    elif kind == "material_out_of_range":
        values["material"][-1] = 3
    elif kind == "solid_out_of_range":
        values["solid"][-1] = 0xFFFFFFFF
    elif kind == "wrong_length":
        values["solid"] = values["solid"][:-1]
    elif kind == "wrong_type":
        values["x_begin"] = values["x_begin"].astype("<f4")
    elif kind == "two_dimensions":
        values["x_begin"] = values["x_begin"].reshape(1, -1)
    for name in ARRAYS:
        if not np.array_equal(values[name], rows[name][:]) or values[name].dtype != rows[name].dtype:
            replace(rows, name, values[name])
    count = len(values["x_begin"])
    if kind == "huge_array":
        del rows["x_begin"]
        rows.create_dataset("x_begin", shape=(1 << 40,), dtype="<f8", chunks=(1024,))
    elif kind == "soft_link_cycle":
        del rows["x_begin"]
        rows["x_begin"] = h5py.SoftLink("/layer_000000/raster/x_begin")
    elif kind == "external_link":
        del rows["x_begin"]
        rows["x_begin"] = h5py.ExternalLink("000000.h5", "/layer_000000/raster/x_end")
    elif kind == "virtual_array":
        layout = h5py.VirtualLayout(shape=(count,), dtype="<f8")
        layout[:] = h5py.VirtualSource(".", "/layer_000000/raster/x_end", shape=(count,))
        del rows["x_begin"]
        rows.create_virtual_dataset("x_begin", layout)
    elif kind == "external_data":
        del rows["x_begin"]
        rows.create_dataset("x_begin", shape=(count,), dtype="<f8", external=[("/etc/passwd", 0, 8 * count)])
    elif kind == "missing_array":
        del rows["x_begin"]
    elif kind == "group_for_array":
        del rows["x_begin"]
        rows.create_group("x_begin")
    elif kind == "huge_chunk":
        del rows["x_begin"]
        rows.create_dataset("x_begin", shape=(count,), maxshape=(None,), dtype="<f8", chunks=(1 << 27,))
    return values


def rows_bytes(values):
    segments = np.zeros(len(values["solid"]), dtype="<f8,<f8,<u4,<u4")
    for field, name in zip(segments.dtype.names, ARRAYS[1:]):
        segments[field] = values[name].reshape(-1)[: len(segments)]
    return struct.pack("<Q", len(values["row_start"]) - 1) + values["row_start"].tobytes() + segments.tobytes()


def digest(layer, values):
    height = [layer.attrs[name] for name in ("z_bottom", "z_sample", "z_top")]
    hatch = layer["hatch"]
    text = struct.pack("<I3d", layer.attrs["index"], *height) + rows_bytes(values) + struct.pack("<I", 1)
    text += struct.pack("<2dq", hatch.attrs["angle"], hatch.attrs["spacing"], hatch.attrs["first_row"])
    text += rows_bytes({name: hatch[name][:] for name in ARRAYS})
    return hashlib.sha256(text).hexdigest()


build, kind = sys.argv[1:]
shard = build + "/layers/000000.h5"
with h5py.File(shard, "r+") as file:
    content = digest(file["layer_000000"], damage(file, kind))
if kind == "garbage":
    open(shard, "wb").write(b"\x89HDF\r\n\x1a\n" + bytes(range(256)) * 40)
xml = open(build + "/build.xml", encoding="utf-8").read()
file_digest = hashlib.sha256(open(shard, "rb").read()).hexdigest()
xml = re.sub(r'(layers/000000.h5" sha256=")\w+', r"\g<1>" + file_digest, xml)
xml = re.sub(r'(<layer index="0"[^>]*sha256=")\w+', r"\g<1>" + content, xml)
if kind == "huge_array":
    xml = re.sub(r'(<layer index="0"[^>]* segments=")\w+', r"\g<1>" + str(1 << 40), xml)
open(build + "/build.xml", "w", encoding="utf-8").write(xml)
