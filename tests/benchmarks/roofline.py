#!/usr/bin/env python3
"""Sweep and scattering beside what one core can do: operations per second against operations per byte of memory.

Rates are those of bench_transport. Operations and bytes of a (cell, ordinate) pair are counted from the code, in float; a fused product and sum
counts as two operations.

usage: roofline.py BENCH_TRANSPORT [--document docs/speed.md] [--plot docs/images/roofline.png]
"""
import argparse
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "validation"))
import support

LANES = 8
# cell_kernel.hpp, for each place of a run: optical path 2; rational functions of 6 coefficients, three numerators, a denominator and a division 36;
# source at entry and exit 14; mean radiance 8; radiance that leaves 8; the sum 1.
CROSSING = 69
# source_slopes.cpp, for each cell: part from the beam 2; three slopes 9; their limit 8; three products 3.
SLOPES = 22
# octant_scattering.cpp, for each pair: two transforms of three sums 6; a row of 16 products and sums 32; times the albedo 1; the beam 2; moments 3.
SCATTERING = 44
# Numbers that come from memory in large fields: source, extinction, irradiance of the beam, six slopes; radiance, read for its cache line and written.
SWEEP_BYTES = 4 * (1 + 1 + 1 + 6 + 2)
SCATTERING_BYTES = 4 * 2
SIZES = (96, 224)


@dataclass
class Kernel:
    name: str
    operations: float
    bytes: float
    nanoseconds: float

    @property
    def intensity(self):
        return self.operations / self.bytes

    @property
    def rate(self):
        """10^9 operations per second."""
        return self.operations / self.nanoseconds


def measured(program):
    """The best of five runs of each benchmark, by name."""
    names = [f"{kernel}/{size}" for kernel in ("sweep_all", "scatter_all") for size in SIZES] + ["arithmetic", "memory"]
    text = subprocess.run([program, "--benchmark_format=json", "--benchmark_repetitions=5", "--benchmark_min_time=0.2",
                           f"--benchmark_filter=^({'|'.join(names)})$"], capture_output=True, text=True, check=True).stdout
    best = {}
    for run in json.loads(text)["benchmarks"]:
        if run["run_type"] == "iteration" and (run["name"] not in best or run["cpu_time"] < best[run["name"]]["cpu_time"]):
            best[run["name"]] = run
    return best


def kernels_of(best):
    kernels = []
    for size in SIZES:
        sweep, scatter = best[f"sweep_all/{size}"], best[f"scatter_all/{size}"]
        cells = f"{size} x {size} x {size // 2}"
        kernels.append(Kernel(f"sweep, {cells} cells", LANES * CROSSING * sweep["runs_a_pair"] + SLOPES, SWEEP_BYTES, 1e9 / sweep["items_per_second"]))
        kernels.append(Kernel(f"scattering, {cells} cells", SCATTERING, SCATTERING_BYTES, 1e9 / scatter["items_per_second"]))
    return kernels


def draw(kernels, arithmetic, memory, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    figure, axes = plt.subplots(figsize=(6.4, 4))
    intensity = np.geomspace(.5, 32, 100)
    axes.loglog(intensity, np.minimum(arithmetic, memory * intensity), color="black")
    axes.text(5, arithmetic * 1.06, f"arithmetic, {arithmetic:.0f} per ns")
    axes.text(.55, memory * .55 * 1.35, f"memory, {memory:.0f} bytes per ns", rotation=38)
    for kernel, marker in zip(kernels, "osDv"):
        axes.plot(kernel.intensity, kernel.rate, marker, label=kernel.name)
    axes.set(xlabel="operations per byte of memory", ylabel="operations per ns", xlim=(.5, 32), ylim=(5, 200))
    axes.legend(loc="lower right")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path, metavar="BENCH_TRANSPORT")
    parser.add_argument("--document", type=Path, help="write the table between the markers `roofline` of this document")
    parser.add_argument("--plot", type=Path, help="draw the picture")
    options = parser.parse_args()
    best = measured(options.program)
    arithmetic = best["arithmetic"]["items_per_second"] * 1e-9
    memory = best["memory"]["bytes_per_second"] * 1e-9
    rows = [["one core", "", "", f"{arithmetic / memory:.1f}", "", f"{arithmetic:.0f}", ""]]
    kernels = kernels_of(best)
    for kernel in kernels:
        line = min(arithmetic, memory * kernel.intensity)
        rows.append([kernel.name, f"{kernel.operations:.0f}", f"{kernel.bytes:.0f}", f"{kernel.intensity:.1f}", f"{kernel.nanoseconds:.1f}",
                     f"{kernel.rate:.0f}", f"{100 * kernel.rate / line:.0f}"])
    table = support.markdown_table(["kernel", "operations", "bytes", "operations per byte", "ns", "operations per ns", "% of the line"], rows)
    print(f"memory: {memory:.0f} bytes per ns\n{table}")
    if options.document:
        support.write_between_markers(options.document, "roofline", table)
    if options.plot:
        draw(kernels, arithmetic, memory, options.plot)
    return 0


if __name__ == "__main__":
    sys.exit(main())
