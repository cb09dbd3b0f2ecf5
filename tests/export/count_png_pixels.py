"""Prints how many pixels of each value the pictures of a folder hold, as Pillow reads them: lines `value count`."""

import pathlib
import sys

import numpy
from PIL import Image

counts = numpy.zeros(256, dtype=numpy.int64)
for picture in sorted(pathlib.Path(sys.argv[1]).glob("layer_*.png")):
    pixels = numpy.asarray(Image.open(picture)).astype(numpy.uint8)
    counts += numpy.bincount(pixels.ravel(), minlength=256)
for value in numpy.flatnonzero(counts):
    print(value, counts[value])
