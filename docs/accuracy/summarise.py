#!/usr/bin/python3
"""Tables and charts of docs/accuracy.md from the JSON files of `lamella accuracy`.

summarise.py FOLDER DOCS: FOLDER holds NAME.json, DOCS is the folder docs. Writes DOCS/accuracy/results.json, the blocks
between `<!-- table NAME -->` and `<!-- end -->` in DOCS/accuracy.md, and DOCS/images/accuracy.svg.
"""

import json
import math
import pathlib
import re
import statistics
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)


def read(folder):
    """The studies by name, as they were run."""
    return {path.stem: json.loads(path.read_text()) for path in sorted(folder.glob("*.json"))}


def measured(study):
    """The deflections that weren't skipped."""
    return [level for level in study["stl"] if level["skipped"] is None]


def short(value, digits=2):
    """A number with few digits, a dash for none."""
    return "-" if value is None else f"{value:.{digits}g}"


def size(count):
    return f"{count / 1e6:.2g} MB" if count >= 1e6 else f"{count / 1e3:.3g} kB"


def whole(count):
    return f"{count:,}".replace(",", " ")


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def table_at(studies, deflection):
    """One row a model: what an STL file of this deflection does to it."""
    rows = []
    for name, study in studies.items():
        level = next((one for one in measured(study) if one["deflection"] == deflection), None)
        if level is None:
            reason = next(one["skipped"] for one in study["stl"] if one["deflection"] == deflection)
            rows.append([f"`{name}`", f"skipped: {reason}"] + [""] * 8)
            continue
        direct = study["direct"]
        rows.append([
            f"`{name}`",
            whole(level["triangles"]),
            f"{level['bytes'] / direct['bytes']:.2g}",
            short(level["max_distance"]),
            short(level["rms_error"]),
            short(level["max_error"]),
            whole(level["missed"] + level["false"]),
            short(100 * level["relative_volume_error"]),
            f"{level['time']:.2g}",
            f"{direct['time']:.2g}",
        ])
    head = ["model", "triangles", "STL / STEP bytes", "distance, largest", "x error, RMS", "x error, largest",
            "missed + false", "volume, %", "STL, s", "direct, s"]
    return table(head, rows)


def table_direct(studies):
    """One row a model: direct slicing's own error."""
    rows = []
    for name, study in studies.items():
        direct = study["direct"]
        occt = direct["occt"] or {}
        rows.append([
            f"`{name}`",
            str(len(study["solids"])),
            whole(direct["hits"]),
            short(study["file_tolerance"]),
            whole(direct["oracle_rays"]),
            short(direct["rms_error"]),
            short(direct["max_error"]),
            f"{direct['missed']} / {direct['false']}",
            whole(occt.get("rays", 0)),
            short(occt.get("max_error")),
            f"{occt.get('missed', '-')} / {occt.get('false', '-')} / {occt.get('odd_rays', '-')}",
        ])
    head = ["model", "solids", "crossings", "file's tolerance", "rays", "RMS", "largest", "missed / false",
            "OCCT: rays", "largest", "only there / only here / odd"]
    return table(head, rows)


def by_deflection(studies):
    """Measured levels of all models by deflection, coarse first, each with its study."""
    levels = {}
    for study in studies.values():
        for level in measured(study):
            levels.setdefault(level["deflection"], []).append((study, level))
    return dict(sorted(levels.items(), reverse=True))


def median(values):
    return statistics.median(values) if values else None


def table_medians(studies):
    rows = []
    for deflection, pairs in by_deflection(studies).items():
        levels = [level for _, level in pairs]
        # Flat models are exact but for single precision: they say nothing about chords.
        hits = sum(study["direct"]["hits"] for study, _ in pairs)
        lost = sum(level["missed"] + level["false"] for level in levels)
        broken = [level for level in levels if level["max_distance"] > 1.001 * deflection]
        rows.append([
            f"{deflection:g}",
            str(len(levels)),
            short(median([level["rms_error"] for level in levels])),
            short(max(level["max_error"] for level in levels)),
            f"{1e6 * lost / hits:.3g}",
            short(median([level["max_distance"] for level in levels])),
            f"{len(broken)}",
            short(100 * median([level["relative_area_error"] for level in levels])),
            short(100 * median([level["relative_volume_error"] for level in levels])),
            whole(round(median([level["triangles"] for level in levels]))),
            f"{median([level['bytes'] / study['direct']['bytes'] for study, level in pairs]):.2g}",
            f"{median([level['time'] / study['direct']['time'] for study, level in pairs]):.3g}",
        ])
    head = ["deflection", "models", "x error, RMS", "x error, worst", "missed + false, per million", "distance, largest",
            "models beyond the deflection", "area, %", "volume, %", "triangles", "STL / STEP bytes", "time / direct"]
    return table(head, rows)


def table_lattices(studies):
    """Observed volume errors as parts of the bound, and the bound itself, by pitch over size."""
    rows = []
    for name, study in studies.items():
        finest = study["lattices"][-1] if study["lattices"] else None
        if finest is None:
            continue
        parts = [one["volume_error"] / one["volume_bound"] for one in study["lattices"]]
        rows.append([f"`{name}`", f"{finest['pitch']:.2g}", short(100 * finest["relative_volume_error"]),
                     short(100 * finest["volume_bound"] / study["volume"]), short(max(parts)),
                     short(finest["surface_bound"])])
    head = ["model", "pitch", "volume error, %", "its bound, %", "largest part of the bound used, any pitch",
            "voxels reach"]
    return table(head, rows)


