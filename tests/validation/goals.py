#!/usr/bin/env python3
"""`cloudbow run --target-error` on the scenes of configs/ or on made clouds: whether what was asked for is met or refused, and whether time and
memory are as predicted.

Truth: the result at `reference`, whose own distance from the truth (docs/validation.md) is no part of it. Time and memory are those of the level's own
solve, against what was predicted before it (`/plan`); seconds of solves under a fifth of a second are not judged.

With --made, clouds of `cloud make` that no weight was fitted to, and each at every level beside the target: true errors, and CPU seconds (user and
system) of the whole process without error estimate. A level is off the Pareto front if another has no larger error up and down in no more time.

usage: goals.py [SCENE ...] [--target 5 1 0.3] [--of domain columns] [--document docs/accuracy.md]
       goals.py --made [CLOUD ...] [--target 2] [--of columns]
"""
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import h5py

import support
from support import ROOT
from thick_clouds import cpu_seconds_of_children
from tradeoff_command import errors_of

SCENES = ("cumulus", "stratocumulus", "step_cloud", "slab", "layers", "mie_cumulus", "ocean", "single_cloud_open")
JUDGED_SECONDS = 0.2
CHEAP = ("--set", "output.flux_levels=boundaries", "--set", 'output.fields=["fluxes"]')
LEVELS = ("draft", "balanced", "fine")


@dataclass
class MadeCloud:
    """16 x 16 columns by `cloud make`; extinction, HG .85."""
    kind: str
    seed: int
    voxel_m: tuple
    layers: int
    optical_depth: float  # mean over the cloudy columns
    cover: float
    mu0: float
    azimuth_deg: float
    single_scattering_albedo: float = 1.0
    surface_albedo: float = 0.05

    @property
    def name(self):
        return f"{'cu' if self.kind == 'cumulus' else 'sc'}{self.seed}"


# Voxels of 20 to 100 m, flat and tall, thin and thick; five suns; six absorb. Chosen before any of them was solved.
MADE = [
    MadeCloud("cumulus", 201, (20, 20, 20), 12, 6, 0.3, 0.15, 40),
    MadeCloud("cumulus", 202, (30, 30, 30), 12, 10, 0.3, 0.3, 100),
    MadeCloud("cumulus", 203, (40, 40, 40), 10, 12, 0.25, 0.5, 200, 0.99),
    MadeCloud("cumulus", 204, (50, 50, 40), 10, 15, 0.3, 0.75, 310),
    MadeCloud("cumulus", 205, (60, 60, 60), 10, 12, 0.2, 1.0, 0),
    MadeCloud("cumulus", 206, (70, 70, 50), 10, 20, 0.35, 0.15, 75, 0.998),
    MadeCloud("cumulus", 207, (80, 80, 60), 8, 15, 0.3, 0.3, 180),
    MadeCloud("cumulus", 208, (90, 90, 50), 8, 8, 0.4, 0.5, 15, 1.0, 0.2),
    MadeCloud("cumulus", 209, (100, 100, 80), 8, 20, 0.25, 0.75, 255, 0.995),
    MadeCloud("cumulus", 210, (50, 100, 50), 10, 12, 0.3, 0.5, 140),
    MadeCloud("stratocumulus", 211, (20, 20, 20), 10, 8, 0.8, 0.5, 60),
    MadeCloud("stratocumulus", 212, (30, 30, 20), 10, 12, 0.7, 0.75, 190),
    MadeCloud("stratocumulus", 213, (40, 40, 25), 10, 15, 0.9, 0.3, 330, 0.999),
    MadeCloud("stratocumulus", 214, (50, 50, 20), 10, 10, 0.8, 0.15, 110),
    MadeCloud("stratocumulus", 215, (60, 60, 40), 8, 18, 0.6, 1.0, 0),
    MadeCloud("stratocumulus", 216, (70, 70, 30), 10, 12, 0.85, 0.5, 225, 0.98),
    MadeCloud("stratocumulus", 217, (80, 80, 40), 8, 20, 0.75, 0.3, 20),
    MadeCloud("stratocumulus", 218, (90, 60, 40), 8, 10, 0.7, 0.75, 280, 1.0, 0.3),
    MadeCloud("stratocumulus", 219, (100, 100, 25), 10, 15, 0.8, 0.5, 80, 0.9),
    MadeCloud("stratocumulus", 220, (100, 100, 50), 8, 12, 0.65, 1.0, 0),
]


