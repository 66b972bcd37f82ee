#!/usr/bin/env python3
"""Radiances of the I3RC step cloud at its top against Monte Carlo: straight up, and at cosine .5 ahead of the sun and behind it.

Truth: local estimates of an independent photon-by-photon model on the same cells, stored (the I3RC community model's; needs CLOUDBOW_REFERENCE_DIR,
skipped without) or, with --made, by tests/reference/monte_carlo in this run, on the step cloud of clouds/. Its noise is known (standard errors) and is
taken out of the RMS over columns: RMS^2 minus the mean of se^2.

usage: step_radiance.py [--accuracy fine] [--limits 1.5 2] [--made [--photons 3e6]]
"""
import csv
import math
import sys

import numpy as np

import intercomparison
import monte_carlo
import monte_carlo_references
import support
from support import ROOT

# column of the reference, zenith of the sensor, its azimuth: light travels towards +x, so what travels on at azimuth 0 is seen from azimuth 0.
VIEWS = [("I_mu1_phi0", 0.0, 0.0), ("I_mu0.5_phi0", 60.0, 0.0), ("I_mu0.5_phi180", 60.0, 180.0)]
CASES = [("1.0", "0.5"), ("1.0", "1.0"), ("0.99", "0.5"), ("0.99", "1.0")]


def scene(field, albedo, mu0, accuracy):
    return support.scene_text([
        ("cloud", {"file": str(field), "single_scattering_albedo": float(albedo), "phase_function": "droplets"}),
        ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
        ("sun", {"zenith_deg": support.zenith_deg(float(mu0)), "azimuth_deg": 180.0, "irradiance_w_m2": 1 / float(mu0)}),
        ("solver", {"accuracy": accuracy}),
        *[("[radiance]", {"name": f"view{n}", "zenith_deg": zenith, "azimuth_deg": azimuth}) for n, (_, zenith, azimuth) in enumerate(VIEWS)],
    ])


def stored_truth(folder, albedo, mu0):
    """View to (values, standard errors) of the columns."""
    path = folder / f"i3rc/step_radiance_ssa{albedo}_mu{mu0}.csv"
    with open(path) as file:
        rows = list(csv.reader(file))
    head, values = rows[0], np.array([[float(x) for x in row] for row in rows[1:]])
    return {name: (values[:, head.index(name)], values[:, head.index(name) + 1]) for name, _, _ in VIEWS}


MADE = {}  # by case and photons: the same for all levels of accuracy


def made_truth(albedo, mu0, options):
    key = (albedo, mu0, options.photons)
    if key not in MADE:
        case = intercomparison.Case("", "step.vdb", float(mu0), float(albedo), 0.0, "")
        job = monte_carlo_references.job(case, ROOT / "clouds", options, [(zenith, azimuth) for _, zenith, azimuth in VIEWS])
        MADE[key] = monte_carlo.MonteCarlo(options.monte_carlo, options.threads or 1).run(job, options.photons, seed=31 + len(MADE))
    solution = MADE[key]
    return {name: (plane.value[0], plane.error[0]) for (name, _, _), plane in zip(VIEWS, solution.radiance)}


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--accuracy", default="fine")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="a key of the scene for all cases")
    parser.add_argument("--limits", nargs=2, type=float, default=(1.5, 2.0), help="RMS over columns in %%: straight up, slanted")
    parser.add_argument("--made", action="store_true", help="the truth is made in this run")
    parser.add_argument("--photons", type=float, default=3e6)
    monte_carlo.add_programs(parser)
    return parser


def figures(options):
    """A row for every case and view, in per cent."""
    folder = support.reference_folder()
    if folder is None and not options.made:
        support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with i3rc/step_radiance_*.csv")
    cloudbow = support.Cloudbow(options.cloudbow, options.threads or 1)
    rows = []
    with support.Workspace(options.keep) as workspace:
        for albedo, mu0 in CASES:
            path = workspace / f"step_{albedo}_{mu0}.toml"
            path.write_text(scene(ROOT / "clouds/step.vdb" if options.made else folder / "fields/step_cloud.vdb", albedo, mu0, options.accuracy))
            result = cloudbow.run(path, path.with_suffix(".h5"), *[word for key in options.set for word in ("--set", key)])
            truth = made_truth(albedo, mu0, options) if options.made else stored_truth(folder, albedo, mu0)
            for n, (name, zenith, azimuth) in enumerate(VIEWS):
                found = np.asarray(result[f"radiance_view{n}"]).mean(axis=0)
                wanted, error = truth[name]
                square = np.mean((found - wanted) ** 2) - np.mean(error**2)
                rms = 100 * math.copysign(math.sqrt(abs(square)), square) / wanted.mean()
                noise = 100 * math.sqrt(np.mean(error**2)) / wanted.mean()
                mean = 100 * (found.mean() / wanted.mean() - 1)
                mean_noise = 100 * math.sqrt((error**2).sum()) / wanted.sum()
                rows.append({"case": f"mu0 {mu0}, ssa {albedo}", "sensor": f"zenith {zenith:.0f}, azimuth {azimuth:.0f}", "mean": mean, "rms": rms,
                             "noise": noise, "mean_noise": mean_noise, "limit": options.limits[0 if zenith == 0 else 1]})
    return rows


def main():
    rows = figures(arguments().parse_args())
    print(support.markdown_table(["step cloud", "sensor", "mean %", "RMS over columns %, noise taken out", "noise %", "allowed"],
                                 [[row["case"], row["sensor"], f"{row['mean']:+.2f}", f"{row['rms']:.2f}", f"{row['noise']:.2f}", f"{row['limit']:g}"]
                                  for row in rows]))
    return 1 if any(row["rms"] > row["limit"] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
