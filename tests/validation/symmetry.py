#!/usr/bin/env python3
"""Things that must not change: a cloud turned and mirrored together with its sun, a bearing instead of an azimuth, the number of threads, and the
width of an open domain around a cloud.

Truth: symmetry. Turning the scene permutes the ordinates but not the control points, whose frame is fixed in space. It moves the directions of the final gather: what differs after a turn is the angular error of the method, so the limits are those of its accuracy. Bearings and threads must
agree bit by bit.

usage: symmetry.py --turn-cloud PROGRAM [turns] [bearing] [threads] [open-sides]
"""
import math
import sys
from pathlib import Path

import numpy as np

import support
from support import ROOT

FLUXES = ("upwelling_flux", "downwelling_diffuse_flux", "direct_flux")
AZIMUTHS = (37.0, 180.0)
DOMAIN_LIMIT = 0.03  # % of incident: ordinates and fitted moments turn with the scene, so only the fit's higher moments differ
COLUMN_LIMIT = 1.5   # % RMS / mean: the error of column fluxes at `balanced` (docs/validation.md), in both of the two solutions


def scene(cloud, sun, **solver):
    return support.scene_text([
        ("", {"title": "symmetry"}),
        ("cloud", {"file": str(cloud), "quantity": "extinction", "single_scattering_albedo": 1.0, "phase_function": "droplets"}),
        ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
        ("sun", {"zenith_deg": 60.0, "irradiance_w_m2": 2.0, **sun}),
        ("surface", {"type": "lambertian", "albedo": 0.05}),
        ("solver", {"accuracy": "balanced", **solver}),
    ])


class Driver:
    def __init__(self, options, folder):
        self.cloudbow = support.Cloudbow(options.cloudbow, options.threads)
        self.folder = folder
        self.turn_cloud = options.turn_cloud
        self.cloud = options.cloud or self.small_cumulus()
        self.rows = []

    def small_cumulus(self):
        cloud = self.folder / "cumulus.vdb"
        self.cloudbow.call("cloud", "make", "cumulus", "--cells", 30, 24, 16, "--voxel-size-m", 50, 50, 50, "--cover", 0.3, "--seed", 7, "-o", cloud)
        return cloud

    def solve(self, name, text, threads=None):
        path = self.folder / f"{name}.toml"
        path.write_text(text)
        cloudbow = support.Cloudbow(self.cloudbow.program, threads or self.cloudbow.threads)
        return cloudbow.run(path, self.folder / f"{name}.h5")

    def check(self, what, found, limit, unit=""):
        """Good if |found| <= limit; of bits the number that differ."""
        good = abs(found) <= limit
        print(f"{'ok   ' if good else 'FAIL '} {what}: {found:.4g} {unit} (limit {limit:.4g})", flush=True)
        self.rows.append({"what": what, "found": found, "limit": limit, "unit": unit, "good": good})

    def turned_cloud(self, turns, mirror):
        path = self.folder / f"turned_{turns}{'_mirrored' if mirror else ''}.vdb"
        done = support.Cloudbow(self.turn_cloud).call(self.cloud, path, turns, *(["mirror"] if mirror else []))
        assert done.returncode == 0
        return path


def turned(field, turns, mirror):
    """The field [level, y, x] that belongs to the cloud which turn_cloud has turned."""
    if mirror:
        field = field[:, ::-1]
    for _ in range(turns):
        field = field.transpose(0, 2, 1)[:, :, ::-1]
    return field


def check_turns(driver):
    for azimuth in AZIMUTHS:
        base = driver.solve(f"base_{azimuth:g}", scene(driver.cloud, {"azimuth_deg": azimuth}))
        for turns, mirror in ((1, False), (2, False), (0, True), (1, True)):
            name = f"sun at {azimuth:g}, turned by {90 * turns}{', mirrored' if mirror else ''}"
            turned_azimuth = (-azimuth if mirror else azimuth) + 90 * turns
            other = driver.solve("turned", scene(driver.turned_cloud(turns, mirror), {"azimuth_deg": turned_azimuth}))
            incident = base.profile["direct_flux"][-1]
            worst_domain = worst_column = 0.0
            for level, flux in ((-1, "upwelling_flux"), (0, "downwelling_diffuse_flux"), (0, "direct_flux")):
                worst_domain = max(worst_domain, 100 * abs(base.profile[flux][level] - other.profile[flux][level]) / incident)
                expected = turned(base[flux], turns, mirror)[level]
                # Against the whole downward flux: under a clear sky there is hardly any diffuse light to compare with.
                mean = expected.mean() if level == -1 else base.downward_at_bottom().mean()
                worst_column = max(worst_column, 100 * math.sqrt(np.mean((other[flux][level] - expected) ** 2)) / mean)
            driver.check(f"{name}: domain", worst_domain, DOMAIN_LIMIT, "% of incident")
            driver.check(f"{name}: columns", worst_column, COLUMN_LIMIT, "% RMS / mean")


