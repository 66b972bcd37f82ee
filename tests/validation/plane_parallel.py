#!/usr/bin/env python3
"""Plane-parallel scenes against tabulated discrete-ordinate solutions.

Each case becomes a scene file and goes through the program as a user's would: as layers (solved as one column), or with --voxels as a
uniform slab of 4 x 4 x N voxels in a VDB file, solved in 3D. Truth: the fluxes of the reference file, whose own error is given there
case by case (median 2e-9 of the incident flux). Errors are in per cent of the incident flux.

New truths for cases of one's own, without any file from elsewhere, come from tests/reference/plane_parallel (adding and doubling): it prints a
reference file of the same form, for --reference.

usage: plane_parallel.py [--reference plane_parallel.json] [--accuracy fine] [--cases PATTERN] [--voxels] [--limit 0.5]
"""
import fnmatch
import json
import math
import sys
from pathlib import Path

import numpy as np

import support
from support import ROOT, Failure

GROUPS = {
    "a": "isotropic scattering",
    "b": "Rayleigh",
    "c": "HG .75",
    "d": "HG .85",
    "e": "extremes: tau 1e-6 to 1e4, g -.9 to .98, mu0 .01 and .05",
    "f": "several layers",
    "g": "C.1 cloud droplets",
    "i": "sky light",
}
FLUXES = {"flux_up": "upwelling_flux", "flux_down_diffuse": "downwelling_diffuse_flux", "flux_down_direct": "direct_flux"}
SCENE_HEIGHT_M = 1000.0


def phase_function(phase, moments_file):
    """Name and, unless built in, table of a reference case's phase function."""
    if phase["type"] == "iso":
        return "isotropic", None
    if phase["type"] == "rayleigh":
        return "rayleigh", None
    if phase["type"] == "hg":
        name = f"hg_{phase['g']}".replace(".", "_").replace("-", "minus_")
        return name, {"type": "henyey-greenstein", "asymmetry_parameter": phase["g"]}
    if phase["type"] == "c1":
        return "c1", {"type": "legendre", "file": str(moments_file)}
    if phase["type"] == "legendre":
        file = Path(phase["file"]).resolve()
        return f"legendre_{''.join(c if c.isalnum() else '_' for c in str(file))}", {"type": "legendre", "file": str(file)}
    raise ValueError(f"phase function {phase}")


def slices(case):
    """The layers cut at the levels of the reference, top to bottom: (layer, optical depth, thickness in metres).

    A slice's share of its layer's height is its share of the layer's optical depth; a layer without extinction stays whole. All layers are equally high. So all levels are apart by much more than the rounding of heights.
    """
    levels = [level["tau"] for level in case["results"]["levels"]]
    height = SCENE_HEIGHT_M / len(case["layers"])
    found, top = [], 0.0
    for layer in case["layers"]:
        tau = layer["tau"]
        bottom = top + tau
        if tau == 0:
            found.append((layer, 0.0, height))
        else:
            inside = [t for t in levels if top + 1e-9 * tau < t < bottom - 1e-9 * tau]
            edges = [top, *inside, bottom]
            found += [(layer, b - a, height * (b - a) / tau) for a, b in zip(edges, edges[1:])]
        top = bottom
    return found


def common_tables(case):
    tables = []
    if case["F0"] > 0:
        # The reference's light travels towards +x, so its sun stands at azimuth 180.
        tables.append(("sun", {"zenith_deg": support.zenith_deg(case["mu0"]), "azimuth_deg": 180.0, "irradiance_w_m2": case["F0"]}))
    if case["isotropic_top"] > 0:
        tables.append(("sky", {"radiance_w_m2_sr": case["isotropic_top"]}))
    tables.append(("surface", {"type": "lambertian", "albedo": case["surface_albedo"]}))
    return tables


def phase_tables(case, moments_file):
    named = dict(phase_function(layer["phase"], moments_file) for layer in case["layers"])
    return [(f"phase_function.{name}", keys) for name, keys in named.items() if keys]


def layers_scene(case, accuracy, moments_file):
    """Scene of one column, and the height of every reference level."""
    tables = [("", {"title": case["id"]})]
    z = SCENE_HEIGHT_M
    heights, tau_here = [(0.0, z)], 0.0
    for number, (layer, tau, thickness) in enumerate(slices(case)):
        bottom = z - thickness
        if number == len(slices(case)) - 1:
            bottom = 0.0
        tables.append(("[layer]", {
            "name": f"slice {number}", "bottom_m": bottom, "top_m": z, "optical_depth": tau, "single_scattering_albedo": layer["ssa"],
            "phase_function": phase_function(layer["phase"], moments_file)[0]}))
        z, tau_here = bottom, tau_here + tau
        heights.append((tau_here, z))
    tables += phase_tables(case, moments_file) + common_tables(case)
    tables.append(("solver", {"accuracy": accuracy}))
    return support.scene_text(tables), heights


