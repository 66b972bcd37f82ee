#!/usr/bin/env python3
"""Radiances of plane-parallel scenes against tabulated discrete-ordinate solutions: up at the top and down at the bottom, cosines .3 to 1, in the
sun's plane ahead and behind and across it.

Truth: the radiances of the reference file (its own error is given there case by case, mostly below 1e-3). Errors are relative, in per cent. A sign
error in an azimuth would exchange the forward and the backward half-plane, whose radiances differ by factors.

usage: CLOUDBOW_REFERENCE_DIR=... plane_parallel_radiance.py [--reference plane_parallel.json] [--accuracy fine] [--cases PATTERN] [--median-limit 0.5] [--worst-limit 3]
"""
import fnmatch
import json
import sys
from pathlib import Path

import plane_parallel
import support
from support import ROOT

COSINES = (0.1, 0.3, 0.5, 0.7, 0.9, 1.0)  # rows of the reference's tables
AZIMUTHS = (0.0, 90.0, 180.0)
LEAST_COSINE = 0.3
LEAST_RADIANCE = 1e-6  # of the incident flux: below it a relative error says nothing


def views():
    """(name, table of the reference, row, column, zenith of the sensor, its azimuth): the reference's azimuth is that of travel."""
    for side, key in (("top", "radiance_up_top"), ("bottom", "radiance_down_bottom")):
        for i, mu in enumerate(COSINES):
            if mu < LEAST_COSINE:
                continue
            for j, azimuth in enumerate(AZIMUTHS):
                zenith = support.zenith_deg(mu)
                yield f"{side}_{i}_{j}", key, i, j, zenith if side == "top" else 180 - zenith, azimuth


def solve_case(case, options, cloudbow, folder):
    text, _ = plane_parallel.layers_scene(case, options.accuracy, options.moments)
    text += "\n" + support.scene_text([("[radiance]", {"name": name, "zenith_deg": zenith, "azimuth_deg": azimuth})
                                       for name, _, _, _, zenith, azimuth in views()])
    scene = folder / f"{case['id']}.toml"
    scene.write_text(text)
    result = cloudbow.run(scene, folder / f"{case['id']}.h5", *[word for key in options.set for word in ("--set", key)], accept=(0, 3))
    found = []
    for name, key, i, j, _, _ in views():
        reference = case["results"][key][i][j]
        if reference > LEAST_RADIANCE:
            found.append((100 * (result[f"radiance_{name}"].item() / reference - 1), name))
    return {"case": case["id"], "errors": found, "truth": truth_error(case)}


def truth_error(case):
    """The reference's own, in per cent: its largest relative difference to half the streams."""
    return max((100 * value for key, value in case["est"].items() if key.startswith("rad") and key.endswith("rel") and value is not None), default=None)


def judged(case):
    """Cases that the goals are for: Henyey-Greenstein of g up to .85 and gentler ones, not thinner than .1."""
    return case["id"][0] in "abcd" and sum(layer["tau"] for layer in case["layers"]) >= 0.1


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    default = support.reference_folder()
    parser.add_argument("--reference", type=Path, default=default / "plane_parallel.json" if default else None)
    parser.add_argument("--moments", type=Path, default=ROOT / "tests/data/c1_legendre.txt")
    parser.add_argument("--accuracy", default="fine")
    parser.add_argument("--cases", default="*", help="shell pattern of case names, several separated by commas")
    parser.add_argument("--median-limit", type=float, default=0.5)
    parser.add_argument("--worst-limit", type=float, default=3.0)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="a key of the scene for all cases")
    parser.add_argument("--jobs", type=int, default=2)
    return parser


def figures(options):
    """A row for every case: (relative error in per cent, view) of each radiance that is worth comparing."""
    if options.reference is None:
        support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with plane_parallel.json (tests/data holds no radiances)")
    cases = [case for case in json.loads(options.reference.read_text())["cases"]
             if case["thermal"] is None and case["F0"] > 0 and any(fnmatch.fnmatch(case["id"], pattern) for pattern in options.cases.split(","))]
    cloudbow = support.Cloudbow(options.cloudbow, options.threads or 1)
    with support.Workspace(options.keep) as folder:
        rows = support.in_parallel(options.jobs, lambda case: solve_case(case, options, cloudbow, folder), cases)
    for row, case in zip(rows, cases):
        row["judged"] = judged(case)
    return rows


def main():
    options = arguments().parse_args()
    rows = figures(options)
    selections = [(plane_parallel.group_name(group), [r for r in rows if r["case"][0] == group]) for group in sorted({row["case"][0] for row in rows})]
    goal = [row for row in rows if row["judged"]]
    selections.append(("**a to d, optical depth from .1**", goal))
    table = []
    for title, of_group in selections:
        errors = [(abs(error), row["case"], name) for row in of_group for error, name in row["errors"]]
        if not errors:
            continue
        worst = max(errors)
        values = sorted(e[0] for e in errors)
        table.append([title, len(of_group), f"{support.median(values):.3f}", f"{values[int(0.95 * (len(values) - 1))]:.2f}", f"{worst[0]:.2f}",
                      f"`{worst[1]}`, {worst[2]}"])
    text = support.markdown_table(["group", "cases", "median %", "95th percentile %", "worst %", "where"], table)
    print(text)
    errors = [abs(error) for row in goal for error, _ in row["errors"]]
    # Of cases of one's own none is judged.
    return 1 if errors and (support.median(errors) > options.median_limit or max(errors) > options.worst_limit) else 0


if __name__ == "__main__":
    sys.exit(main())
