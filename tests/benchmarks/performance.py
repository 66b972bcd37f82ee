#!/usr/bin/env python3
"""Cost of a solve: shares of the time, how it grows with the field and with the directions, what a second thread brings, memory as predicted
and as measured. Remakes the tables of docs/speed.md.

A figure is the least of three runs if one takes less than ten seconds, and of one run otherwise. Seconds are CPU seconds on one thread: of a
phase, its wall seconds times the share of the processor that the run had. The table of threads has wall seconds, and sets the gain of a second
thread against what the machine gives to a loop of pure arithmetic run the same way. RICO needs CLOUDBOW_REFERENCE_DIR and is left out without.

usage: performance.py [phases] [scaling] [directions] [threads] [memory] [--voxels 1e4 1e5 1e6 1e7] [--document docs/speed.md]
"""
import math
import os
import re
import shlex
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "validation"))
import intercomparison  # noqa: E402
import support  # noqa: E402

REPEATS = 3
SHORT_SECONDS = 10
ACCURACIES = ("draft", "balanced", "fine", "reference")
PHASES = ("tables", "beam", "sweeps", "scattering", "acceleration", "gather")
CELL_M = (50, 50, 25)
LEVELS = 64
VOXELS_A_COLUMN = 2.4  # of cumulus that cover a fifth of the domain
# About a second of arithmetic that stays in registers.
ARITHMETIC = "x = 0\nfor i in range(15_000_000):\n    x = (x * 3 + i) & 1023\n"


@dataclass
class Cost:
    """The least of each figure over repeated runs of a scene."""
    voxels: int
    directions: int
    sweeps: int
    cpu: float
    peak_bytes: float
    phase: dict  # seconds

    def nanoseconds(self, *phases):
        """A voxel, direction and sweep."""
        return 1e9 * sum(self.phase[p] for p in phases) / (self.voxels * self.directions * self.sweeps)


def direction_count(name):
    """Of a set such as double-gauss-8x16."""
    polar, azimuths = map(int, re.search(r"(\d+)x(\d+)$", name).groups())
    return polar * azimuths


def small_parent(program, folder):
    """A program that starts `program` from a small process: a process counts the memory of the one that started it as its own peak."""
    launcher = folder / "launch"
    launcher.write_text(f"#!/bin/sh\n{shlex.quote(str(program))} \"$@\"\nexit $?\n")
    launcher.chmod(0o755)
    return launcher


class Bench:
    def __init__(self, program, folder):
        self.program = small_parent(Path(program).resolve(), folder)
        self.folder = folder
        self.known = {}

    def run(self, scene, accuracy="balanced", threads=1):
        return support.Cloudbow(self.program, threads).run(scene, self.folder / "result.h5", "--set", f"solver.accuracy={accuracy}", accept=(0, 3))

    def measure(self, scene, accuracy="balanced"):
        if (scene, accuracy) in self.known:
            return self.known[scene, accuracy]
        runs = []
        while not runs or (len(runs) < REPEATS and runs[0].cpu_seconds < SHORT_SECONDS):
            runs.append(self.run(scene, accuracy))
        report = runs[0].solver
        share = [min(1.0, r.cpu_seconds / r.wall_seconds) for r in runs]
        cost = Cost(report["active_voxels"], direction_count(report["directions"]), report["sweeps"], min(r.cpu_seconds for r in runs),
                    min(r.peak_memory_bytes for r in runs),
                    {p: min(s * r.solver[f"seconds_{p}"] for s, r in zip(share, runs)) for p in PHASES})
        print(f"{Path(scene).stem}, {accuracy}: {cost}, wall {min(r.wall_seconds for r in runs):.2f}", file=sys.stderr, flush=True)
        self.known[scene, accuracy] = cost
        return cost

    def predicted(self, scene, accuracy="balanced"):
        """Bytes and seconds that --dry-run promises."""
        text = support.Cloudbow(self.program).call("run", scene, "--dry-run", "--threads", 1, "--set", f"solver.accuracy={accuracy}",
                                               "--set", "output.error_estimate=false").stdout
        gigabytes = float(re.search(r"memory\s+([\d.]+) GB predicted", text).group(1))
        return 1e9 * gigabytes, float(re.search(r"time\s+([\d.]+) s predicted", text).group(1))

    def cumulus(self, voxels):
        """A scene with about so many cloudy voxels: the cumulus of configs/cumulus.toml in a domain as wide as that takes."""
        columns = 16 * max(4, round(math.sqrt(voxels / VOXELS_A_COLUMN) / 16))
        scene = self.folder / f"cumulus_{columns}.toml"
        if not scene.exists():
            cloud = self.folder / f"cumulus_{columns}.vdb"
            support.Cloudbow(self.program).call("cloud", "make", "cumulus", "--cells", columns, columns, LEVELS, "--voxel-size-m", *CELL_M, "--cover", 0.2,
                                                "--seed", 1, "-o", cloud)
            scene.write_text(support.scene_text([
                ("", {"title": f"Cumulus, {columns} x {columns} columns"}),
                ("cloud", {"file": str(cloud), "single_scattering_albedo": 0.999999, "phase_function": "droplets"}),
                ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
                ("sun", {"zenith_deg": 60.0, "azimuth_deg": 0.0}),
                ("surface", {"type": "lambertian", "albedo": 0.05}),
            ]))
        return scene


