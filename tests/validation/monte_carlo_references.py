#!/usr/bin/env python3
"""The Monte Carlo of tests/reference against stored ones: column fluxes of the I3RC step cloud and of RICO, radiances of the step cloud.

Truth: the I3RC community model and an independent Monte Carlo, with their standard errors. Differences are counted in standard errors of both: of
means, and as RMS over the columns, which is 1 for noise alone. Needs CLOUDBOW_REFERENCE_DIR; skipped without.

usage: monte_carlo_references.py [--photons 3e5]
"""
import csv
import dataclasses
import math
import sys

import numpy as np

import intercomparison
import monte_carlo
import support

STEP = intercomparison.CASES["step"][0]
# A mean of right answers strays by 4.5 in one case of 1e5. An RMS of n columns strays from 1 by 1/sqrt(2n), .13 for 32;
# in images more: one photon that a forward peak sends to the sensor may outweigh all others of its column.
MEAN_LIMIT, RMS_LIMIT, RMS_LIMIT_RADIANCE = 4.5, 1.5, 2.0


def job(case, fields, options, views=()):
    """The case, whose cloud lies in the folder `fields`, for Monte Carlo."""
    cells, size, bottom = monte_carlo.cloud_cells(options.cloud_cells, fields / case.cloud)
    nz, ny, nx = cells.shape
    return monte_carlo.Job(bottom + size[2] * np.arange(nz + 1), (nx, ny), size[:2],
                           [(case.single_scattering_albedo, monte_carlo.henyey_greenstein(0.85), cells)], (support.zenith_deg(case.mu0), 180.0),
                           case.surface_albedo, levels=[0, nz], views=list(views))


def compared(name, plane, value, error, limit):
    mean_error = math.hypot(plane.mean_error, np.sqrt((error**2).sum()) / error.size)
    return {"what": name, "mean": plane.mean, "mean_error": plane.mean_error, "reference": value.mean(), "strayed": (plane.mean - value.mean()) / mean_error,
            "columns": monte_carlo.chi(plane.value - value, np.hypot(plane.error, error)), "columns_limit": limit}


def is_good(row):
    return abs(row["strayed"]) <= MEAN_LIMIT and row["columns"] <= row["columns_limit"]


def fluxes(program, references, options):
    for case in (*intercomparison.CASES["step"], *intercomparison.CASES["rico"]):
        solution = program.run(job(case, references / "fields", options), options.photons, seed=5)
        reference = intercomparison.read_reference(references / case.reference)
        yield compared(f"{case.name}: up", solution.up[1], reference.up, reference.up_error, RMS_LIMIT)
        yield compared(f"{case.name}: down", solution.down[0], reference.down, reference.down_error, RMS_LIMIT)


def radiances(program, references, options):
    for albedo in ("1.0", "0.99"):
        for mu0 in ("1.0", "0.5"):
            with open(references / f"i3rc/step_radiance_ssa{albedo}_mu{mu0}.csv") as file:
                header, *rows = csv.reader(file)
            values = np.array(rows, float)
            names = header[1::2]  # I_muM_phiP: direction of travel
            angles = [[float(part) for part in name.removeprefix("I_mu").split("_phi")] for name in names]
            case = dataclasses.replace(STEP, mu0=float(mu0), single_scattering_albedo=float(albedo))
            views = [(support.zenith_deg(mu), azimuth) for mu, azimuth in angles]
            solution = program.run(job(case, references / "fields", options, views), options.photons, seed=8)
            for n, (name, plane) in enumerate(zip(names, solution.radiance)):
                yield compared(f"step cloud, mu0 {mu0}, ssa {albedo}: {name}", plane, values[None, :, 1 + 2 * n], values[None, :, 2 + 2 * n], RMS_LIMIT_RADIANCE)


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--photons", type=float, default=3e5)
    monte_carlo.add_programs(parser)
    return parser


def figures(options):
    """A row for every quantity: how far the means are apart in standard errors of both, and RMS over the columns in theirs."""
    references = support.reference_folder()
    if references is None:
        support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with fields/, i3rc/ and montecarlo/")
    program = monte_carlo.MonteCarlo(options.monte_carlo, options.threads or 1)
    rows = []
    for make in (fluxes, radiances):
        for row in make(program, references, options):
            print(f"{row['what']}: mean {row['mean']:.5f} +- {row['mean_error']:.5f}, reference {row['reference']:.5f}, off by {row['strayed']:+.2f} "
                  f"standard errors; columns {row['columns']:.2f}{'' if is_good(row) else '  <-- too far'}", flush=True)
            rows.append(row)
    return rows


def main():
    return 0 if all(is_good(row) for row in figures(arguments().parse_args())) else 1


if __name__ == "__main__":
    sys.exit(main())
