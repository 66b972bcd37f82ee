#!/usr/bin/env python3
"""The made-up fields of clouds/ in 3D against Monte Carlo: cumulus and stratocumulus, columns in blocks of 8 x 8.

Truth: column fluxes by tests/reference/monte_carlo, made anew in each run, so that nothing from elsewhere is needed; their noise is taken out of the
RMS over blocks. The limits are those of RICO in intercomparison.py.

usage: made_fields.py [--accuracy draft balanced fine] [--photons 1e7] [--halved]
"""
import sys

import numpy as np

import intercomparison
import monte_carlo
import monte_carlo_references
import support
from support import ROOT

CLOUDS = ROOT / "clouds"
CASES = [
    intercomparison.Case("cumulus of clouds/, mu0 .5, ssa 1", "fair_weather_cumulus.vdb", 0.5, 1.0, 0.05, "", block=8),
    intercomparison.Case("stratocumulus of clouds/, mu0 .87, ssa .99", "stratocumulus.vdb", 0.866, 0.99, 0.05, "", block=8),
]


def truth(case, options):
    program = monte_carlo.MonteCarlo(options.monte_carlo, options.threads or 1)
    solution = program.run(monte_carlo_references.job(case, CLOUDS, options), options.photons, seed=21)
    up, down = solution.up[1], solution.down[0]
    return intercomparison.Columns(up.value, up.error, down.value, down.error)


def halved_clouds(case, cloudbow, folder, options):
    """A folder with the case's cloud in voxels cut in two along each axis: the same matter."""
    cells, size, _ = monte_carlo.cloud_cells(options.cloud_cells, CLOUDS / case.cloud)
    fine = cells.repeat(2, axis=0).repeat(2, axis=1).repeat(2, axis=2)
    text = folder / "cells.txt"
    with open(text, "w") as file:
        file.writelines(f"{i} {j} {k} {fine[k, j, i]:.9g}\n" for k, j, i in zip(*np.nonzero(fine)))
    cloudbow.call("cloud", "import", text, "--format", "columns", "--voxel-size-m", *(s / 2 for s in size), "--columns", fine.shape[2], fine.shape[1],
                  "-o", folder / case.cloud)
    return folder


def domain_errors(result, reference):
    """Of the domain's fluxes alone, in % of incident: up at the top, down at the bottom."""
    return 100 * (result.upward_at_top().mean() - reference.up.mean()), 100 * (result.downward_at_bottom().mean() - reference.down.mean())


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--accuracy", nargs="+", default=["draft", "balanced", "fine"])
    parser.add_argument("--photons", type=float, default=1e7)
    parser.add_argument("--halved", action="store_true", help="the domain's errors in voxels cut in two along each axis, too")
    monte_carlo.add_programs(parser)
    return parser


def figures(options):
    """A row of figures for every case and level, as those of intercomparison.py."""
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    rows = []
    with support.Workspace(options.keep) as folder:
        for case in CASES:
            reference = truth(case, options)
            for accuracy in options.accuracy:
                if options.halved:
                    result = intercomparison.solve(case, halved_clouds(case, cloudbow, folder, options), cloudbow, folder, accuracy)
                    print(f"{case.name}, {accuracy}, voxels halved: " + "dR {:+.3f}, dT {:+.3f} %".format(*domain_errors(result, reference)), flush=True)
                row = intercomparison.compare(case, intercomparison.solve(case, CLOUDS, cloudbow, folder, accuracy), reference)
                row["faults"] = [f"{case.name}, {accuracy}: {fault}" for fault in intercomparison.faults(row, intercomparison.RICO_LIMITS.get(accuracy))]
                rows.append({"accuracy": accuracy, **row})
                print(f"{case.name}, {accuracy}: domain dR {row['dR']:+.3f}, dT {row['dT']:+.3f} % (noise {row['domain_noise']:.3f}), blocks up {row['up']:.2f} (noise "
                      f"{row['up_noise']:.2f}) %, down {row['down']:.2f} ({row['down_noise']:.2f}) %, {row['cpu_seconds']:.1f} CPU s", flush=True)
    return rows


def main():
    bad = [fault for row in figures(arguments().parse_args()) for fault in row["faults"]]
    print("\n".join(bad))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
