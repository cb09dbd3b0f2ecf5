#!/usr/bin/env python3
"""Draws one layer of XML slices (--xml-payload text) as the paper's figures 6 to 8 do: raster lines, entry and exit points.

    draw.py SLICES.xml LAYER LINES.svg POINTS.svg

Lines in the colours of their materials; entries green, exits red. mm, y up.
"""
import sys
import xml.etree.ElementTree as ET

NAMESPACE = "{urn:lamella:slices:1}"
SCALE = 6.0  # pixels per mm


def numbers(element, name, kind=float):
    return [kind(word) for word in (element.findtext(NAMESPACE + name) or "").split()]


def read(path, layer_index):
    root = ET.parse(path).getroot()
    header = root.find(NAMESPACE + "header")
    colors = []
    for material in header.find(NAMESPACE + "materials"):
        parts = [round(255 * float(part)) for part in material.get("color").split()]
        colors.append("#%02x%02x%02x" % tuple(parts))
    grid = header.find(NAMESPACE + "grid")
    origin, pitch, size = ([float(word) for word in grid.get(key).split()] for key in ("origin", "pitch", "size"))
    layer = [one for one in root.findall(NAMESPACE + "layer") if int(one.get("index")) == layer_index][0]
    runs = []
    for row in layer.find(NAMESPACE + "raster"):
        y = origin[1] + (int(row.get("index")) + 0.5) * pitch[1]
        x = numbers(row, "x")
        for i, material in enumerate(numbers(row, "material", int)):
            runs.append((x[2 * i], x[2 * i + 1], y, colors[material]))
    return runs, origin, [a + p * n for a, p, n in zip(origin, pitch, size)]


def write(path, low, high, body):
    width, height = SCALE * (high[0] - low[0]) + 20, SCALE * (high[1] - low[1]) + 20
    with open(path, "w") as out:
        out.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}">\n')
        out.write('<rect width="100%" height="100%" fill="#fff"/>\n')
        out.write("\n".join(body) + "\n</svg>\n")


def main():
    runs, low, high = read(sys.argv[1], int(sys.argv[2]))
    px = lambda x: f"{10 + SCALE * (x - low[0]):.2f}"
    py = lambda y: f"{10 + SCALE * (high[1] - y):.2f}"
    lines = [f'<line x1="{px(a)}" x2="{px(b)}" y1="{py(y)}" y2="{py(y)}" stroke="{color}" stroke-width="2.2"/>'
             for a, b, y, color in runs]
    points = []
    for a, b, y, _ in runs:
        points.append(f'<circle cx="{px(a)}" cy="{py(y)}" r="2" fill="#1f8a3b"/>')
        points.append(f'<circle cx="{px(b)}" cy="{py(y)}" r="2" fill="#c5281c"/>')
    write(sys.argv[3], low, high, lines)
    write(sys.argv[4], low, high, points)


if __name__ == "__main__":
    main()
