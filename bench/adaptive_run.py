#!/usr/bin/env python3
"""Adaptive layers against uniform ones and against Slic3r's, with deviations measured by OpenCASCADE.

usage: bench/adaptive_run.py BUILD [--deviation MM] [--samples N] [--csv OUT.csv] FILE.step...

BUILD is the folder of a build with tests: bin/lamella plans, bin/measure_deviation measures. Slic3r 1.3 (`slic3r`,
Debian) is left out where it isn't installed; it slices meshes, which `prusa-slicer --export-stl` makes.
All slicers get thicknesses of 0.05 to 0.4 mm; lamella's are multiples of 0.01 mm.
"""
import argparse
import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

LEAST, MOST, STEP = 0.05, 0.4, 0.01  # mm
QUALITY = 75  # percent, Slic3r's default
SECONDS = 3  # for each solid and each kind of sample


def plan(tools, file, deviation):
    """The report of lamella's adaptive layers, and their borders."""
    begin = time.perf_counter()
    run = subprocess.run(
        [tools / "lamella", "slice", file, "-o", "/tmp/never-written", "--pitch", "1", "--adaptive", repr(deviation),
         "--adaptive-range", f"{LEAST},{MOST}", "--adaptive-step", str(STEP), "--dry-run", "--quiet", "--json"],
        capture_output=True, text=True, check=False)
    report = json.loads(run.stdout)
    if "adaptive" not in report:
        return None, [], run.stderr.strip()
    borders = []
    for part in report["adaptive"]["thicknesses"]:
        borders += [part["z_bottom"] + k * part["thickness"] for k in range(part["layers"])]
    last = report["adaptive"]["thicknesses"][-1]
    borders.append(last["z_bottom"] + last["layers"] * last["thickness"])
    return report["adaptive"], borders, f"{time.perf_counter() - begin:.1f}"


def measure(tools, file, borders, samples):
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as table:
        table.write("\n".join(map(repr, borders)))
        table.flush()
        run = subprocess.run([tools / "measure_deviation", file, table.name, str(samples), str(SECONDS)], capture_output=True,
                             text=True, check=True)
    return json.loads(run.stdout)


def uniform(bottom, top, thickness):
    count = max(1, round((top - bottom) / thickness))
    return [bottom + k * thickness for k in range(count + 1)]


def slic3r(file, bottom):
    """Borders of Slic3r's adaptive layers, from the heights in its G-code."""
    if not shutil.which("slic3r") or not shutil.which("prusa-slicer"):
        return None
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        subprocess.run(["prusa-slicer", "--export-stl", file, "-o", folder / "m.stl"], capture_output=True, check=False,
                       timeout=300)
        (folder / "c.ini").write_text(
            f"adaptive_slicing = 1\nadaptive_slicing_quality = {QUALITY}%\nmatch_horizontal_surfaces = 1\n"
            f"layer_height = 0.2\nfirst_layer_height = 0.2\nnozzle_diameter = 0.5\nmin_layer_height = {LEAST}\n"
            f"max_layer_height = {MOST}\nskirts = 0\nfill_density = 0\ntop_solid_layers = 0\nbottom_solid_layers = 0\n"
            "perimeters = 1\nbed_shape = 0x0,600x0,600x600,0x600\nz_offset = 0\nretract_lift = 0\n")
        run = subprocess.run(["slic3r", "--no-gui", "--load", folder / "c.ini", "--print-center", "300,300",
                              "-o", folder / "m.gcode", folder / "m.stl"], capture_output=True, text=True, check=False,
                             timeout=600)
        if not (folder / "m.gcode").exists():
            print(f"slic3r: {run.stderr.strip()[-300:]}", file=sys.stderr)
            return None
        heights = [float(z) for z in re.findall(r"^G1 Z([0-9.]+)", (folder / "m.gcode").read_text(), re.M)]
    return [bottom] + [bottom + z for z in sorted(set(heights)) if z > 1e-6]


def study(tools, file, deviation, samples):
    adaptive, borders, said = plan(tools, file, deviation)
    if adaptive is None:
        return {"file": file.name, "refused": said}
    row = {"file": file.name, "tolerance": deviation, "seconds": said, "layers": adaptive["layers"],
           "bound": adaptive["largest_deviation"], "sharp_edges": adaptive["sharp_edges"],
           "greedy": adaptive["greedy_layers"], "missed": adaptive["missed"], "greedy_missed": adaptive["greedy_missed"],
           "uniform": adaptive["uniform_layers"], "uniform_thickness": adaptive["uniform_thickness"]}
    found = measure(tools, file, borders, samples)
    row |= {"built": found["built"], "surface": found["surface"],
            "samples": found["built_samples"] + found["surface_samples"]}
    if adaptive["uniform_thickness"]:
        found = measure(tools, file, uniform(borders[0], borders[-1], adaptive["uniform_thickness"]), samples)
        row |= {"uniform_built": found["built"], "uniform_surface": found["surface"]}
    theirs = slic3r(file, borders[0])
    if theirs and len(theirs) > 2:
        found = measure(tools, file, theirs, samples)
        row |= {"slic3r": len(theirs) - 1, "slic3r_built": found["built"], "slic3r_surface": found["surface"]}
        same, _, _ = plan(tools, file, found["built"])
        row["layers_at_slic3r_deviation"] = same["layers"] if same else None
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("files", type=pathlib.Path, nargs="+")
    parser.add_argument("--deviation", type=float, default=0.05)
    parser.add_argument("--samples", type=int, default=2000)
    parser.add_argument("--csv", type=pathlib.Path)
    options = parser.parse_args()
    rows = []
    for file in options.files:
        row = study(options.build / "bin", file, options.deviation, options.samples)
        rows.append(row)
        print(json.dumps(row), flush=True)
    if options.csv:
        keys = list(dict.fromkeys(key for row in rows for key in row))
        with options.csv.open("w", newline="") as out:
            writer = csv.DictWriter(out, keys)
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
