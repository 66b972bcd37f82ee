#!/usr/bin/env python3
"""Clouds that emit: fluxes by column and net absorbed power by cell against Monte Carlo, at one wavelength.

Truth: tests/reference/monte_carlo, backward, on the same cells, with the Planck radiance linear in height in each cell. Its tables are in
tests/data/thermal_clouds.csv with their standard errors, which are taken out of every RMS. --make-reference makes them anew and holds them
to forward photons (5 CPU minutes).

step: clouds/step.vdb, 32 columns of optical depth 2 | 18 in 500 m x 250 m, 16 layers of cells. Temperature 280 K at the base to 278 K at the top,
black ground of 288 K at the base, 11 um; single-scattering albedo .5, asymmetry .9.
cumulus, stratocumulus: `cloud make` fields, temperature falling by 6.5 K/km from 288 K at the ground, black ground of 288 K, 11 um;
single-scattering albedo .6, asymmetry .9. Clear air is transparent, the sky is cold.

up, down: RMS / mean over the columns [%], up at the top, down at the ground. dup, ddown: of their means [%].
top: RMS of the net absorbed power of the highest cloudy cell of each column, / its RMS [%]. profile: the same of the means by layer.
total: net absorbed power of all cells, / the sum of its magnitudes by layer [%].

usage: thermal_clouds.py --cloudbow PROGRAM [CASE ...] [--accuracy balanced] [--limits] | --make-reference
"""
import csv
import math
import sys
from dataclasses import dataclass

import numpy as np

import monte_carlo
import support

REFERENCE = support.ROOT / "tests" / "data" / "thermal_clouds.csv"
WAVELENGTH_UM, ASYMMETRY = 11.0, 0.9
FIGURES = ("up", "down", "dup", "ddown", "top", "profile", "total")
SIGNED = ("dup", "ddown", "total")


@dataclass(frozen=True)
class Case:
    single_scattering_albedo: float
    surface_k: float
    height_m: tuple
    temperature_k: tuple
    make: tuple = ()  # arguments of `cloud make`; none: clouds/step.vdb
    photons: tuple = (20000, 20000, 20000)  # per column of the flux up and down, per cell


LAPSE = ((0.0, 4000.0), (288.0, 262.0))
CASES = {
    "step": Case(0.5, 288.0, (0.0, 250.0), (280.0, 278.0), photons=(60000, 60000, 300000)),
    "cumulus": Case(0.6, 288.0, *LAPSE, photons=(20000, 320000, 100000),
                    make=("cumulus", "--cells", 28, 24, 30, "--voxel-size-m", 50, 50, 50, "--base-m", 500, "--cover", 0.3, "--optical-depth", 5, "--seed", 83)),
    "stratocumulus": Case(0.6, 288.0, *LAPSE, photons=(20000, 20000, 30000),
                          make=("stratocumulus", "--cells", 24, 20, 20, "--voxel-size-m", 50, 50, 25, "--base-m", 250, "--optical-depth", 10, "--seed", 84)),
}
# Limits [%]: the project's goals for the step cloud, up .3 and top 1; the others as measured, and a tenth more.
LIMITS = {
    ("step", "balanced"): {"up": 0.3, "down": 0.25, "top": 1.0, "profile": 0.8, "total": 0.1},
    ("cumulus", "balanced"): {"up": 0.08, "down": 3.4, "top": 4.3, "profile": 4.3, "total": 2.3},
    ("cumulus", "fine"): {"up": 0.05, "down": 0.83, "top": 3.1, "profile": 2.2, "total": 0.4},
    ("stratocumulus", "balanced"): {"up": 0.2, "down": 0.05, "top": 4.0, "profile": 1.9, "total": 0.23},
    ("stratocumulus", "fine"): {"up": 0.08, "down": 0.05, "top": 1.5, "profile": 0.7, "total": 0.1},
}


