#!/usr/bin/env python3
"""Layers beside clouds in blocks (`solver.air`), against layers with a cell in every voxel and against Monte Carlo.

Truths: the program's own fluxes with air = "cells". Column fluxes of a cumulus field with and without layers by tests/reference/monte_carlo.
The latter are in tests/data/layers_beside_clouds.csv with their standard errors. Layers reach to 12 km or, with --sky, to 60 km.

usage: layers_beside_clouds.py --cloudbow PROGRAM [CASE ...] [--accuracy balanced] [--against cells truth]
"""
import csv
import math
import sys
from dataclasses import dataclass

import numpy as np

import monte_carlo
import support

REFERENCE = support.ROOT / "tests" / "data" / "layers_beside_clouds.csv"
CLOUD = ["cumulus", "--cells", 28, 24, 16, "--voxel-size-m", 80, 80, 50, "--base-m", 600, "--seed", 61]
ZENITH_DEG, AZIMUTH_DEG, ALBEDO = 60.0, 200.0, 0.1
SKY_EDGES_M = [0.0, 2000.0, 4000.0, 8000.0, 12000.0]
HIGH_SKY_EDGES_M = SKY_EDGES_M + [20000.0, 30000.0, 60000.0]
# Of incident flux, domain; RMS over the columns over their mean. The second is what blocks may leave (theory.md, "Layers in blocks").
DOMAIN_LIMIT, COLUMNS_LIMIT = 0.1, 0.3


@dataclass
class Layer:
    bottom_m: float
    top_m: float
    optical_depth: float
    single_scattering_albedo: float
    asymmetry: float | None  # None: molecules

    @property
    def scatterer(self):
        return "rayleigh" if self.asymmetry is None else monte_carlo.henyey_greenstein(self.asymmetry)


def molecules(optical_depth, edges=None):
    """By the scale height of 8 km."""
    edges = edges or SKY_EDGES_M
    return [Layer(low, high, optical_depth * (math.exp(-low / 8000) - math.exp(-high / 8000)), 1.0, None) for low, high in zip(edges, edges[1:])]


AEROSOL = Layer(0.0, 2000.0, 0.3, 0.95, 0.7)
GAS = Layer(0.0, 8000.0, 0.2, 0.0, 0.0)
CASES = {
    "cloud alone": [],
    "molecules, 0.35 um": molecules(0.6),
    "molecules, 0.55 um": molecules(0.098),
    "aerosol": [AEROSOL],
    "gas": [GAS],
    "molecules, aerosol and gas": molecules(0.6) + [AEROSOL, GAS],
}
# Against Monte Carlo: domain, columns up at the top, columns down at the bottom. Measured and a tenth more; .03 if that is less.
LIMITS = {
    ("cloud alone", "balanced"): (0.03, 1.12, 0.63),
    ("molecules, 0.35 um", "balanced"): (0.03, 0.21, 0.38),
    ("aerosol", "balanced"): (0.03, 0.22, 0.45),
    ("gas", "balanced"): (0.06, 1.53, 0.44),
}
TRUTHS = ("cloud alone", "molecules, 0.35 um", "aerosol", "gas")


def scene(layers, cloud, accuracy, air):
    tables = [
        ("cloud", {"file": str(cloud), "quantity": "extinction", "single_scattering_albedo": 1.0, "phase_function": "droplets"}),
        ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
        ("sun", {"zenith_deg": ZENITH_DEG, "azimuth_deg": AZIMUTH_DEG, "irradiance_w_m2": 1 / math.cos(math.radians(ZENITH_DEG))}),
        ("surface", {"albedo": ALBEDO}),
        ("solver", {"accuracy": accuracy, "air": air}),
        ("output", {"fields": ["fluxes"], "flux_levels": "boundaries"}),
    ]
    if any(layer.asymmetry is not None for layer in layers):
        tables.append(("phase_function.aerosol", {"type": "henyey-greenstein", "asymmetry_parameter": AEROSOL.asymmetry}))
    for layer in layers:
        name = "rayleigh" if layer.asymmetry is None else "aerosol"
        tables.append(("[layer]", {"bottom_m": layer.bottom_m, "top_m": layer.top_m, "optical_depth": layer.optical_depth,
                                   "single_scattering_albedo": layer.single_scattering_albedo, "phase_function": name}))
    return support.scene_text(tables)


def job(layers, cells, size, bottom):
    """The cloud's cells on the levels of cloud and layers together."""
    cloud_edges = bottom + size[2] * np.arange(cells.shape[0] + 1)
    edges = np.unique(np.concatenate([[0.0], cloud_edges, *[[layer.bottom_m, layer.top_m] for layer in layers]]))
    middle = (edges[1:] + edges[:-1]) / 2
    cloud = np.zeros((len(middle), *cells.shape[1:]))
    inside = (middle > cloud_edges[0]) & (middle < cloud_edges[-1])
    cloud[inside] = cells[((middle[inside] - bottom) / size[2]).astype(int)]
    media = [(1.0, monte_carlo.henyey_greenstein(0.85), cloud)]
    for layer in layers:
        extinction = layer.optical_depth / (layer.top_m - layer.bottom_m)
        profile = np.where((middle > layer.bottom_m) & (middle < layer.top_m), extinction, 0.0)
        media.append((layer.single_scattering_albedo, layer.scatterer, profile))
    return monte_carlo.Job(edges, cells.shape[:0:-1], size[:2], media, (ZENITH_DEG, AZIMUTH_DEG), ALBEDO, levels=[0, len(edges) - 1])