def voxel_count(case, tau_per_voxel):
    """A multiple of 20, so that all levels of the reference (tenths and quarters) fall on voxel faces.

    A voxel's light is known by its mean and slope, so it must be thin for the sunlight that falls off in it: on the sun's slanted path it has at
    most twice the optical depth asked for. (Layers are cut so by the program itself; voxels are the user's.)"""
    if case["F0"] > 0:
        tau_per_voxel = min(tau_per_voxel, 2 * case["mu0"] * tau_per_voxel)
    return 20 * min(100, max(1, math.ceil(case["layers"][0]["tau"] / tau_per_voxel / 20)))


def voxels_scene(case, accuracy, moments_file, cloudbow, folder, tau_per_voxel):
    """Scene with a uniform slab of cubic voxels, and the height of every reference level."""
    layer, = case["layers"]
    n = voxel_count(case, tau_per_voxel)
    size = SCENE_HEIGHT_M / n
    cloud = folder / f"{case['id']}.vdb"
    cloudbow.call("cloud", "make", "slab", "--cells", 4, 4, n, "--voxel-size-m", size, size, size,
                  "--optical-depth", repr(layer["tau"]), "-o", cloud)
    name, keys = phase_function(layer["phase"], moments_file)
    tables = [("", {"title": case["id"]}),
              ("cloud", {"file": str(cloud), "quantity": "extinction", "single_scattering_albedo": layer["ssa"], "phase_function": name})]
    tables += phase_tables(case, moments_file) + common_tables(case)
    tables.append(("solver", {"accuracy": accuracy, "mode": "3d"}))
    heights = [(level["tau"], SCENE_HEIGHT_M * (1 - level["tau"] / layer["tau"])) for level in case["results"]["levels"]]
    return support.scene_text(tables), heights


def height_of(tau, heights):
    return min(heights, key=lambda pair: abs(pair[0] - tau))[1]


def errors(case, result, heights):
    """Differences in per cent of the incident flux; the profile's is the worst over levels and the three fluxes."""
    incident = case["mu0"] * case["F0"] + math.pi * case["isotropic_top"]
    z_edge = result.z_edge

    def difference(level, ours, theirs):
        z = height_of(level["tau"], heights)
        k = int(np.argmin(np.abs(z_edge - z)))
        if abs(z_edge[k] - z) > 1e-6 * SCENE_HEIGHT_M:
            raise Failure(f"{case['id']}: no level at {z} m in the result")
        return 100 * abs(result.profile[ours][k] - level[theirs]) / incident

    levels = case["results"]["levels"]
    return {
        "truth": 100 * case["est"]["flux_abs"] / incident,
        "up": difference(levels[0], "upwelling_flux", "flux_up"),
        "diffuse": difference(levels[-1], "downwelling_diffuse_flux", "flux_down_diffuse"),
        "direct": difference(levels[-1], "direct_flux", "flux_down_direct"),
        "profile": max(difference(level, ours, theirs) for level in levels for theirs, ours in FLUXES.items()),
        "ledger": abs(result.summary["energy_residual"]),
    }


def solve_case(case, options, cloudbow, folder):
    make = (lambda: voxels_scene(case, options.accuracy, options.moments, cloudbow, folder, options.voxel_optical_depth)) \
        if options.voxels else (lambda: layers_scene(case, options.accuracy, options.moments))
    text, heights = make()
    scene = folder / f"{case['id']}.toml"
    scene.write_text(text)
    settings = [argument for setting in options.set for argument in ("--set", setting)]
    result = cloudbow.run(scene, folder / f"{case['id']}.h5", *settings, accept=(0, 3))
    return {"case": case["id"], "converged": result.exit_code == 0, "sweeps": result.solver["sweeps"],
            "seconds": result.cpu_seconds, **errors(case, result, heights)}


def line(row):
    if "failure" in row:
        return f"{row['case']}: {row['failure']}"
    return (f"{row['case']:48s} up {row['up']:.4f}  diffuse {row['diffuse']:.4f}  direct {row['direct']:.4f}  profile {row['profile']:.4f}  "
            f"ledger {row['ledger']:.1e}  sweeps {row['sweeps']}  {row['seconds']:.2f} s{'' if row['converged'] else '  NOT CONVERGED'}")


def group_name(letter):
    """Of the first letter of a case; cases of one's own have none of these."""
    return f"{GROUPS[letter]} ({letter})" if letter in GROUPS else letter