def planck(temperature_k, wavelength_um=WAVELENGTH_UM):
    """Radiance of a black body, W m-2 sr-1 um-1, by the exact constants of the SI."""
    h, c, k = 6.62607015e-34, 299792458.0, 1.380649e-23
    wavelength = wavelength_um * 1e-6
    return 1e-6 * 2 * h * c * c / wavelength**5 / np.expm1(h * c / (wavelength * k * np.asarray(temperature_k)))


@dataclass
class Cells:
    """The cells of a cloud's domain: extinction [z, y, x], size, edges of the layers."""
    extinction: np.ndarray
    size: tuple
    z_edge: np.ndarray

    def tops(self):
        """Layer of the highest cloudy cell of each column [y, x]; -1: clear."""
        cloudy = self.extinction > 0
        return np.where(cloudy.any(axis=0), len(cloudy) - 1 - np.argmax(cloudy[::-1], axis=0), -1)


def cloud_of(case, cloudbow, folder):
    if not case.make:
        return support.ROOT / "clouds" / "step.vdb"
    path = folder / f"{case.make[0]}.vdb"
    cloudbow.call("cloud", "make", *case.make, "-o", path)
    return path


def scene(case, cloud, accuracy):
    return support.scene_text([
        ("cloud", {"file": str(cloud), "quantity": "extinction", "single_scattering_albedo": case.single_scattering_albedo, "phase_function": "droplets"}),
        ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": ASYMMETRY}),
        # Pressures, which nothing uses here, by a scale height of 8 km.
        ("atmosphere", {"height_m": case.height_m, "temperature_k": case.temperature_k, "pressure_pa": [1e5 * math.exp(-z / 8000) for z in case.height_m]}),
        ("thermal", {"wavelength_um": WAVELENGTH_UM}),
        ("surface", {"albedo": 0.0, "temperature_k": case.surface_k}),
        ("solver", {"accuracy": accuracy}),
        ("output", {"fields": ["fluxes", "absorption"]}),
    ])


def job(case, cells, **tallies):
    """The cells, the ground at their lower end."""
    at_edge = planck(np.interp(cells.z_edge, case.height_m, case.temperature_k))
    return monte_carlo.Job(cells.z_edge, cells.extinction.shape[:0:-1], cells.size[:2],
                           [(case.single_scattering_albedo, monte_carlo.henyey_greenstein(ASYMMETRY), cells.extinction)], (0.0, 0.0), sun_flux=0.0,
                           planck=(at_edge[1:] + at_edge[:-1]) / 2, planck_step=np.diff(at_edge), surface_planck=planck(case.surface_k), **tallies)


def of_volume(planes, cells):
    """From power by area of the columns: power [W m-3 um-1] and its error [z, y, x], and the profile of (mean, error)."""
    value, error = (np.array([getattr(plane, name) for plane in planes]) / cells.size[2] for name in ("value", "error"))
    return value, error, [(plane.mean / cells.size[2], plane.mean_error / cells.size[2]) for plane in planes]