def make_reference(names, cloud, options):
    program = monte_carlo.MonteCarlo(options.monte_carlo, options.threads or 1)
    cells, size, bottom = monte_carlo.cloud_cells(options.cloud_cells, cloud)
    with open(REFERENCE, "w") as file:
        file.write(f"# made by tests/validation/layers_beside_clouds.py --make-reference: {options.photons:.0e} photons a case; "
                   "unit flux through the horizontal\ncase,ix,iy,up,up_se,down,down_se\n")
        for name in names:
            solution = program.run(job(CASES[name], cells, size, bottom), options.photons)
            up, down = solution.up[1], solution.down[0]
            noise = [100 * float(np.sqrt(np.mean(p.error**2))) / p.mean for p in (up, down)]
            print(f"{name}: {solution.cpu_seconds:.0f} CPU s, noise of a column {noise[0]:.2f} and {noise[1]:.2f} % of the mean", flush=True)
            for j, i in np.ndindex(up.value.shape):
                numbers = ",".join(f"{p.value[j, i]:.5f},{p.error[j, i]:.2g}" for p in (up, down))
                file.write(f'"{name}",{i},{j},{numbers}\n')


def read_reference():
    """Case to (up, its error, down, its error), each [y, x]."""
    with open(REFERENCE) as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    planes = {}
    for name in {row[0] for row in rows}:
        table = np.array([[float(n) for n in row[1:]] for row in rows if row[0] == name])
        nx, ny = int(table[:, 0].max()) + 1, int(table[:, 1].max()) + 1
        planes[name] = [table[:, 2 + n].reshape(ny, nx) for n in range(4)]
    return planes


def difference(result, up, down, up_error=None, down_error=None):
    """Domain: the larger of both, % of incident; columns up and down, % of their mean."""
    found = result.upward_at_top(), result.downward_at_bottom()
    return {"domain": 100 * max(abs(found[0].mean() - up.mean()), abs(found[1].mean() - down.mean())),
            "up": support.rms_percent(found[0], up, up_error), "down": support.rms_percent(found[1], down, down_error)}


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"beginnings of names: {', '.join(CASES)} (default: all)")
    parser.add_argument("--accuracy", default="balanced")
    parser.add_argument("--against", nargs="+", choices=("cells", "truth"), default=["cells", "truth"])
    parser.add_argument("--cloud", metavar="FILE", help="another field of extinction: against cells alone, or with --make-reference")
    parser.add_argument("--sky", action="store_true", help="molecules up to 60 km")
    parser.add_argument("--limits", action="store_true", help="fail if a difference is above its limit")
    parser.add_argument("--make-reference", action="store_true")
    parser.add_argument("--photons", type=float, default=3e7)
    monte_carlo.add_programs(parser)
    options = parser.parse_args()
    if options.sky:
        CASES.update({"molecules, 0.35 um": molecules(0.6, HIGH_SKY_EDGES_M), "molecules, 0.55 um": molecules(0.098, HIGH_SKY_EDGES_M)})
    names = [name for name in CASES if not options.cases or name.startswith(tuple(options.cases))]
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    rows, bad = [], []
    with support.Workspace(options.keep) as folder:
        cloud = options.cloud or folder / "cloud.vdb"
        if not options.cloud:
            cloudbow.call("cloud", "make", *CLOUD, "-o", cloud)
        if options.make_reference:
            make_reference([name for name in names if name in TRUTHS], cloud, options)
            return 0
        truths = read_reference() if "truth" in options.against and not options.cloud and not options.sky else {}

        def solve(name, air):
            (folder / "scene.toml").write_text(scene(CASES[name], cloud, options.accuracy, air))
            return cloudbow.run(folder / "scene.toml", folder / f"{air}.h5", accept=(0, 3))

        for name in names:
            result = solve(name, "auto")
            row = [name, result.solver["air"], result.solver["active_voxels"], result.solver["sweeps"], f"{result.cpu_seconds:.2f}"]
            if result.exit_code != 0:
                bad.append(f"{name}: not converged")
            if "cells" in options.against and CASES[name]:
                own = solve(name, "cells")
                off = difference(result, own.upward_at_top(), own.downward_at_bottom())
                row += [own.solver["active_voxels"], f"{own.cpu_seconds:.2f}", f"{off['domain']:.3f}", f"{off['up']:.2f} / {off['down']:.2f}"]
                if off["domain"] > DOMAIN_LIMIT or max(off["up"], off["down"]) > COLUMNS_LIMIT:
                    bad.append(f"{name}: blocks differ from cells by {off} (limits {DOMAIN_LIMIT} and {COLUMNS_LIMIT})")
            else:
                row += ["", "", "", ""]
            if name in truths:
                up, up_error, down, down_error = truths[name]
                off = difference(result, up, down, up_error, down_error)
                row += [f"{off['domain']:.3f}", f"{off['up']:.2f} / {off['down']:.2f}"]
                for quantity, limit in zip(("domain", "up", "down"), LIMITS.get((name, options.accuracy), ())):
                    if off[quantity] > limit:
                        bad.append(f"{name}: {quantity} {off[quantity]:.2f} % off the truth (limit {limit})")
            else:
                row += ["", ""]
            rows.append(row)
    print(support.markdown_table(["layers", "air", "cells", "sweeps", "CPU s", "own cells", "their CPU s", "domain, % of incident", "columns up / down, %",
                                  "domain off the truth, %", "columns up / down, %"], rows))
    print("\n".join(bad))
    return 1 if bad and options.limits else 0


if __name__ == "__main__":
    sys.exit(main())
