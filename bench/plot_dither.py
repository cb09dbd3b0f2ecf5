#!/usr/bin/python3
"""Spectra of the patterns that dither_patterns wrote: a table of low frequencies, and pictures."""

import argparse
import pathlib

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

SIDE = 128  # voxels
PITCH = (0.042, 0.084, 0.027)  # mm; x, y, z
PERCENTS = (50, 25, 10)
METHODS = {"mask": "mask", "diffusion": "error diffusion in layers", "diffusion3": "error diffusion in space",
           "white": "white noise"}
# Frequencies below it, per mm, are what an eye at 250 mm sees of a pattern: 10 cycles a degree are 2.3 per mm.
LOW = 2.3


def read(folder, method, percent):
    """Voxels by z, y, x."""
    data = numpy.fromfile(folder / f"{method}_{percent}.raw", dtype=numpy.uint8)
    return data.reshape(SIDE, SIDE, SIDE).astype(float)


def frequencies(axes):
    """Length of the wave vectors of a transform over these axes, per mm, in the order of its array."""
    waves = numpy.meshgrid(*(numpy.fft.fftfreq(SIDE, PITCH[axis]) for axis in reversed(axes)), indexing="ij")
    return numpy.sqrt(sum(w * w for w in waves))


def window(dimensions):
    """Hann's window, of mean square 1: not all patterns repeat, and a cut would leak into the low frequencies."""
    one = numpy.hanning(SIDE + 1)[:-1]
    out = one
    for _ in range(dimensions - 1):
        out = numpy.multiply.outer(out, one)
    return out / numpy.sqrt((out * out).mean())


def power(field, fraction):
    """Power spectrum over that of voxels drawn without order, 1 at all frequencies."""
    hann = window(field.ndim)
    # The mean under the window, or its side lobes would count as low frequencies.
    field = field - (field * hann).sum() / hann.sum()
    return numpy.abs(numpy.fft.fftn(field * hann)) ** 2 / field.size / (fraction * (1 - fraction))


def spectrum_of_layers(voxels, fraction):
    return numpy.mean([power(layer, fraction) for layer in voxels[::4]], axis=0)


def low_mean(spectrum, lengths):
    """Mean power of the frequencies up to LOW. The window spreads the mean over two steps on each side: left out."""
    index = numpy.meshgrid(*(numpy.abs(numpy.fft.fftfreq(SIDE) * SIDE) for _ in range(spectrum.ndim)), indexing="ij")
    return spectrum[(lengths <= LOW) & (numpy.max(index, axis=0) > 1)].mean()


def radial(spectrum, lengths, bins):
    """Mean power by frequency, none where a bin is empty."""
    index = numpy.digitize(lengths.ravel(), bins)
    counts = numpy.bincount(index, minlength=len(bins) + 1)[1:-1]
    sums = numpy.bincount(index, spectrum.ravel(), len(bins) + 1)[1:-1]
    return numpy.where(counts > 0, sums / numpy.maximum(counts, 1), numpy.nan)


def draw_radial(axis, spectra, lengths, title):
    bins = numpy.linspace(0.35, 14.0, 60)
    for method, spectrum in spectra.items():
        axis.plot((bins[1:] + bins[:-1]) / 2, radial(spectrum, lengths, bins), label=METHODS[method])
    axis.axvspan(0, LOW, color="0.92")
    axis.set(title=title, yscale="log", ylim=(3e-3, 20), xlim=(0, 14))
    axis.grid(alpha=0.3)


def draw_spectra(folder, out):
    plane, space = frequencies((0, 1)), frequencies((0, 1, 2))
    figure, axes = plt.subplots(2, 3, figsize=(13, 7.5), sharex=True, sharey=True)
    print("| fraction | where | " + " | ".join(METHODS.values()) + " |")
    print("|---|---|" + "---|" * len(METHODS))
    for column, percent in enumerate(PERCENTS):
        fraction = percent / 100
        fields = {method: read(folder, method, percent) for method in METHODS}
        rows = {"layers": ({m: spectrum_of_layers(f, fraction) for m, f in fields.items()}, plane),
                "space": ({m: power(f, fraction) for m, f in fields.items()}, space)}
        for axis, (name, (spectra, lengths)) in zip(axes[:, column], rows.items()):
            draw_radial(axis, spectra, lengths, f"{name}, {percent} %")
            cells = " | ".join(f"{low_mean(spectra[m], lengths):.4f}" for m in METHODS)
            print(f"| {fraction} | {name} | {cells} |")
    for axis in axes[1]:
        axis.set_xlabel("frequency, 1/mm")
    for axis in axes[:, 0]:
        axis.set_ylabel("power, white noise = 1")
    axes[0, 0].legend(fontsize=8, loc="lower right")
    figure.tight_layout()
    figure.savefig(out / "spectra.png", dpi=90)


def draw_sections(folder, out):
    """An xy and an xz section of each method at 1/4, 2 mm wide, to scale."""
    figure, axes = plt.subplots(2, len(METHODS), figsize=(13, 6.2))
    for column, method in enumerate(METHODS):
        voxels = read(folder, method, 25)
        for row, (section, height) in enumerate(((voxels[40], PITCH[1]), (voxels[:, 40], PITCH[2]))):
            kept = section[: int(2.0 / height), : int(2.0 / PITCH[0])]
            axes[row, column].imshow(kept, cmap="gray_r", aspect=height / PITCH[0], interpolation="nearest",
                                     origin="lower")
            axes[row, column].set(xticks=[], yticks=[])
        axes[0, column].set_title(METHODS[method])
    axes[0, 0].set_ylabel("layer (xy)")
    axes[1, 0].set_ylabel("section (xz)")
    figure.tight_layout()
    figure.savefig(out / "sections.png", dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path, help="where dither_patterns wrote")
    parser.add_argument("out", type=pathlib.Path, help="folder for the pictures")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    draw_spectra(arguments.folder, arguments.out)
    draw_sections(arguments.folder, arguments.out)


if __name__ == "__main__":
    main()
