#!/usr/bin/env python3
"""Droplets that vary in space: what few size classes change against a class for every row of a fine droplet table.

A made-up LES file (scripts/examples/make_les_file.py) is imported, water content and effective radius, and solved with a Mie table of fine
steps: once with the classes that `balanced` chooses, once with every row that the field uses (`class_tolerance = 0`). The difference of
reflectance, transmittance and absorptance must stay below the limit, and below twice what the program itself estimates.

usage: droplet_classes.py --cloudbow PROGRAM [--wavelength-um 2.13] [--step-um 0.5] [--limit 0.1]
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import support
from support import ROOT, Result

SCENE = """\
[cloud]
file = "les.vdb"
effective_radius_grid = "reff"
phase_function = "droplets"
[phase_function.droplets]
type = "mie"
file = "droplets.h5"
[sun]
zenith_deg = 60.0
azimuth_deg = 0.0
[surface]
albedo = 0.05
"""


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--wavelength-um", default="2.13")
    parser.add_argument("--columns", default="16")
    parser.add_argument("--step-um", default="0.5", help="of the table; the finer the slower: each row is fitted once")
    parser.add_argument("--limit", type=float, default=0.1, help="per cent of the incident light")
    return parser


def figures(options):
    """Classes, estimated and found error in per cent of the incident."""
    try:
        import netCDF4  # noqa: F401
    except ImportError:
        support.skip("netCDF4 for Python is not there")

    program = Path(options.cloudbow).resolve()

    def call(*arguments):
        subprocess.run([program, *arguments, "--quiet"], cwd=folder, check=True)

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        script = ROOT / "scripts" / "examples" / "make_les_file.py"
        subprocess.run([sys.executable, script, folder / "les.nc", "--columns", options.columns], check=True)
        call("cloud", "import", "les.nc", "--minimum", "0.003", "-o", "les.vdb")
        call("mie", "--wavelength-um", options.wavelength_um, "--effective-radius-um", f"2:16:{options.step_um}", "-o", "droplets.h5")
        (folder / "scene.toml").write_text(SCENE)
        results = []
        for tolerance in (None, "0"):
            more = [] if tolerance is None else ["--set", f"solver.class_tolerance={tolerance}"]
            call("run", "scene.toml", "-o", "result.h5", *more)
            result = Result(folder / "result.h5", 0, 0, 0)
            results.append(result)
            print(f"{result.solver['phase_classes']:3} classes, estimated {100 * result.solver['phase_class_error']:.4f} %: "
                  + ", ".join(f"{key[0].upper()} {result.summary[key]:.6f}" for key in ("reflectance", "transmittance", "absorptance"))
                  + f", {result.wall_seconds:.2f} s")
        few, all_rows = results
        worst = 100 * max(abs(few.summary[key] - all_rows.summary[key]) for key in ("reflectance", "transmittance", "absorptance"))
        top = 100 * abs(few.upward_at_top() - all_rows.upward_at_top())
        print(f"largest difference {worst:.4f} % of the incident, of a column at the top {top.max() / 0.5:.4f} %")
        estimate = 100 * few.solver["phase_class_error"]
        return {"error": worst, "estimate": estimate, "allowed": min(options.limit, 2 * estimate), "classes": few.solver["phase_classes"],
                "all_classes": all_rows.solver["phase_classes"]}


def main():
    options = arguments().parse_args()
    found = figures(options)
    is_good = found["error"] <= found["allowed"] and found["classes"] < found["all_classes"]
    print("pass" if is_good else f"FAIL: allowed {options.limit} % and twice the estimate, with fewer classes")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