def phases(bench, options):
    scenes = [("`configs/cumulus.toml`", support.ROOT / "configs/cumulus.toml")]
    references = support.reference_folder()
    if references is not None:
        rico = bench.folder / "rico.toml"
        rico.write_text(intercomparison.scene(intercomparison.CASES["rico"][0], references / "fields", "balanced"))
        scenes.append(("RICO", rico))
    rows = []
    for name, scene in scenes:
        cost = bench.measure(scene)
        rows.append([name, cost.voxels, cost.sweeps, *(f"{cost.phase[p]:.2f}" for p in PHASES), f"{cost.cpu:.2f}", f"{cost.nanoseconds('sweeps'):.1f}",
                     f"{cost.nanoseconds('scattering'):.1f}", f"{cost.nanoseconds('sweeps', 'scattering', 'acceleration'):.1f}"])
    return support.markdown_table(["scene", "voxels", "sweeps", *(f"{p} s" for p in PHASES), "all s", "ns: sweep", "ns: scattering",
                                   "ns: iteration"], rows)


def scaling(bench, options):
    rows = []
    for voxels in options.voxels:
        cost = bench.measure(bench.cumulus(voxels))
        iteration = sum(cost.phase[p] for p in ("sweeps", "scattering", "acceleration"))
        rows.append([cost.voxels, cost.sweeps, f"{cost.cpu:.2f}", f"{1e6 * cost.cpu / cost.voxels:.0f}", f"{1e6 * iteration / cost.voxels:.0f}",
                     f"{1e6 * cost.phase['gather'] / cost.voxels:.0f}", f"{cost.nanoseconds('sweeps', 'scattering', 'acceleration'):.1f}",
                     f"{cost.peak_bytes / 1e6:.0f}", f"{cost.peak_bytes / cost.voxels:.0f}"])
    return support.markdown_table(["voxels", "sweeps", "CPU s", "us a voxel", "of it iteration", "of it gather", "ns: iteration", "MB",
                                   "bytes per voxel"], rows)


def directions(bench, options):
    rows = []
    scene = bench.cumulus(options.voxels[0])
    for accuracy in ACCURACIES:
        cost = bench.measure(scene, accuracy)
        rows.append([accuracy, cost.directions, cost.sweeps, *(f"{cost.phase[p]:.2f}" for p in PHASES), f"{cost.cpu:.2f}", f"{cost.nanoseconds('sweeps'):.1f}",
                     f"{cost.nanoseconds('scattering'):.1f}", f"{cost.peak_bytes / 1e6:.0f}"])
    return support.markdown_table(["accuracy", "directions", "sweeps", *(f"{p} s" for p in PHASES), "all s", "ns: sweep", "ns: scattering", "MB"], rows)


