#!/usr/bin/env python3
"""Least heights over all orientations against the paper's scheme, on many STEP files, by the command alone.

    bench/orient_run.py FILE... > docs/methods/orientation.csv

For each file: height as it is (mm), by turning about x, y and z in steps of 1 degree (one after the other until none
helps), the least height with what is proved of it, and seconds of CPU and wall of the run, reading included. Ends with exit code 1 if the least height is above the scheme's on any file.
"""
import json
import os
import subprocess
import sys
import time

LAMELLA = os.environ.get("LAMELLA", "build/release/bin/lamella")
AXES = ["x", "y", "z"]


def orient(path, axes):
    options = [option for axis in axes for option in ("--axis", axis)]
    line = [LAMELLA, "orient", path, "--step", "1", "--samples", "2000", "--quiet", "--json", *options]
    start, before = time.time(), os.times()
    run = subprocess.run(line, capture_output=True, text=True, timeout=600)
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    result = json.loads(run.stdout)
    return result, cpu, time.time() - start


def main():
    worse = []
    print("file,as_it_is,scheme,least,proved,gap,heights,triangles,cpu_s,wall_s")
    for path in sys.argv[1:]:
        name = os.path.basename(path)
        result, cpu, wall = orient(path, AXES)
        if "error" in result:
            print(f"{name}: {result['error']['what']}", file=sys.stderr)
            continue
        scheme = result["axis_scheme"]["height"]
        least = result["least_height"]
        cells = [result["present_height"], scheme, least["height"], least["proved"]]
        print(",".join([name] + [f"{cell:.10g}" for cell in cells] + [f"{least['gap']:.2g}", str(least["heights"]),
              str(least["triangles"]), f"{cpu:.2f}", f"{wall:.2f}"]), flush=True)
        if least["height"] > scheme * (1 + 1e-12):
            worse.append(name)
    print("worse than the scheme:", ", ".join(worse) or "none", file=sys.stderr)
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main())
