#!/usr/bin/env python3
"""`cloudbow tradeoff` on the step cloud: table, CSV and plot, that its errors are those of the results themselves, and `run --compare`.

Truth: the result files of `cloudbow run` at the same levels, compared here once more. Solutions are the same bit by bit in every run. So the errors agree to rounding, and those of a result against itself are 0.

usage: tradeoff_command.py
       tradeoff_command.py --document docs/accuracy.md   remakes the tables and plots of that page
"""
import csv
import math
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np

import support
from support import ROOT, Failure

SCENE = ROOT / "configs/step_cloud.toml"
ERRORS = ("domain_error_percent", "column_up_error_percent", "column_down_error_percent")
ROUNDING = 1e-9  # relative: sums over columns in another order
DOCUMENTED = ("cumulus",)  # of configs/


def tradeoff(cloudbow, folder, name, *options, scene=SCENE, accept=(0,)):
    """The printed table and the rows of the CSV by level."""
    table = folder / f"{name}.csv"
    done = cloudbow.call("tradeoff", scene, "--quiet", "--csv", table, *options, check=False)
    if done.returncode not in accept:
        raise Failure(f"{name}: exit code {done.returncode}\n{done.stderr}")
    with open(table) as file:
        return done.stdout, {row["level"]: row for row in csv.DictReader(file)}


def errors_of(result, truth):
    up, down = (result.upward_at_top(), truth.upward_at_top()), (result.downward_at_bottom(), truth.downward_at_bottom())
    domain = max(abs(result.summary[name] - truth.summary[name]) for name in ("reflectance", "transmittance"))
    return 100 * domain, support.rms_percent(*up), support.rms_percent(*down)


def check(good, message):
    if not good:
        raise Failure(message)
    print(f"ok    {message}", flush=True)


def two_levels(cloudbow, folder):
    plot = folder / "plot.png"
    table, rows = tradeoff(cloudbow, folder, "levels", "--levels", "draft,balanced", "--plot", plot)
    check(list(rows) == ["draft", "balanced"], f"one row a level: {list(rows)}")
    lines = {line.split()[0]: line for line in table.splitlines() if line.startswith(("draft", "balanced"))}
    check("truth" in lines["balanced"] and lines["draft"].count("*") == 3, "the table tells the truth and the front")
    check(all(rows["balanced"][name] == "" for name in ERRORS), "the truth has no errors")
    check(plot.read_bytes().startswith(b"\x89PNG"), "the plot is a PNG")
    results = {level: cloudbow.run(SCENE, folder / f"{level}.h5", "--set", f"solver.accuracy={level}") for level in rows}
    expected = errors_of(results["draft"], results["balanced"])
    found = [float(rows["draft"][name]) for name in ERRORS]
    check(np.allclose(found, expected, rtol=ROUNDING), f"errors of draft {found} are those of the results {expected}")
    for level, result in results.items():
        check(int(rows[level]["sweeps"]) == result.solver["sweeps"], f"{level}: {rows[level]['sweeps']} sweeps")
        # Own processes: the memory of one level is not that of a dearer one, nor of the program that started it.
        memory = float(rows[level]["peak_memory_bytes"])
        check(math.isclose(memory, result.peak_memory_bytes, rel_tol=0.1), f"{level}: {memory:.3g} bytes at its peak, as a run by itself")


def against_a_file(cloudbow, folder):
    _, rows = tradeoff(cloudbow, folder, "file", "--levels", "draft,balanced", "--reference", folder / "balanced.h5")
    check(all(float(rows["balanced"][name]) == 0 for name in ERRORS), "a result has no errors against itself")
    check(all(float(rows["draft"][name]) > 0 for name in ERRORS), "another has")


def independent_columns(cloudbow, folder):
    _, rows = tradeoff(cloudbow, folder, "columns", "--levels", "draft,independent-columns")
    error = float(rows["independent-columns"]["column_down_error_percent"])
    check(list(rows) == ["independent-columns", "draft"] and error > 10, f"independent columns miss the sideways light: {error:.0f} %")


def images(cloudbow, folder):
    """Columns under a slanted beam have no images."""
    table, rows = tradeoff(cloudbow, folder, "images", "--set", 'radiance=[{name="nadir",zenith_deg=0.0}]')
    note = next((line for line in table.splitlines() if line.startswith("independent-diffuse")), "")
    check(list(rows) == ["independent-columns", "draft", "balanced", "fine", "reference"] and "left out" in note and "[[radiance]]" in note,
          f"the level that cannot make images is left out: {note}")


def compared_in_one_run(cloudbow, folder):
    """`run --compare` holds what two runs give."""
    name = "upwelling_flux"
    both = cloudbow.run(SCENE, folder / "both.h5", "--compare")
    columns = cloudbow.run(SCENE, folder / "columns.h5", "--set", "solver.mode=independent-columns")
    difference = both.fields[name] - columns.fields[name]
    check(np.array_equal(both.fields[f"difference_{name}"], difference) and abs(difference).max() > 0.1, "the difference is that of two runs, bit by bit")


def not_converged(cloudbow, folder):
    table, rows = tradeoff(cloudbow, folder, "short", "--levels", "draft,balanced", "--set", "solver.max_sweeps=2", accept=(3,))
    check(table.count("NOT CONVERGED") == 2 and rows["draft"]["converged"] == "0", "what did not converge is marked")


def interrupted(cloudbow, folder):
    scratch = folder / "scratch"
    scratch.mkdir()
    command = [cloudbow.program, "tradeoff", str(ROOT / "configs/cumulus.toml"), "--threads", "1"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=os.environ | {"TMPDIR": str(scratch)}) as process:
        for line in process.stderr:
            if line.startswith("sweep"):
                break
        there = any(scratch.iterdir())
        process.terminate()  # this process alone: it must end its child
        process.communicate()
    check(process.returncode == 128 + signal.SIGTERM and there and not any(scratch.iterdir()), "a signal ends it and leaves nothing")


def document(path, cloudbow):
    for name in DOCUMENTED:
        plot = path.parent / "images" / f"tradeoff_{name}.png"
        done = cloudbow.call("tradeoff", ROOT / "configs" / f"{name}.toml", "--quiet", "--threads", 1, "--plot", plot)
        support.write_between_markers(path, name, f"```\n{done.stdout.strip()}\n```")
        print(done.stdout, flush=True)


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--document", type=Path, help="remake the tables and plots of this page instead")
    options = parser.parse_args()
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    if options.document:
        document(options.document, cloudbow)
        return 0
    with support.Workspace(options.keep) as folder:
        try:
            for part in (two_levels, against_a_file, independent_columns, images, compared_in_one_run, not_converged, interrupted):
                part(cloudbow, folder)
        except Failure as failure:
            print(f"FAIL  {failure}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
