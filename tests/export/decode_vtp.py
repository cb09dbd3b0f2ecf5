"""A decoder of VTK XML PolyData files of lines and their .pvd series, written from VTK's file format page."""

import base64
import struct
import xml.etree.ElementTree as ET
import zlib

import numpy as np

TYPES = {"Int32": "<i4", "Int64": "<i8", "UInt8": "u1", "Float64": "<f8"}


def decode(text):
    """Blocks of zlib behind a header of 64-bit numbers, each of the two base64 of its own."""
    text = "".join(text.split())
    count = struct.unpack("<Q", base64.b64decode(text[:12])[:8])[0]
    header_bytes = 8 * (3 + count)
    header_text = 4 * ((header_bytes + 2) // 3)
    header = struct.unpack(f"<{3 + count}Q", base64.b64decode(text[:header_text]))
    data = base64.b64decode(text[header_text:])
    blocks, at = [], 0
    for i, size in enumerate(header[3:]):
        block = zlib.decompress(data[at:at + size])
        is_last = i == count - 1
        assert len(block) == (header[2] if is_last and header[2] else header[1]), "a block of another size than stated"
        blocks.append(block)
        at += size
    assert at == len(data), "bytes behind the blocks"
    return b"".join(blocks)


def array(element):
    values = np.frombuffer(decode(element.text or ""), TYPES[element.get("type")])
    components = int(element.get("NumberOfComponents", "1"))
    return values.reshape(-1, components) if components > 1 else values


def names(element):
    codes = bytes(int(c) for c in (element.text or "").split())
    found = codes.split(b"\0")[:-1]
    assert len(found) == int(element.get("NumberOfTuples"))
    return [n.decode() for n in found]


class Lines:
    def __init__(self, path):
        root = ET.parse(path).getroot()
        assert root.get("type") == "PolyData" and root.get("byte_order") == "LittleEndian"
        assert root.get("header_type") == "UInt64" and root.get("compressor") == "vtkZLibDataCompressor"
        arrays = {a.get("Name"): a for a in root.iter("DataArray")}
        self.materials = names(arrays["material_names"])
        self.solids = names(arrays["solid_paths"])
        piece = next(root.iter("Piece"))
        self.points = array(arrays["points"])
        connectivity = array(arrays["connectivity"])
        ends = array(arrays["offsets"])
        self.material, self.solid, self.kind = (array(arrays[n]) for n in ("material", "solid", "kind"))
        assert int(piece.get("NumberOfPoints")) == len(self.points)
        assert int(piece.get("NumberOfLines")) == len(ends) == len(self.material) == len(self.solid) == len(self.kind)
        starts = np.concatenate([[0], ends[:-1]]) if len(ends) else ends
        self.lines = [connectivity[a:b] for a, b in zip(starts, ends)]
        assert len(ends) == 0 or ends[-1] == len(connectivity)


def series(path):
    """Files with their times."""
    root = ET.parse(path).getroot()
    assert root.get("type") == "Collection"
    return [(float(d.get("timestep")), d.get("file")) for d in root.iter("DataSet")]
