"""Reads G-code with printrun's reader: layers, tool changes, length of tracks by tool, extents. One JSON object."""
import collections
import json
import math
import sys

from printrun import gcoder

with open(sys.argv[1]) as stream:
    code = gcoder.GCode(stream)
length = collections.Counter()
tools = []
heights = set()
box = [math.inf, -math.inf, math.inf, -math.inf]
at = (0.0, 0.0)
for layer in code.all_layers:
    for line in layer:
        if line.command and line.command[0] == "T":
            tools.append(int(line.command[1:]))
        if not line.is_move:
            continue
        to = (line.current_x, line.current_y)
        if line.extruding and to != at:
            length[line.current_tool] += math.dist(at, to)
            heights.add(round(line.current_z, 4))
            for x, y in (at, to):
                box = [min(box[0], x), max(box[1], x), min(box[2], y), max(box[3], y)]
        at = to
print(json.dumps({"layers": len(heights), "changes": len(tools) - 1, "length": length, "box": box}))