def different_values(one, other):
    """How many numbers of two results are not the same bits."""
    fields = sum(int(np.sum((one.fields[name] != other.fields[name]) & ~(np.isnan(one.fields[name]) & np.isnan(other.fields[name])))) for name in one.fields)
    return fields + sum(one.summary[name] != other.summary[name] for name in one.summary)


def check_bearing(driver):
    azimuth = driver.solve("azimuth", scene(driver.cloud, {"azimuth_deg": 37.0}))
    bearing = driver.solve("bearing", scene(driver.cloud, {"bearing_deg": 53.0}))
    driver.check("bearing 53 is azimuth 37, bit by bit", different_values(azimuth, bearing), 0, "values differ")
    # And neither is ignored: the light comes from the sun.
    opposite = driver.solve("opposite", scene(driver.cloud, {"azimuth_deg": 217.0}))
    driver.check("a sun on the other side gives other fluxes", int(different_values(azimuth, opposite) == 0), 0, "pairs of equal results")


def check_threads(driver):
    one, two = (driver.solve(f"threads_{n}", scene(driver.cloud, {"azimuth_deg": 37.0}), n) for n in (1, 2))
    driver.check("1 and 2 threads give the same bits", different_values(one, two), 0, "values differ")


def check_open_sides(driver):
    """A spherical cloud in a domain just around it and in one three times as wide: nothing enters through an open side but the beam, so the cloud
    meets the same light in both. What it absorbs is the same power; light that left through the sides of the narrow domain may leave through the
    top or bottom of the wide one, never the other way round."""
    n, size, albedo = 24, 25.0, 0.9
    width = n * size
    cloud = driver.folder / "sphere.vdb"
    driver.cloudbow.call("cloud", "make", "sphere", "--cells", n, n, n, "--voxel-size-m", size, size, size, "--optical-depth", 10, "-o", cloud)
    power = {}
    for name, low, high in (("tight", 0.0, width), ("wide", -width, 2 * width)):
        text = support.scene_text([
            ("", {"title": f"A sphere in a {name} domain"}),
            ("cloud", {"file": str(cloud), "quantity": "extinction", "single_scattering_albedo": albedo, "phase_function": "droplets"}),
            ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
            ("domain", {"boundary": "open", "min_m": [low, low, 0.0], "max_m": [high, high, width]}),
            ("sun", {"zenith_deg": 60.0, "azimuth_deg": 0.0}),
            ("solver", {"mode": "3d"}),
        ])
        result = driver.solve(name, text)
        area = (high - low) ** 2
        power[name] = {key: value * 0.5 * area for key, value in result.summary.items()}
        driver.check(f"open sides, {name} domain: energy residual", result.summary["energy_residual"], 1e-5, "of incident")
        # Through a side that faces the azimuth 0, a beam of irradiance 1 at 60 degrees from the zenith carries sin(60) W m-2; nothing is above the cloud.
        expected = math.sin(math.radians(60)) * (high - low) * width
        # The beam comes in as whole rays: of the n tan(60) columns that one crosses on its way down, the last may count or not.
        tolerance = 0.5 / (n * math.tan(math.radians(60)))
        driver.check(f"open sides, {name} domain: the beam enters through the sunlit side", 100 * (power[name]["side_gain"] / expected - 1),
                     100 * tolerance, "% of it")
    tight, wide = power["tight"], power["wide"]
    change = wide["absorptance"] / tight["absorptance"] - 1
    # The two grids march the same voxels along the same rays but for the empty air around: what is left is the iteration's tolerance.
    driver.check("open sides: power absorbed in a wide and in a tight domain", 100 * change, 0.1, "% of it")
    lost = max(0.0, 1 - wide["reflectance"] / tight["reflectance"])
    driver.check("open sides: no less goes up through the top of the wide domain; less by", 100 * lost, 0.1, "% of it")


CHECKS = {"turns": check_turns, "bearing": check_bearing, "threads": check_threads, "open-sides": check_open_sides}


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("checks", nargs="*", metavar="CHECK", help=f"{', '.join(CHECKS)} (default: all)")
    parser.add_argument("--turn-cloud", type=Path, default=ROOT / "build/release/tests/validation/turn_cloud", help="the program that the build makes")
    parser.add_argument("--cloud", type=Path, help="VDB file (default: a small cumulus field made for this)")
    return parser


def figures(options):
    """A row for every check: what, what was found, what is allowed, in which unit."""
    unknown = set(options.checks) - set(CHECKS)
    if unknown:
        sys.exit(f"unknown check {', '.join(sorted(unknown))} (there are {', '.join(CHECKS)})")
    with support.Workspace(options.keep) as folder:
        driver = Driver(options, folder)
        for name in options.checks or CHECKS:
            CHECKS[name](driver)
    return driver.rows


def main():
    return 0 if all(row["good"] for row in figures(arguments().parse_args())) else 1


if __name__ == "__main__":
    sys.exit(main())
