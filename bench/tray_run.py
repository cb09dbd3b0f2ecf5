#!/usr/bin/env python3
"""Fills a tray with copies of a data set, slices it at a printer's pitch and tells what that took (see scripts/tray)."""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

DPI = "600,300"
LAYER_HEIGHT = 0.027  # mm


def numbers(text, kind, count=None):
    values = [kind(part) for part in text.split(",")]
    if (count and len(values) != count) or any(value <= 0 for value in values):
        raise ValueError
    return values


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", required=True, type=pathlib.Path, help="folder of lamella and lamella_datasets")
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--commit", default="unknown")
    parser.add_argument("--part", default="overmoulded_grip")
    parser.add_argument("--size", type=lambda text: numbers(text, float, 3), default=[490.0, 390.0, 200.0])
    parser.add_argument("--gap", type=float, default=2.0)
    parser.add_argument("--divisors", type=lambda text: numbers(text, int))
    parser.add_argument("--threads", type=int)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--keep", action="store_true")
    arguments = parser.parse_args()
    if arguments.divisors is None:
        arguments.divisors = [64, 32] if arguments.quick else [8, 4, 2, 1]
    return arguments


def machine():
    model = "unknown"
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
    return {"cpu": model, "cores": os.cpu_count()}


def load():
    return pathlib.Path("/proc/loadavg").read_text().strip()


def make_tray(arguments):
    step = arguments.out / "tray.step"
    command = [arguments.bin / "lamella_datasets", "--tray", arguments.part, "--size", *map(str, arguments.size),
               "--gap", str(arguments.gap), step]
    done = subprocess.run(command, check=False, stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(done.returncode)
    print(f"{arguments.part}: {done.stdout.strip()}; {step.stat().st_size / 1e6:.2f} MB of STEP", flush=True)
    return step


def size_of(folder):
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())


def run_slice(arguments, step, divisor):
    """One run; the memory and the processor time are what the system counts for the process."""
    build = arguments.out / "build"
    shutil.rmtree(build, ignore_errors=True)
    command = [arguments.bin / "lamella", "slice", step, "-o", build, "--materials", arguments.out / "materials.xml",
               "--dpi", DPI, "--layer-height", repr(LAYER_HEIGHT * divisor), "--json"]
    if arguments.threads:
        command += ["--threads", str(arguments.threads)]
    load_before = load()
    began = time.monotonic()
    report_file = arguments.out / f"slice-{divisor}.json"
    with open(report_file, "w", encoding="utf-8") as out:
        process = subprocess.Popen(command, stdout=out)
        _, status, usage = os.wait4(process.pid, 0)
    seconds = time.monotonic() - began
    code = os.waitstatus_to_exitcode(status)
    if code not in (0, 3):
        sys.exit(code)
    report = json.loads(report_file.read_text(encoding="utf-8"))
    keys = ["layers", "rows", "rays", "hits", "segments", "unclosed_rays", "repaired_rays", "uncertain_hits", "timing"]
    run = {key: report[key] for key in keys}
    run |= {"divisor": divisor, "exit_code": code, "solids": len(report["solids"]), "seconds": seconds,
            "cpu_seconds": usage.ru_utime + usage.ru_stime, "peak_memory_bytes": usage.ru_maxrss * 1024,
            "store_bytes": size_of(build), "load_before": load_before, "load_after": load()}
    return run


def table(runs):
    lines = ["| layers | rays | hits | seconds | CPU s | read | prepare | slice, of which writing | million hits/s "
             "| peak memory, MiB | store, MB | exit | load before |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for run in runs:
        timing = run["timing"]
        cells = [run["layers"], f"{run['rays'] / 1e6:.2f} M", f"{run['hits'] / 1e6:.1f} M", f"{run['seconds']:.1f}",
                 f"{run['cpu_seconds']:.1f}", f"{timing['read']:.1f}", f"{timing['prepare']:.1f}",
                 f"{timing['slice']:.1f}, {timing['write']:.1f}", f"{run['hits'] / run['seconds'] / 1e6:.2f}",
                 f"{run['peak_memory_bytes'] / 2**20:.0f}", f"{run['store_bytes'] / 1e6:.0f}", run["exit_code"],
                 run["load_before"].split()[0]]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def main():
    arguments = parse_arguments()
    arguments.out.mkdir(parents=True, exist_ok=True)
    step = make_tray(arguments)
    runs = []
    for divisor in arguments.divisors:
        runs.append(run_slice(arguments, step, divisor))
        print(f"one layer in {divisor}: {runs[-1]['seconds']:.1f} s", file=sys.stderr, flush=True)
    if not arguments.keep:
        shutil.rmtree(arguments.out / "build", ignore_errors=True)
    result = {"commit": arguments.commit, "machine": machine(), "part": arguments.part, "size": arguments.size,
              "gap": arguments.gap, "dpi": DPI, "layer_height": LAYER_HEIGHT, "threads": arguments.threads, "runs": runs}
    (arguments.out / "tray.json").write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    (arguments.out / "tray.md").write_text(table(runs) + "\n", encoding="utf-8")
    print(table(runs))


main()
