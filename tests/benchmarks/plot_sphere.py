#!/usr/bin/python3
"""Draws docs/images/sphere-shapes.png from `sphere_tables curves`: plot_sphere.py SPHERE_TABLES PICTURE."""

import csv
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot


def main(program, picture):
    output = subprocess.run([program, "curves"], check=True, capture_output=True, text=True).stdout
    rows = list(csv.DictReader(output.splitlines()))
    shapes = list(dict.fromkeys(row["shape"] for row in rows))
    representations = [name for name in rows[0] if name not in ("shape", "angle", "exact")]

    figure, axes = pyplot.subplots(1, len(shapes), figsize=(10, 4), layout="constrained")
    for axis, shape in zip(axes, shapes):
        own = [row for row in rows if row["shape"] == shape]
        angle = [float(row["angle"]) for row in own]
        axis.plot(angle, [float(row["exact"]) for row in own], color="black", linewidth=2.5, label="exact")
        for name in representations:
            style = "--" if "harmonics" in name else "-"
            axis.plot(angle, [float(row[name]) for row in own], style, linewidth=1.2, label=name)
        axis.set(title=shape, xlabel="angle from the peak [degrees]", ylabel="value (mean 1)", xlim=(-180, 180))
        axis.axhline(0, color="gray", linewidth=0.5)
    axes[0].legend()
    figure.savefig(picture, dpi=80)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