def arithmetic_seconds(processes):
    start = time.monotonic()
    running = [subprocess.Popen([sys.executable, "-c", ARITHMETIC]) for _ in range(processes)]
    if any(process.wait() != 0 for process in running):
        raise support.Failure("the calibration loop failed")
    return time.monotonic() - start


def threads(bench, options):
    scene = bench.cumulus(options.voxels[0])
    # By turns, so that both see the same neighbours on the machine.
    one, two = [], []
    runs = {1: [], 2: []}
    for _ in range(REPEATS):
        one.append(arithmetic_seconds(1))
        two.append(arithmetic_seconds(2))
        for count in (1, 2):
            runs[count].append(bench.run(scene, threads=count))
    machine = 2 * min(one) / min(two)

    def seconds(count, names):
        return min(sum(run.solver[f"seconds_{p}"] for p in names) for run in runs[count])

    rows = []
    for name, names in (("sweeps", ["sweeps"]), ("scattering", ["scattering"]), ("acceleration", ["acceleration"]), ("gather", ["gather"]),
                        ("all", PHASES)):
        alone, together = seconds(1, names), seconds(2, names)
        rows.append([name, f"{alone:.2f}", f"{together:.2f}", f"{alone / together:.2f}", f"{100 * alone / together / machine:.0f}"])
    rows.append(["arithmetic, twice the work", f"{2 * min(one):.2f}", f"{min(two):.2f}", f"{machine:.2f}", "100"])
    return support.markdown_table(["phase", "1 thread, wall s", "2 threads, wall s", "gain", "% of what the machine gives"], rows)


def memory(bench, options):
    rows = []
    scenes = [(bench.cumulus(options.voxels[0]), accuracy) for accuracy in ACCURACIES]
    scenes += [(bench.cumulus(voxels), "balanced") for voxels in options.voxels[1:]]
    for scene, accuracy in scenes:
        cost = bench.measure(scene, accuracy)
        size, seconds = bench.predicted(scene, accuracy)
        rows.append([cost.voxels, accuracy, f"{size / 1e6:.0f}", f"{cost.peak_bytes / 1e6:.0f}", f"{size / cost.peak_bytes:.2f}", f"{seconds:.1f}",
                     f"{cost.cpu:.1f}", f"{seconds / cost.cpu:.2f}"])
    return support.markdown_table(["voxels", "accuracy", "MB predicted", "MB measured", "ratio", "s predicted", "s measured", "ratio"], rows)


TABLES = {"phases": phases, "scaling": scaling, "directions": directions, "threads": threads, "memory": memory}


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"those to make: {', '.join(TABLES)} (default: all)")
    parser.add_argument("--voxels", nargs="+", type=float, default=[1e4, 1e5, 1e6], help="about how many cloudy voxels, ascending (default: 1e4 1e5 1e6)")
    parser.add_argument("--document", type=Path, help="write the tables between the markers of their names in this document")
    options = parser.parse_args()
    if unknown := [name for name in options.tables if name not in TABLES]:
        parser.error(f"there is no table {unknown[0]!r} (allowed: {', '.join(TABLES)})")
    if options.threads:
        parser.error("--threads: the tables say themselves how many threads they take")
    with support.Workspace(options.keep) as folder:
        os.environ["XDG_CACHE_HOME"] = str(folder.resolve())  # tables are made in the first run of each kind
        bench = Bench(options.cloudbow, folder.resolve())
        for name in options.tables or TABLES:
            text = TABLES[name](bench, options)
            print(f"{name}\n{text}", flush=True)
            if options.document:
                support.write_between_markers(options.document, name, text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
