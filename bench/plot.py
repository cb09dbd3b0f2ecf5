#!/usr/bin/python3
"""Draws charts from the JSON files of span_bench: bars of ratios, and curves of the span engine's cost."""

import argparse
import json
import math
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

CASTERS = ("contour", "dexel")


def label(model):
    """A file's name without its ending, short enough for an axis."""
    name = pathlib.Path(model["file"]).stem
    return name if len(name) <= 26 else name[:25] + "\u2026"


def whole_seconds(model, peer, with_tessellation):
    """Seconds for all rows of the lattice, preparing included."""
    seconds = peer["prepare_s"] + peer["cast_s"] / peer["share"]
    if with_tessellation and peer["mesh"]:
        seconds += model["tessellations"][peer["mesh"]]["seconds"]
    return seconds


def rate(model, names, mesh="", with_tessellation=False):
    """The best hits per second of some peers, or nan."""
    rates = [
        peer["hits"] / peer["share"] / whole_seconds(model, peer, with_tessellation)
        for peer in model["peers"]
        if peer["peer"] in names and peer["mesh"] == mesh and "failed" not in peer
    ]
    return max(rates, default=math.nan)


def ratios(model):
    """How many times faster the span engine is, by what it is compared with."""
    span = rate(model, ("span",))
    return {
        "mesh, 0.001 mm": span / rate(model, CASTERS, "0.001"),
        "mesh, 0.01 mm": span / rate(model, CASTERS, "0.01"),
        "mesh, 0.001 mm, with tessellation": span / rate(model, CASTERS, "0.001", True),
        "Embree, 0.001 mm": span / rate(model, ("embree",), "0.001"),
        "OpenCASCADE's exact rays": span / rate(model, ("occt",)),
    }


def draw_ratios(models, path):
    """One group of bars a model on a logarithmic axis; 1 is as fast as the peer."""
    rows = [ratios(model) for model in models]
    names = list(rows[0])
    height = 0.8 / len(names)
    figure, axes = plt.subplots(figsize=(9, 1.2 + 0.75 * len(models)), layout="constrained")
    for i, name in enumerate(names):
        where = [k + (i - (len(names) - 1) / 2) * height for k in range(len(models))]
        axes.barh(where, [row[name] - 1 for row in rows], height, left=1, label=name)
    axes.axvline(1, color="black", linewidth=0.8)
    axes.set_xscale("log")
    axes.set_yticks(range(len(models)), [label(model) for model in models])
    axes.invert_yaxis()
    axes.set_xlabel("times faster than (hits per CPU second of one thread)")
    axes.grid(axis="x", alpha=0.3)
    axes.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.4, 1.0), ncol=3, frameon=False)
    figure.savefig(path)
    plt.close(figure)


def draw_cost(models, name, path):
    """CPU seconds against layers or rows."""
    figure, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
    for model in models:
        points = model.get(name, [])
        axes.plot([p[name] for p in points], [p["cpu_s"] for p in points], marker="o", markersize=3, label=label(model))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(name)
    axes.set_ylabel("CPU seconds, one thread")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="x-small")
    figure.savefig(path)
    plt.close(figure)


def draw_threads(models, path):
    """Speed-up by wall clock."""
    figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
    most = 1
    for model in models:
        points = model.get("threads", [])
        if points:
            axes.plot(
                [p["threads"] for p in points],
                [points[0]["wall_s"] / p["wall_s"] for p in points],
                marker="o",
                markersize=3,
                label=label(model),
            )
            most = max(most, points[-1]["threads"])
    axes.plot([1, most], [1, most], color="black", linewidth=0.8, linestyle="--")
    axes.set_xticks(range(1, most + 1))
    axes.set_xlabel("threads")
    axes.set_ylabel("times faster than one")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="x-small")
    figure.savefig(path)
    plt.close(figure)


def draw_faces(models, path):
    """Preparing and cutting against the number of faces, a point a model."""
    models = [model for model in models if model.get("layers")]
    figure, axes = plt.subplots(figsize=(6, 4.5), layout="constrained")
    faces = [model["faces"] for model in models]
    cut = [min(p["cpu_s"] / p["layers"] for p in model["layers"]) * 1e3 for model in models]
    axes.scatter(faces, cut, label="cutting a layer, ms")
    axes.scatter(faces, [model["prepare_s"] * 1e3 for model in models], marker="x", label="preparing, ms")
    for model, x, y in zip(models, faces, cut):
        axes.annotate(label(model), (x, y), fontsize="xx-small", xytext=(3, 3), textcoords="offset points")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("faces")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    figure.savefig(path)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", nargs="?", type=pathlib.Path, help="JSON of span_bench")
    parser.add_argument("--curves", type=pathlib.Path, help="JSON of span_bench --curves")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("."), help="folder for the charts")
    parser.add_argument("--format", choices=("svg", "png"), default="svg")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)

    def target(name):
        return arguments.out / f"{name}.{arguments.format}"

    if arguments.results:
        draw_ratios(json.loads(arguments.results.read_text())["models"], target("ratios"))
    if arguments.curves:
        models = json.loads(arguments.curves.read_text())["models"]
        draw_cost(models, "layers", target("cost_by_layers"))
        draw_cost(models, "rows", target("cost_by_rows"))
        draw_threads(models, target("threads"))
        draw_faces(models, target("cost_by_faces"))


if __name__ == "__main__":
    main()