def write_made(cloud, cloudbow, folder):
    path = folder / f"{cloud.name}.vdb"
    cloudbow.call("cloud", "make", cloud.kind, "--cells", 16, 16, cloud.layers, "--voxel-size-m", *cloud.voxel_m, "--optical-depth", cloud.optical_depth,
                  "--cover", cloud.cover, "--base-m", 3 * cloud.voxel_m[2], "--seed", cloud.seed, "-o", path)
    scene = folder / f"{cloud.name}.toml"
    scene.write_text(support.scene_text([
        ("cloud", {"file": str(path.resolve()), "quantity": "extinction", "single_scattering_albedo": cloud.single_scattering_albedo,
                   "phase_function": "droplets"}),
        ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
        ("sun", {"zenith_deg": support.zenith_deg(cloud.mu0), "azimuth_deg": float(cloud.azimuth_deg), "irradiance_w_m2": 1000 / cloud.mu0}),
        ("surface", {"albedo": cloud.surface_albedo})]))
    return scene


def plan_of(path):
    with h5py.File(path) as file:
        return {name: support.plain(value) for name, value in file["plan"].attrs.items()}, {name: support.plain(value) for name, value in file["error_estimate"].attrs.items()}


def row_of(scene, target, of, cloudbow, folder, truth):
    name, output = scene.stem, folder / "goal.h5"
    output.unlink(missing_ok=True)
    begin = cpu_seconds_of_children()
    done = cloudbow.call("run", scene, "-o", output, "--quiet", "--target-error", f"{target}%", "--of", of,
                         *(("--threads", cloudbow.threads) if cloudbow.threads else ()), *CHEAP, check=False)
    row = {"scene": name, "of": of, "target": target, "cpu_seconds": cpu_seconds_of_children() - begin}
    if done.returncode == 2:
        offered = re.search(r"ask for >= ([0-9.e-]+) %", done.stderr)
        return {**row, "outcome": f"refused: ask for >= {offered[1]} %" if offered else "refused: " + done.stderr.strip()}
    if done.returncode not in (0, 3):
        raise support.Failure(f"{name}: exit code {done.returncode}\n{done.stderr}")
    plan, estimate = plan_of(output)
    domain, up, down = errors_of(support.Result(output, done.returncode, 0, 0), truth)
    with h5py.File(output) as file:
        memory = float(file["solver"].attrs["peak_memory_bytes"].max())
    true = domain if of == "domain" else max(up, down)
    return {**row, "outcome": plan["accuracy"], "estimate": 100 * estimate[of], "true": true, "marked": plan["met"] == 1, "seconds": plan["seconds"],
            "predicted_seconds": plan["predicted_seconds"], "memory": memory, "predicted_memory": plan["predicted_memory_bytes"], "levels": plan["levels_solved"]}


def verdict(row):
    if "true" not in row:
        return "refused"
    if row["true"] <= row["target"]:
        return "met" if row["marked"] else "met, but marked as missed"
    return "missed, and marked so" if not row["marked"] else "MISSED"


def table(rows):
    header = ["scene", "of", "asked for %", "solved", "estimate %", "against `reference` %", "verdict", "time: predicted / s", "memory: predicted / MB"]
    lines = []
    for row in rows:
        if "true" in row:
            lines.append([row["scene"], row["of"], row["target"], row["levels"], f"{row['estimate']:.2g}", f"{row['true']:.2g}", verdict(row),
                          f"{row['predicted_seconds']:.2g} / {row['seconds']:.2g}", f"{row['predicted_memory'] / 1e6:.0f} / {row['memory'] / 1e6:.0f}"])
        else:
            lines.append([row["scene"], row["of"], row["target"], row["outcome"], "", "", verdict(row), "", ""])
    return support.markdown_table(header, lines)


def tally(rows):
    solved = [row for row in rows if "true" in row]
    timed = [row for row in solved if row["seconds"] >= JUDGED_SECONDS and row["outcome"] != "draft"]
    in_time = sum(0.5 <= row["predicted_seconds"] / row["seconds"] <= 2 for row in timed)
    in_memory = sum(abs(row["predicted_memory"] / row["memory"] - 1) <= 0.15 for row in solved)
    met = sum(row["true"] <= row["target"] for row in solved)
    return (f"{len(solved)} of {len(rows)} solved, the others refused; {met} of these within what was asked for, against `reference`. Time within a factor of 2 in {in_time} of {len(timed)} "
            f"(levels above `draft` of {JUDGED_SECONDS} s and more), memory within 15 % in {in_memory} of {len(solved)}.")


