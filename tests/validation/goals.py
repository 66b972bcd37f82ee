#!/usr/bin/env python3
"""`cloudbow run --target-error` on the scenes of configs/: whether what was asked for is met or refused, and whether time and memory are as foreseen.

Truth: the result at `reference`, whose own distance from the truth (docs/validation.md) is no part of it. Time and memory are those of the level's own
solve, against what was predicted before it (`/plan`); seconds of solves under a fifth of a second are not judged.

usage: goals.py [SCENE ...] [--target 5 1 0.3] [--of domain columns] [--document docs/accuracy.md]
"""
import re
import sys
from pathlib import Path

import h5py

import support
from support import ROOT
from tradeoff_command import errors_of

SCENES = ("cumulus", "stratocumulus", "step_cloud", "slab", "layers", "mie_cumulus", "ocean", "single_cloud_open")
JUDGED_SECONDS = 0.2
CHEAP = ("--set", "output.flux_levels=boundaries", "--set", 'output.fields=["fluxes"]')


def plan_of(path):
    with h5py.File(path) as file:
        return {name: support.plain(value) for name, value in file["plan"].attrs.items()}, {name: support.plain(value) for name, value in file["error_estimate"].attrs.items()}


def row_of(name, target, of, cloudbow, folder, truth):
    output = folder / "goal.h5"
    output.unlink(missing_ok=True)
    done = cloudbow.call("run", ROOT / f"configs/{name}.toml", "-o", output, "--quiet", "--target-error", f"{target}%", "--of", of,
                         *(("--threads", cloudbow.threads) if cloudbow.threads else ()), *CHEAP, check=False)
    row = {"scene": name, "of": of, "target": target}
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


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    parser.add_argument("--target", nargs="+", type=float, default=[5, 1, 0.3], help="per cent")
    parser.add_argument("--of", nargs="+", default=["domain", "columns"], choices=["domain", "columns"])
    parser.add_argument("--document", type=Path, help="write the tally between the markers `goals` of this page")
    options = parser.parse_args()
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    rows = []
    with support.Workspace(options.keep) as folder:
        for name in options.scenes or SCENES:
            truth = cloudbow.run(ROOT / f"configs/{name}.toml", folder / f"{name}.h5", "--set", "solver.accuracy=reference", *CHEAP, accept=(0, 3))
            for of in options.of:
                for target in options.target:
                    rows.append(row_of(name, target, of, cloudbow, folder, truth))
                    print(name, of, target, verdict(rows[-1]), {key: value for key, value in rows[-1].items() if key not in ("scene", "of", "target")}, flush=True)
    print(table(rows) + "\n" + tally(rows) + "\n")
    if options.document:
        support.write_between_markers(options.document, "goals", tally(rows))
    return 1 if any(verdict(row) == "MISSED" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
