#!/usr/bin/env python3
"""Clouds of others, from their files to fluxes: an LES stratocumulus at 2.13 um with 26 phase functions, and a slice of one on stretched levels.

Imports `stcu213` and `les2d` of the reference folder (CLOUDBOW_REFERENCE_DIR; skipped without it), solves them at `balanced` with the classes
that it chooses and with every phase function, prints domain means, time and memory, and checks that the classes change less than the limit and
that the ledger closes.

usage: imports.py --cloudbow PROGRAM [--limit 0.1]
"""
import argparse
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from support import SKIPPED, Result

SCENE = """\
[cloud]
file = "cloud.vdb"
single_scattering_albedo_grid = "single_scattering_albedo"
phase_function = "droplets"
[phase_function.droplets]
type = "set"
file = "cloud.phase.csv"
index_grid = "phase_index"
[sun]
zenith_deg = {zenith}
azimuth_deg = 0.0
[surface]
albedo = {albedo}
[output]
flux_levels = "boundaries"
"""
# name, cells, moments, options of the import, surface albedo, cosines of the sun's zenith angle
CASES = [("stcu213", "stcu213_optics/optics_nonzero.csv", "stcu213_optics/legendre.csv", [], 0.05, [0.5]),
         ("les2d", "les2d_cells.csv", "les2d_optics/legendre.csv", ["--columns", "64", "1", "--voxel-size-m", "55"], 0.0, [0.5, 1.0])]
KEYS = ("reflectance", "transmittance", "absorptance")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    parser.add_argument("--limit", type=float, default=0.1, help="per cent of the incident light")
    options = parser.parse_args()
    reference = os.environ.get("CLOUDBOW_REFERENCE_DIR")
    if not reference:
        print("CLOUDBOW_REFERENCE_DIR is not set")
        return SKIPPED
    fields = Path(reference).resolve() / "fields"
    program = Path(options.cloudbow).resolve()
    is_good = True
    for name, cells, moments, more, albedo, cosines in CASES:
        for mu in cosines:
            with tempfile.TemporaryDirectory() as folder:
                command = [program, "cloud", "import", fields / cells, "--phase-functions", fields / moments, "-o", "cloud.vdb", "--quiet", *more]
                subprocess.run(command, cwd=folder, check=True)
                (Path(folder) / "scene.toml").write_text(SCENE.format(zenith=math.degrees(math.acos(mu)), albedo=albedo))
                results = []
                for override in ([], ["--set", "solver.class_tolerance=0"]):
                    subprocess.run([program, "run", "scene.toml", "-o", "r.h5", "--quiet", *override], cwd=folder, check=True)
                    result = Result(Path(folder) / "r.h5", 0, 0, 0)
                    results.append(result)
                    print(f"{name} mu0 {mu}: {result.solver['phase_classes']:2} classes (estimated {100 * result.solver['phase_class_error']:.3f} %)  "
                          + "  ".join(f"{key[0].upper()} {result.summary[key]:.5f}" for key in KEYS)
                          + f"  {result.wall_seconds:.2f} s of which tables {result.solver['seconds_tables']:.2f}, {result.peak_memory_bytes / 1e6:.0f} MB")
            worst = 100 * max(abs(results[0].summary[key] - results[1].summary[key]) for key in KEYS)
            top = 100 * abs(results[0].upward_at_top() - results[1].upward_at_top()) / mu
            print(f"    classes change {worst:.4f} % of the incident, a column at the top at most {top.max():.4f} %")
            is_good = is_good and worst <= options.limit
    print("pass" if is_good else f"FAIL: allowed {options.limit} %")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