def make_reference(names, cloudbow, folder, options):
    program = monte_carlo.MonteCarlo(options.monte_carlo, options.threads or 1)
    with open(REFERENCE, "w") as file:
        file.write("# made by tests/validation/thermal_clouds.py --make-reference. up, down: W m-2 um-1 of a column; top, profile: net absorbed power\n"
                   "# [W m-3 um-1] of the highest cloudy cell of a column, and mean of a layer of cells\n"
                   "case,quantity,ix,iy,iz,value,standard_error\n")
        for name in names:
            case = CASES[name]
            cells = read_cells(options, cloud_of(case, cloudbow, folder))
            nz, ny, nx = cells.extinction.shape
            # Two directions per level, one of which is trivial.
            top, bottom = (program.run(job(case, cells, levels=[level]), 2 * nx * ny * photons, backward=True, seed=seed)
                           for level, photons, seed in ((nz, case.photons[0], 1), (0, case.photons[1], 2)))
            powers = program.run(job(case, cells, absorption=True), np.count_nonzero(cells.extinction) * case.photons[2], backward=True, seed=3)
            forward = program.run(job(case, cells, levels=[0, nz], absorption=True), options.forward_photons, seed=4)
            up, down = top.up[0], bottom.down[0]
            value, error, profile = of_volume(powers.absorbed, cells)
            rows = [(quantity, i, j, "", plane.value[j, i], plane.error[j, i]) for quantity, plane in (("up", up), ("down", down)) for j, i in np.ndindex(ny, nx)]
            tops = cells.tops()
            rows += [("top", i, j, tops[j, i], value[tops[j, i], j, i], error[tops[j, i], j, i]) for j, i in np.ndindex(ny, nx) if tops[j, i] >= 0]
            rows += [("profile", "", "", k, mean, of_mean) for k, (mean, of_mean) in enumerate(profile)]
            for quantity, i, j, k, number, of_number in rows:
                file.write(f"{name},{quantity},{i},{j},{k},{number:.7g},{of_number:.2g}\n")
            print(f"{name}: {top.cpu_seconds:.0f} + {bottom.cpu_seconds:.0f} + {powers.cpu_seconds:.0f} CPU s, forward {forward.cpu_seconds:.0f} CPU s")
            report(rows, ((up, forward.up[1]), (down, forward.down[0])), of_volume(forward.absorbed, cells)[2])


def report(rows, planes, forward_profile):
    """The noise of a case, and the differences to forward photons, in standard errors of both."""
    noise = []
    for quantity in ("up", "down", "top", "profile"):
        numbers = np.array([row[4:] for row in rows if row[0] == quantity], float)
        scale = numbers[:, 0].mean() if quantity in ("up", "down") else np.sqrt(np.mean(numbers[:, 0] ** 2))
        noise.append(f"{quantity} {100 * np.sqrt(np.mean(numbers[:, 1] ** 2)) / scale:.3f}")
    print(f"  noise: {', '.join(noise)} %")
    for what, (a, b) in zip(("up", "down"), planes):
        strayed = (a.mean - b.mean) / math.hypot(a.mean_error, b.mean_error)
        seen = b.error > 0
        chi = monte_carlo.chi((a.value - b.value)[seen], np.hypot(a.error, b.error)[seen])
        print(f"  {what}: mean {a.mean:.5f} +- {a.mean_error:.5f}, forward {b.mean:.5f} +- {b.mean_error:.5f}, off by {strayed:+.2f}; columns {chi:.2f}")
    own = np.array([row[4:] for row in rows if row[0] == "profile"], float)
    other = np.array(forward_profile)
    error = np.hypot(own[:, 1], other[:, 1])
    print(f"  profile: {monte_carlo.chi((own[:, 0] - other[:, 0])[error > 0], error[error > 0]):.2f}", flush=True)


def read_cells(options, cloud):
    extinction, size, bottom = monte_carlo.cloud_cells(options.cloud_cells, cloud)
    return Cells(extinction, size, bottom + size[2] * np.arange(len(extinction) + 1))


def read_reference():
    """Case to quantity to rows (ix, iy, iz, value, standard error), absent indices being -1."""
    found = {}
    with open(REFERENCE) as file:
        for name, quantity, *numbers in list(csv.reader(line for line in file if not line.startswith("#")))[1:]:
            found.setdefault(name, {}).setdefault(quantity, []).append([float(number) if number else -1.0 for number in numbers])
    return {name: {quantity: np.array(rows) for quantity, rows in tables.items()} for name, tables in found.items()}


def relative(found, truth, scale):
    """RMS of the difference without the truth's noise, and difference of the means, in % of the scale."""
    square = np.mean((found - truth[:, 3]) ** 2 - truth[:, 4] ** 2)
    return 100 * math.sqrt(max(0.0, square)) / scale, 100 * (found - truth[:, 3]).mean() / scale


