#!/usr/bin/env python3
"""The two truths of plane-parallel scenes against each other: discrete ordinates (the reference file) and adding and doubling
(tests/reference/plane_parallel), which share neither method nor code.

Fluxes of every case, in per cent of the incident flux: up at the top, diffuse down at the bottom; radiances, relative, if the file has them.
In cases with emission, the largest flux of a black body is incident too.

usage: plane_parallel_truths.py [--reference plane_parallel.json] [--radiances 'b_*,c_*'] [--limit 1e-4]
"""
import fnmatch
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

import support
from support import ROOT, Failure

LEAST_RADIANCE = 1e-6  # as in plane_parallel_radiance.py


def phase_words(phase, moments_file):
    """A phase function of the reference file in the words of the program."""
    return {"iso": ["isotropic"], "rayleigh": ["rayleigh"], "hg": ["henyey-greenstein", phase.get("g")], "c1": ["legendre", moments_file]}[phase["type"]]


def words(case, moments_file):
    found = ["sun", case["mu0"] or 1, "irradiance", case["F0"], "sky", case["isotropic_top"], "surface_albedo", case["surface_albedo"]]
    for layer in case["layers"]:
        found += ["layer", layer["tau"], layer["ssa"], *phase_words(layer["phase"], moments_file)]
    if case["thermal"]:
        found += ["source_at_interfaces", *case["thermal"]["source_at_interfaces"], "surface_source", case["thermal"]["surface_source"]]
    return found


def solve(program, *arguments):
    """The one case of what tests/reference/plane_parallel prints."""
    done = subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise Failure(done.stderr)
    return json.loads(done.stdout)["cases"][0]


def compare(case, options):
    wants_radiances = any(fnmatch.fnmatch(case["id"], pattern) for pattern in options.radiances.split(",")) and "radiance_up_top" in case["results"]
    other = solve(options.plane_parallel, *words(case, options.moments), "radiances", int(wants_radiances))
    incident = case["mu0"] * case["F0"] + math.pi * case["isotropic_top"]
    if case["thermal"]:
        incident += math.pi * max(case["thermal"]["source_at_interfaces"])
    ends = [(case["results"]["levels"][n], other["results"]["levels"][n]) for n in (0, -1)]
    row = {"case": case["id"], "flux": 100 * max(abs(a[key] - b[key]) for a, b in ends for key in ("flux_up", "flux_down_diffuse")) / incident,
           "ordinates": 100 * case["est"]["flux_abs"] / incident, "adding": 100 * other["est"]["flux_abs"] / incident, "radiances": []}
    if wants_radiances:
        for key in ("radiance_up_top", "radiance_down_bottom"):
            a, b = np.array(case["results"][key]), np.array(other["results"][key])
            row["radiances"] += list(100 * abs(b / a - 1)[a > LEAST_RADIANCE])
    print(f"{row['case']:48s} {row['flux']:.2e}  (own: {row['ordinates']:.0e}, {row['adding']:.0e})"
          + (f"  radiances {max(row['radiances']):.2e}" if row["radiances"] else ""), flush=True)
    return row


def add_program(parser):
    """The option for the program of tests/reference: beside cloudbow's own build unless said otherwise."""
    folder = Path(os.environ.get("CLOUDBOW_TEST_PROGRAMS", ROOT / "build/release/tests/reference"))
    parser.add_argument("--plane-parallel", type=Path, default=folder / "plane_parallel", metavar="PROGRAM", help="of tests/reference")


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    default = support.reference_folder()
    parser.add_argument("--reference", type=Path, default=default / "plane_parallel.json" if default else ROOT / "tests/data/plane_parallel_subset.json")
    parser.add_argument("--moments", type=Path, default=ROOT / "tests/data/c1_legendre.txt")
    parser.add_argument("--radiances", default="b_*,c_*,d_*mu0.5_A0.2,h_*", help="shell patterns of the cases whose radiances are compared")
    parser.add_argument("--limit", type=float, default=1e-4, help="in %% of the incident flux, beside what both say of themselves")
    add_program(parser)
    return parser


def figures(options):
    """A row for every case: the difference, and what each of the two says of itself."""
    return [compare(case, options) for case in json.loads(options.reference.read_text())["cases"]]


def is_good(row, limit):
    return row["flux"] <= limit + row["ordinates"] + row["adding"]


def main():
    options = arguments().parse_args()
    rows = figures(options)
    bad = [row["case"] for row in rows if not is_good(row, options.limit)]
    print(f"{len(rows)} cases: median {support.median([row['flux'] for row in rows]):.1e}, worst {max(row['flux'] for row in rows):.1e} %; apart: {', '.join(bad) or 'none'}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