def percent(value, digits):
    """A number for the table; a solution that ran away is not worth its digits."""
    return f"{value:.{digits}f}" if value < 100 else "> 100"


def over_limits(row, options):
    # Rounding decides how far a solve comes that says that it did not converge: .6 or 1.1 % inside, by compiler options.
    inside = (options.profile_limit or options.limit) * (1 if row["converged"] else 2)
    return max(row["up"], row["diffuse"], row["direct"]) > options.limit or row["profile"] > inside


def report(rows, options):
    """The table by group, and what is over the limit by name."""
    table = []
    groups = sorted({row["case"][0] for row in rows})
    for group in [*groups, None]:
        of_group = [row for row in rows if group in (None, row["case"][0])]
        worst = max(of_group, key=lambda row: row["profile"])
        cells = [group_name(group) if group else "**all**", len(of_group)]
        for quantity in ("up", "diffuse", "direct", "profile"):
            values = [row[quantity] for row in of_group]
            cells.append(f"{percent(max(values), 3)} / {percent(support.median(values), 4)}")
        table.append([*cells, f"`{worst['case']}`"])
    text = support.markdown_table(["group", "cases", "up at top", "diffuse down at bottom", "direct down at bottom", "whole profile", "worst case"],
                                  table)
    over = sorted((row for row in rows if over_limits(row, options)), key=lambda row: -row["profile"])
    if over:
        text += f"\nOver {options.limit} % at top or bottom, or {options.profile_limit or options.limit} % inside: " + ", ".join(f"`{row['case']}` {percent(row['profile'], 2)}" for row in over) + ".\n"
    else:
        text += f"\nNone is over {options.limit} % at top or bottom, or {options.profile_limit or options.limit} % inside.\n"
    unfinished = [row["case"] for row in rows if not row["converged"]]
    if unfinished:
        text += "\nNot converged: " + ", ".join(f"`{case}`" for case in unfinished) + ".\n"
    return text


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    default = support.reference_folder()
    parser.add_argument("--reference", type=Path, default=default / "plane_parallel.json" if default else ROOT / "tests/data/plane_parallel_subset.json")
    parser.add_argument("--moments", type=Path, default=ROOT / "tests/data/c1_legendre.txt", help="Legendre moments of the C.1 phase function")
    parser.add_argument("--accuracy", default="balanced")
    parser.add_argument("--cases", default="*", help="shell pattern of case names, several separated by commas")
    parser.add_argument("--voxels", action="store_true", help="single-layer cases as VDB slabs of 4 x 4 x N voxels, solved in 3D")
    parser.add_argument("--voxel-optical-depth", type=float, default=0.5, help="largest optical depth of a voxel, as long as 2000 of them are enough")
    parser.add_argument("--limit", type=float, default=0.5, help="largest error allowed at top and bottom, in %% of the incident flux")
    parser.add_argument("--profile-limit", type=float, help="largest error allowed inside (default: as --limit)")
    parser.add_argument("--may-stall", default="", metavar="PATTERN", help="cases that need not converge, as long as the result says so and the errors are within limits")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="passed on to `cloudbow run`")
    parser.add_argument("--jobs", type=int, default=2, help="scenes at a time")
    return parser


def figures(options):
    """A row for every case: its errors in per cent, or how it failed."""
    cases = [case for case in json.loads(options.reference.read_text())["cases"]
             if case["thermal"] is None and any(fnmatch.fnmatch(case["id"], pattern) for pattern in options.cases.split(","))]
    if options.voxels:
        cases = [case for case in cases if len(case["layers"]) == 1]
    if not cases:
        sys.exit(f"no case matches {options.cases}")

    cloudbow = support.Cloudbow(options.cloudbow, options.threads or 1)
    with support.Workspace(options.keep) as folder:
        def attempt(case):
            try:
                row = solve_case(case, options, cloudbow, folder)
            except Failure as failure:
                row = {"case": case["id"], "failure": str(failure)}
            print(line(row), flush=True)
            return row
        return support.in_parallel(options.jobs, attempt, cases)


def main():
    options = arguments().parse_args()
    start = support.now()
    rows = figures(options)
    failed = [row for row in rows if "failure" in row]
    rows = [row for row in rows if "failure" not in row]
    if not rows:
        return 1
    text = report(rows, options)
    print(f"\n{text}\n{len(rows)} cases in {support.now() - start:.0f} s; worst energy residual {max(row['ledger'] for row in rows):.1e}")
    good = not failed and all(not over_limits(row, options) and (row["converged"] or fnmatch.fnmatch(row["case"], options.may_stall)) and row["ledger"] <= 1e-5
                              for row in rows)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
