"""A decoder of SLC 2.0 files (3D Systems), written from the format's text and from nothing of the exporter's."""

import re
import struct

import numpy as np


class SlcError(Exception):
    pass


class SlcFile:
    def __init__(self, path):
        with open(path, "rb") as stream:
            data = stream.read()
        end = data.find(b"\r\n\x1a")
        if end < 0 or end > 2048:
            raise SlcError("the header doesn't end within 2048 bytes")
        self.read_header(data[:end].decode("ascii"))
        self.data, self.at = data, end + 3 + 256
        self.table = [self.take("ffff") for _ in range(self.take("B")[0])]
        self.layers = []  # lowest z, boundaries
        while True:
            z, count = self.take("fI")
            if count == 0xFFFFFFFF:
                self.z_max = z
                break
            self.layers.append((z, [self.boundary() for _ in range(count)]))
        if self.at != len(data):
            raise SlcError("bytes behind the end")

    def read_header(self, text):
        words = dict(re.findall(r"-(\w+) ([^-].*?|-.*?)(?= -[A-Z]|\s*$)", text))
        for word in ("SLCVER", "UNIT", "TYPE"):
            if word not in words:
                raise SlcError(f"the header lacks -{word}")
        if words["SLCVER"] != "2.0" or words["UNIT"] != "MM" or words["TYPE"] != "PART":
            raise SlcError(f"unexpected header {words}")
        self.extents = np.array([[float(v) for v in pair.split(",")] for pair in words["EXTENTS"].split()])

    def take(self, form):
        size = struct.calcsize("<" + form)
        if self.at + size > len(self.data):
            raise SlcError("the file ends too early")
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += size
        return values

    def boundary(self):
        vertices, gaps = self.take("II")
        if gaps != 0:
            raise SlcError("a boundary with gaps")
        if vertices < 4 or self.at + 8 * vertices > len(self.data):
            raise SlcError("a boundary of too few or too many points")
        points = np.frombuffer(self.data, "<f4", 2 * vertices, self.at).astype(float).reshape(-1, 2)
        self.at += 8 * vertices
        if not np.array_equal(points[0], points[-1]):
            raise SlcError("a boundary that doesn't close")
        return points[:-1]