def level_row(scene, level, cloudbow, folder, truth):
    """Of one level: CPU seconds of the process, and true errors of domain, columns up and columns down [%]."""
    begin = cpu_seconds_of_children()
    result = cloudbow.run(scene, folder / "level.h5", "--set", f"solver.accuracy={level}", *CHEAP, accept=(0, 3))
    return (cpu_seconds_of_children() - begin, *errors_of(result, truth))


def off_the_front(levels):
    """Levels that another beats in columns up and down at no more CPU time."""
    better = lambda a, b: a is not b and a[0] <= b[0] and a[2] <= b[2] and a[3] <= b[3]
    return [name for name, row in levels.items() if any(better(other, row) for other in levels.values())]


def made_table(rows, levels):
    header = ["cloud", "voxel m", "mu0", "ssa", "asked for %", "solved, or refused", "told %", "true %", "verdict", "CPU s",
              *(f"{name}: up / down %, CPU s" for name in LEVELS), "fine better than balanced", "off the front"]
    lines = []
    for cloud in MADE:
        for row in (row for row in rows if row["scene"] == cloud.name):
            of_levels = levels[cloud.name]
            told, true = (f"{row['estimate']:.2g}", f"{row['true']:.2g}") if "true" in row else ("", "")
            better = [name for name, n in (("up", 2), ("down", 3)) if of_levels["fine"][n] < of_levels["balanced"][n]]
            lines.append([cloud.name, " x ".join(map(str, cloud.voxel_m)), cloud.mu0, cloud.single_scattering_albedo, row["target"],
                          row["levels"] if "true" in row else row["outcome"], told, true, verdict(row), f"{row['cpu_seconds']:.1f}",
                          *(f"{of_levels[name][2]:.2f} / {of_levels[name][3]:.2f}, {of_levels[name][0]:.2f}" for name in LEVELS),
                          ", ".join(better) or "no", ", ".join(off_the_front(of_levels)) or "none"])
    return support.markdown_table(header, lines)


def of_made_clouds(options, cloudbow, folder):
    """Rows of the targets, printed with the levels of each cloud."""
    rows, levels = [], {}
    by_name = {cloud.name: cloud for cloud in MADE}
    if unknown := set(options.scenes) - set(by_name):
        raise SystemExit(f"unknown cloud {', '.join(sorted(unknown))} (there are {', '.join(by_name)})")
    for name in options.scenes or by_name:
        cloud = by_name[name]
        scene = write_made(cloud, cloudbow, folder)
        # 1e-4 is far below the errors that are looked for, and spares half of the sweeps.
        truth = cloudbow.run(scene, folder / f"{cloud.name}.h5", "--set", "solver.accuracy=reference", "--set", "solver.tolerance=1e-4", *CHEAP, accept=(0, 3))
        levels[cloud.name] = {level: level_row(scene, level, cloudbow, folder, truth) for level in LEVELS}
        print(cloud.name, {level: [round(value, 3) for value in row] for level, row in levels[cloud.name].items()}, flush=True)
        for of in options.of:
            for target in options.target:
                rows.append(row_of(scene, target, of, cloudbow, folder, truth))
                print(cloud.name, of, target, verdict(rows[-1]), rows[-1], flush=True)
    print(made_table(rows, levels))
    return rows


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    parser.add_argument("--target", nargs="+", type=float, default=[5, 1, 0.3], help="per cent")
    parser.add_argument("--of", nargs="+", default=["domain", "columns"], choices=["domain", "columns"])
    parser.add_argument("--made", action="store_true", help="made clouds in place of configs/")
    parser.add_argument("--document", type=Path, help="write the tally between the markers `goals` of this page")
    options = parser.parse_args()
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    rows = []
    with support.Workspace(options.keep) as folder:
        if options.made:
            rows = of_made_clouds(options, cloudbow, folder)
        for name in () if options.made else options.scenes or SCENES:
            scene = ROOT / f"configs/{name}.toml"
            truth = cloudbow.run(scene, folder / f"{name}.h5", "--set", "solver.accuracy=reference", *CHEAP, accept=(0, 3))
            for of in options.of:
                for target in options.target:
                    rows.append(row_of(scene, target, of, cloudbow, folder, truth))
                    print(name, of, target, verdict(rows[-1]), {key: value for key, value in rows[-1].items() if key not in ("scene", "of", "target")}, flush=True)
    print(table(rows) + "\n" + tally(rows) + "\n")
    if options.document:
        support.write_between_markers(options.document, "goals", tally(rows))
    return 1 if any(verdict(row) == "MISSED" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
