"""A decoder of CLI 2.0 files, both forms, written from the format's text and from nothing of the exporter's."""

import struct

import numpy as np


class CliError(Exception):
    pass


class Layer:
    def __init__(self, z):
        self.z = z
        self.polylines = []  # label, direction, points
        self.hatches = []  # label, begins and ends


class CliFile:
    def __init__(self, path):
        with open(path, "rb") as stream:
            data = stream.read()
        if not data.startswith(b"$$HEADERSTART\n"):
            raise CliError("no $$HEADERSTART at the beginning")
        end = data.find(b"$$HEADEREND")
        if end < 0:
            raise CliError("no $$HEADEREND")
        self.read_header(data[:end].decode("ascii"))
        body = data[end + len(b"$$HEADEREND"):]
        self.layers = []
        if self.is_binary:
            self.read_binary(body)
        else:
            self.read_ascii(body.decode("ascii"))
        heights = [layer.z for layer in self.layers]
        if heights != sorted(heights) or len(set(heights)) != len(heights):
            raise CliError("layers don't ascend")

    def read_header(self, text):
        self.labels, self.dimension, self.layer_count = {}, None, None
        self.is_binary = self.units = self.version = None
        for line in text.split("\n")[1:]:
            word, _, rest = line.partition("/")
            if word == "$$ASCII":
                self.is_binary = False
            elif word == "$$BINARY":
                self.is_binary = True
            elif word == "$$UNITS":
                self.units = float(rest)
            elif word == "$$VERSION":
                self.version = int(rest)
            elif word == "$$LABEL":
                number, _, name = rest.partition(",")
                if not (name.startswith('"') and name.endswith('"')):
                    raise CliError("a label without quotes")
                self.labels[int(number)] = name[1:-1]
            elif word == "$$DIMENSION":
                self.dimension = [float(v) for v in rest.split(",")]
            elif word == "$$LAYERS":
                self.layer_count = int(rest)
            elif line:
                raise CliError(f"unknown header line {line!r}")
        if self.is_binary is None or self.units is None or self.version != 200:
            raise CliError("the header lacks its form, its units or its version")

    def layer(self):
        if not self.layers:
            raise CliError("geometry before the first layer")
        return self.layers[-1]

    def add_polyline(self, label, direction, points):
        if label not in self.labels or direction not in (0, 1, 2):
            raise CliError("a polyline of unknown label or direction")
        if direction != 2 and not np.array_equal(points[0], points[-1]):
            raise CliError("a closed polyline that doesn't close")
        self.layer().polylines.append((label, direction, points * self.units))

    def add_hatches(self, label, ends):
        if label not in self.labels:
            raise CliError("hatches of unknown label")
        self.layer().hatches.append((label, ends * self.units))

    def read_ascii(self, text):
        lines = text.split("\n")
        if lines[:2] != ["", "$$GEOMETRYSTART"] or lines[-2:] != ["$$GEOMETRYEND", ""]:
            raise CliError("geometry doesn't begin and end as it should")
        for line in lines[2:-2]:
            word, _, rest = line.partition("/")
            values = rest.split(",")
            if word == "$$LAYER":
                self.layers.append(Layer(self.real(values[0]) * self.units))
            elif word == "$$POLYLINE":
                points = np.array([self.real(v) for v in values[3:]]).reshape(-1, 2)
                if len(points) != int(values[2]):
                    raise CliError("a polyline with another number of points than stated")
                self.add_polyline(int(values[0]), int(values[1]), points)
            elif word == "$$HATCHES":
                ends = np.array([self.real(v) for v in values[2:]]).reshape(-1, 4)
                if len(ends) != int(values[1]):
                    raise CliError("another number of hatches than stated")
                self.add_hatches(int(values[0]), ends)
            else:
                raise CliError(f"unknown command {word!r}")

    @staticmethod
    def real(text):
        if "." not in text:
            raise CliError(f"{text!r} is no REAL: it has no decimal point")
        return float(text)

    def read_binary(self, body):
        at = 0

        def take(form):
            nonlocal at
            size = struct.calcsize("<" + form)
            if at + size > len(body):
                raise CliError("the file ends within a command")
            values = struct.unpack_from("<" + form, body, at)
            at += size
            return values

        def floats(count):
            nonlocal at
            if at + 4 * count > len(body):
                raise CliError("the file ends within a command")
            values = np.frombuffer(body, "<f4", count, at).astype(float)
            at += 4 * count
            return values

        def shorts(count):
            return np.array(take(f"{count}H"), float)

        while at < len(body):
            (command,) = take("H")
            if command == 127:
                self.layers.append(Layer(take("f")[0] * self.units))
            elif command == 128:
                self.layers.append(Layer(take("H")[0] * self.units))
            elif command == 129:
                label, direction, count = take("HHH")
                self.add_polyline(label, direction, shorts(2 * count).reshape(-1, 2))
            elif command == 130:
                label, direction, count = take("iii")
                self.add_polyline(label, direction, floats(2 * count).reshape(-1, 2))
            elif command == 131:
                label, count = take("HH")
                self.add_hatches(label, shorts(4 * count).reshape(-1, 4))
            elif command == 132:
                label, count = take("ii")
                self.add_hatches(label, floats(4 * count).reshape(-1, 4))
            else:
                raise CliError(f"unknown command {command}")
