#!/usr/bin/env python3
"""From STEP to pictures and to OpenVDB, on one core, next to what else does it: whole commands, one after the other.

Pictures: one label PNG a layer (lamella slice --png-indexed) against PrusaSlicer's --export-sla, which writes one black
and white picture a layer of all solids together. Volumes: lamella slice --vdb --vdb-grids fog against tessellating with
OpenCASCADE at 0.01 mm and OpenVDB's meshToVolume (bench/fog_openvdb). Neither side keeps anything else; with --store,
ours keeps its build, too. Medians of CPU seconds. Every run writes into a folder of its own: where names and inodes were
just freed, file systems take longer."""
import argparse
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import zipfile

PIXELS = 1000
VOXEL = 0.05  # mm
DEFLECTION = 0.01  # mm


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", required=True, type=pathlib.Path, help="folder of lamella and fog_openvdb")
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", choices=["pictures", "volumes"])
    parser.add_argument("--store", action="store_true", help="keep the build, too")
    parser.add_argument("models", nargs="+", type=pathlib.Path)
    return parser.parse_args()


def run(command, log):
    """CPU seconds and peak memory of a command that is held to one core."""
    with open(log, "w", encoding="utf-8") as out:
        process = subprocess.Popen(["taskset", "-c", "0", *map(str, command)], stdout=out, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 3):
        sys.exit(f"{command[0]} failed: see {log}")
    return {"seconds": usage.ru_utime + usage.ru_stime, "bytes": usage.ru_maxrss * 1024}


def new_place(arguments):
    folder = arguments.out / "runs"
    folder.mkdir(exist_ok=True)
    return pathlib.Path(tempfile.mkdtemp(dir=folder))


def store(arguments, place):
    return ["-o", place / "build"] if arguments.store else []


def bounds_of(arguments, model):
    done = subprocess.run([arguments.bin / "lamella", "info", model, "--json", "--quiet"], check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    boxes = [solid["bounds"] for solid in json.loads(done.stdout)["solids"]]
    lower = [min(box[0][axis] for box in boxes) for axis in range(3)]
    upper = [max(box[1][axis] for box in boxes) for axis in range(3)]
    return [high - low for low, high in zip(lower, upper)]


def picture_runs(arguments, model):
    """Both sides get the same pitch and layer height, and pictures of the same 1000 x 1000 pixels or nearly."""
    size = bounds_of(arguments, model)
    pitch = max(size[:2]) / PIXELS
    height = pitch
    ours, theirs = [], []
    for _ in range(arguments.runs):
        place = new_place(arguments)
        pictures, archive = place / "pictures", place / "other.sl1"
        ours.append(run([arguments.bin / "lamella", "slice", model, *store(arguments, place), "--png-indexed", pictures,
                         "--pitch", repr(pitch), "--layer-height", repr(height), "--threads", 1, "--quiet"],
                        arguments.out / "ours.log"))
        width = 1.1 * PIXELS * pitch
        theirs.append(run(["prusa-slicer", "--export-sla", "--printer-technology", "SLA", "--pad-enable=0",
                           "--supports-enable=0", f"--layer-height={height}", f"--initial-layer-height={height}",
                           f"--display-pixels-x={int(1.1 * PIXELS)}", f"--display-pixels-y={int(1.1 * PIXELS)}",
                           f"--display-width={width}", f"--display-height={width}", "--display-orientation=landscape",
                           f"--center={width / 2},{width / 2}", "-o", archive, model], arguments.out / "other.log"))
    layers = len(list(pictures.glob("layer_*.png")))
    with zipfile.ZipFile(archive) as other:
        other_layers = sum(name.endswith(".png") and "thumbnail" not in name for name in other.namelist())
    return row(model, ours, theirs) | {"layers": layers, "other_layers": other_layers}


def volume_runs(arguments, model):
    ours, theirs = [], []
    for _ in range(arguments.runs):
        place = new_place(arguments)
        ours.append(run([arguments.bin / "lamella", "slice", model, *store(arguments, place), "--vdb",
                         place / "ours.vdb", "--vdb-grids", "fog", "--pitch", VOXEL, "--layer-height", VOXEL,
                         "--threads", 1, "--quiet"],
                        arguments.out / "ours.log"))
        theirs.append(run([arguments.bin / "fog_openvdb", model, DEFLECTION, VOXEL, place / "other.vdb"],
                          arguments.out / "other.log"))
    return row(model, ours, theirs)


def row(model, ours, theirs):
    def median(runs, key):
        return statistics.median(entry[key] for entry in runs)

    return {"model": model.stem, "seconds": median(ours, "seconds"), "other_seconds": median(theirs, "seconds"),
            "ratio": median(theirs, "seconds") / median(ours, "seconds"), "peak_memory_bytes": median(ours, "bytes"),
            "other_peak_memory_bytes": median(theirs, "bytes")}


def table(name, rows):
    lines = [f"| {name} | CPU s | other, CPU s | ratio | layers/s | memory, MiB | other, MiB |",
             "|---|---:|---:|---:|---:|---:|---:|"]
    for entry in rows:
        rate = f"{entry['layers'] / entry['seconds']:.0f}" if "layers" in entry else "-"
        lines.append(f"| {entry['model']} | {entry['seconds']:.2f} | {entry['other_seconds']:.2f} | {entry['ratio']:.1f} | "
                     f"{rate} | {entry['peak_memory_bytes'] / 2**20:.0f} | {entry['other_peak_memory_bytes'] / 2**20:.0f} |")
    return "\n".join(lines)


def main():
    arguments = parse_arguments()
    arguments.out.mkdir(parents=True, exist_ok=True)
    result = {}
    kinds = {"pictures": picture_runs, "volumes": volume_runs}
    for kind, measure in kinds.items():
        if arguments.only in (None, kind):
            result[kind] = [measure(arguments, model) for model in arguments.models]
            print(table(kind, result[kind]), flush=True)
    shutil.rmtree(arguments.out / "runs", ignore_errors=True)
    (arguments.out / "outputs.json").write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


main()