def on_layers_of_voxels(result, layers):
    """Net absorbed power [z, y, x] on equal layers of the domain. Levels without cloud are one in the result, and absorb nothing."""
    edges = result["z_edge"]
    power = result["net_absorbed_power"]
    height = (edges[-1] - edges[0]) / layers
    whole = np.zeros((layers, *power.shape[1:]))
    for level in range(len(power)):
        place = (edges[level] - edges[0]) / height
        if abs(edges[level + 1] - edges[level] - height) < 1e-3 * height:
            whole[round(place)] = power[level]
        elif np.any(power[level]):
            raise support.Failure(f"level {level} absorbs and is no layer of voxels")
    return whole


def figures_of(result, truth):
    figures = {}
    down = result["downwelling_diffuse_flux"][0] + (result["direct_flux"][0] if "direct_flux" in result.fields else 0)
    for name, plane in (("up", result.upward_at_top()), ("down", down)):
        table = truth[name]
        i, j = table[:, 0].astype(int), table[:, 1].astype(int)
        figures[name], figures[f"d{name}"] = relative(plane[j, i], table, table[:, 3].mean())
    power = on_layers_of_voxels(result, len(truth["profile"]))
    table = truth["top"]
    i, j, k = (table[:, n].astype(int) for n in range(3))
    figures["top"], _ = relative(power[k, j, i], table, math.sqrt(np.mean(table[:, 3] ** 2)))
    table = truth["profile"]
    profile = power.mean(axis=(1, 2))
    figures["profile"], _ = relative(profile, table, math.sqrt(np.mean(table[:, 3] ** 2)))
    figures["total"] = 100 * (profile - table[:, 3]).sum() / np.abs(table[:, 3]).sum()
    return figures


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"of {', '.join(CASES)} (default: all)")
    parser.add_argument("--accuracy", nargs="+", default=["balanced"])
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="passed on to `cloudbow run`")
    parser.add_argument("--limits", action="store_true", help="fail if a figure is above its limit")
    parser.add_argument("--make-reference", action="store_true")
    parser.add_argument("--forward-photons", type=float, default=5e6, help="of the check of --make-reference (default 5e6)")
    monte_carlo.add_programs(parser)
    options = parser.parse_args()
    names = options.cases or list(CASES)
    if unknown := set(names) - set(CASES):
        sys.exit(f"unknown case {', '.join(sorted(unknown))} (there are {', '.join(CASES)})")
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    settings = [argument for setting in options.set for argument in ("--set", setting)]
    rows, bad = [], []
    with support.Workspace(options.keep) as folder:
        if options.make_reference:
            make_reference(names, cloudbow, folder, options)
            return 0
        truths = read_reference()
        for name in names:
            case = CASES[name]
            cloud = cloud_of(case, cloudbow, folder)
            for accuracy in options.accuracy:
                (folder / "scene.toml").write_text(scene(case, cloud, accuracy))
                result = cloudbow.run(folder / "scene.toml", folder / f"{name}_{accuracy}.h5", *settings, accept=(0, 3))
                figures = figures_of(result, truths[name])
                rows.append([name, accuracy, *(f"{figures[key]:{'+' if key in SIGNED else ''}.3f}" for key in FIGURES),
                             result.solver["sweeps"], f"{result.cpu_seconds:.2f}"])
                if result.exit_code != 0:
                    bad.append(f"{name}, {accuracy}: not converged")
                bad += [f"{name}, {accuracy}: {key} {abs(figures[key]):.3g} % is above {limit}" for key, limit in LIMITS.get((name, accuracy), {}).items()
                        if abs(figures[key]) > limit]
    print(support.markdown_table(["case", "accuracy", *FIGURES, "sweeps", "CPU s"], rows))
    print("\n".join(bad))
    return 1 if bad and options.limits else 0


if __name__ == "__main__":
    sys.exit(main())