def table_broken(studies):
    """Where the mesher leaves the surface further than it was asked to."""
    rows = []
    for name, study in studies.items():
        worst = max(measured(study), key=lambda one: one["max_distance"] / one["deflection"], default=None)
        if worst is None or worst["max_distance"] <= 1.5 * worst["deflection"]:
            continue
        rows.append((worst["max_distance"] / worst["deflection"],
                     [f"`{name}`", f"{worst['deflection']:g}", short(worst["max_distance"]),
                      f"{worst['max_distance'] / worst['deflection']:.3g}", short(worst["rms_distance"]),
                      short(study["file_tolerance"])]))
    rows.sort(reverse=True)
    return table(["model", "deflection", "distance, largest", "times the deflection", "distance, RMS",
                  "file's tolerance"], [row for _, row in rows])


def table_sections(lines):
    """The rows of compare_sections; solids that OpenCASCADE reads otherwise aren't compared and don't count."""
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines if line.startswith("| `")]
    rows = [[row[0], str(int(row[1]) - int(row[2]))] + row[3:] for row in sorted(rows)]
    return table(
        ["model", "solids", "sections", "OCCT: open", "relative, median", "largest", "offset, largest", "file's tolerance"],
        [["0" if cell == "0.0e+00" else cell for cell in row] for row in rows])


def put_tables(page, tables):
    """Replaces what stands between the marks of each table."""
    text = page.read_text()
    for name, content in tables.items():
        pattern = re.compile(rf"(<!-- table {name} -->\n).*?(<!-- end -->)", re.S)
        text, count = pattern.subn(lambda match: match[1] + content + match[2], text)
        if count != 1:
            raise SystemExit(f"{page} has {count} places for the table {name}")
    page.write_text(text)


def band(axes, levels, value, color, label):
    """The median over the models with the range from the 10th to the 90th percentile."""
    xs, middle, low, high = [], [], [], []
    for deflection, pairs in levels.items():
        values = sorted(one for one in (value(study, level) for study, level in pairs) if one > 0)
        if not values:
            continue
        xs.append(deflection)
        middle.append(statistics.median(values))
        low.append(values[int(0.1 * (len(values) - 1))])
        high.append(values[math.ceil(0.9 * (len(values) - 1))])
    axes.fill_between(xs, low, high, color=color, alpha=0.18, linewidth=0)
    axes.plot(xs, middle, color=color, marker="o", markersize=4, label=label)


def draw(studies, path):
    levels = by_deflection(studies)
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4.1))
    direct = [study["direct"] for study in studies.values()]
    band(left, levels, lambda s, l: l["rms_error"], "#b4530f", "STL, RMS error of crossings")
    left.axhline(statistics.median([d["rms_error"] for d in direct if d["rms_error"]]), color="#2f6fb2", linestyle="--",
                 label="direct slicing, RMS (median)")
    left.axhline(max(d["rms_error"] for d in direct if d["rms_error"]), color="#2f6fb2", linestyle=":",
                 label="direct slicing, RMS (worst model)")
    left.set_ylabel("error along the ray, mm")
    left.set_title("Error of crossings")
    band(middle, levels, lambda s, l: l["bytes"] / s["direct"]["bytes"], "#b4530f", "binary STL / STEP")
    middle.axhline(1, color="#5b6675", linestyle="--", label="equal size")
    middle.set_ylabel("bytes of STL / bytes of STEP")
    middle.set_title("Size of the files")
    band(right, levels, lambda s, l: l["time"] / s["direct"]["time"], "#b4530f",
         "tessellate, write, read, slice / direct")
    band(right, levels, lambda s, l: l["time_slice"] / s["direct"]["time"], "#2b7d4f", "slice the STL / direct")
    right.axhline(1, color="#5b6675", linestyle="--", label="equal time")
    right.set_ylabel("time of the STL side / time of direct slicing")
    right.set_title("Time")
    for axes in (left, middle, right):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("deflection of the tessellation, mm")
        axes.grid(True, color="#d5dae0", linewidth=0.6)
        axes.legend(fontsize=8, loc="best")
    figure.suptitle(f"{len(studies)} models: median, and the range of four fifths of them", fontsize=10)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def main():
    folder, docs = (pathlib.Path(argument) for argument in sys.argv[1:3])
    plt.rcParams["svg.hashsalt"] = "lamella"
    studies = read(folder)
    if not studies:
        raise SystemExit(f"no JSON files in {folder}")
    lines = [f"{json.dumps(name)}: {json.dumps(study, separators=(',', ':'))}" for name, study in studies.items()]
    (docs / "accuracy" / "results.json").write_text("{\n" + ",\n".join(lines) + "\n}\n")
    tables = {
        "medians": table_medians(studies),
        "fine": table_at(studies, 0.01),
        "direct": table_direct(studies),
        "broken": table_broken(studies),
        "lattices": table_lattices(studies),
    }
    sections = folder / "sections.txt"
    if sections.exists():
        tables["sections"] = table_sections(sections.read_text().splitlines())
    put_tables(docs / "accuracy.md", tables)
    draw(studies, docs / "images" / "accuracy.svg")


if __name__ == "__main__":
    main()
