#!/usr/bin/env python3
"""How errors fall as cells shrink and directions multiply: the slope on logarithmic axes, against the order that the method has.

Cases are such that an order is to be expected: smooth fields and smooth phase functions, one discretisation refined while all others are held.

- Space, layers: a homogeneous layer cut into more and more cells. With isotropic scattering at so many ordinates that they do not count, truth is
  adding and doubling (tests/reference/plane_parallel); with a forward peak, whose directions are held, the finest cut. The source is linear in a
  cell: second order and better.
- Space, 2D: a cloud whose extinction is a smooth periodic function, in n x n cells, the directions held; truth is the finest field. The domain's
  reflectance and the absorbed power of blocks of cells: cells of constant extinction and rays at one place a column are second order.
- Space, thick voxels: a wall of three voxels of optical depth 3 from side to side beside clear air, lit from its side; its voxels cut in 1, 2 and 4
  along each axis, without the cuts of its own that the program makes. Truth is the finest cut. The first metres of a lit side have most of the
  light, and slopes of the light itself describe it: between first and second order.
- Angle, control points: a smooth phase function of few moments, as it is interpolated between control points; truth is the function itself. Second
  order in the points' distance. Fluxes have no order in it: their moments are held whatever the points, and what is left is shown beside.
- Angle, ordinates: isotropic scattering, which control points hold exactly, at more and more polar angles; truth is adding and doubling. Gauss
  angles in each half range converge faster than any low power; what is asked for is the fourth.

usage: convergence.py [STUDY ...] [--plot FILE.png]
"""
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import plane_parallel_truths
import support

MU0 = 0.5
TIGHT = {"tolerance": 1e-8}


@dataclass
class Study:
    name: str
    refined: str  # what the abscissa is
    quantity: str
    truth: str
    step: list  # abscissa, descending
    error: list  # in the unit of `quantity`
    order: str  # that the method has
    least: float  # slope below which it has failed
    most: float = math.inf  # error that it may have at the finest: if there is no order

    @property
    def slope(self):
        """Of the three finest."""
        return float(np.polyfit(np.log(self.step[-3:]), np.log(self.error[-3:]), 1)[0])

    @property
    def good(self):
        return self.slope >= self.least and self.error[-1] <= self.most


def solve(name, tables, cloudbow, folder):
    path = folder / f"{name}.toml"
    path.write_text(support.scene_text(tables))
    return cloudbow.run(path, folder / f"{name}.h5", "--set", "output.flux_levels=boundaries", accept=(0, 3))


SUN = ("sun", {"zenith_deg": support.zenith_deg(MU0), "azimuth_deg": 20.0, "irradiance_w_m2": 1 / MU0})


def layer(optical_depth, albedo, phase, cells, **solver):
    """A homogeneous layer over black ground; phase: name or table."""
    tables = [("[layer]", {"bottom_m": 0.0, "top_m": 1000.0, "optical_depth": optical_depth, "single_scattering_albedo": albedo,
                           "phase_function": phase if isinstance(phase, str) else "matter"}), SUN,
              ("domain", {"vertical_cells": cells}), ("solver", {**TIGHT, **solver})]
    return tables if isinstance(phase, str) else [*tables, ("phase_function.matter", phase)]


def by_adding(options, *words):
    """Reflectance and transmittance by tests/reference/plane_parallel, and its estimate of its own error."""
    case = plane_parallel_truths.solve(options.plane_parallel, *words)
    top, bottom = case["results"]["levels"][0], case["results"]["levels"][-1]
    return top["flux_up"], bottom["flux_down_diffuse"] + bottom["flux_down_direct"], case["est"]["flux_abs"]


def adding(own):
    return f"adding and doubling (± {own:.0e})"


def worst_flux(result, truth):
    return max(abs(float(result.upward_at_top().mean()) - truth[0]), abs(float(result.downward_at_bottom().mean()) - truth[1]))


def study_layer(options, cloudbow, folder):
    counts, finest = (8, 16, 32, 64, 128), 2048
    step = [1 / n for n in counts]
    phase = {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}
    found = {n: solve(f"layer_{n}", layer(8.0, 0.95, phase, n, directions="double-gauss-8x16", control_points=162), cloudbow, folder)
             for n in (*counts, finest)}
    best = found[finest]
    truth = float(best.upward_at_top().mean()), float(best.downward_at_bottom().mean())
    peaked = [worst_flux(found[n], truth) for n in counts]

    *truth, own = by_adding(options, "sun", MU0, "irradiance", 1 / MU0, "layer", 8, 0.95, "isotropic")
    isotropic = [worst_flux(solve(f"isotropic_{n}", layer(8.0, 0.95, "isotropic", n, directions="double-gauss-32x4", control_points=42), cloudbow, folder), truth)
                 for n in counts]
    what = ("height of a cell / layer", "worst of R and T")
    return [Study("layer, isotropic", *what, adding(own), step, isotropic, "2 and more", 1.9),
            Study("layer, HG .85", *what, f"{finest} cells", step, peaked, "2 and more", 2.3)]


def smooth_cloud(n, cloudbow, folder):
    """n x 1 x n cells of a periodic, smooth field: the mean extinction of each cell, in closed form."""
    edge = np.linspace(0, 1, n + 1)
    mean = lambda integral: np.diff(integral) * n
    along_x = mean(edge + 0.8 * np.sin(2 * np.pi * edge) / (2 * np.pi))  # 1 + .8 cos
    along_z = mean(edge - np.sin(2 * np.pi * edge) / (2 * np.pi))  # 1 - cos: nothing at top and base
    size = 1000 / n
    text, cloud = folder / f"smooth_{n}.txt", folder / f"smooth_{n}.vdb"
    with open(text, "w") as file:
        for k in range(n):
            for i in range(n):
                file.write(f"{i} 0 {k} {8e-3 * along_x[i] * along_z[k]:.9g}\n")
    cloudbow.call("cloud", "import", text, "--format", "columns", "--voxel-size-m", size, size, size, "--columns", n, 1, "-o", cloud)
    return cloud


def study_field(options, cloudbow, folder):
    counts, finest, blocks = (8, 16, 32, 64), 256, 8
    found = {}
    for n in (*counts, finest):
        tables = [("cloud", {"file": str(smooth_cloud(n, cloudbow, folder)), "quantity": "extinction", "single_scattering_albedo": 0.9,
                             "phase_function": "droplets"}),
                  ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.7}), SUN,
                  ("solver", {"tolerance": 1e-7, "control_points": 42, "directions": "double-gauss-6x8", "gather_directions": 16})]
        found[n] = solve(f"field_{n}", tables, cloudbow, folder)

    def absorbed(n):
        power = found[n]["absorbed_power"].reshape(n, n)
        return power.reshape(blocks, n // blocks, blocks, n // blocks).mean(axis=(1, 3))

    truth, reflectance = absorbed(finest), found[finest].summary["reflectance"]
    step = [1 / n for n in counts]
    return [Study("field, domain", "width of a cell / field", "reflectance", f"{finest} x {finest} cells", step,
                  [abs(found[n].summary["reflectance"] - reflectance) for n in counts], "2", 1.6),
            Study("field, absorption", "width of a cell / field", "absorbed power of 8 x 8 blocks, RMS / mean", f"{finest} x {finest} cells", step,
                  [math.sqrt(np.mean((absorbed(n) - truth) ** 2)) / truth.mean() for n in counts], "2", 1.8)]


def wall(parts, cloudbow, folder):
    """A wall of 3 x 1 x 4 voxels, 2 clear ones before it and 3 behind. Each is cut in `parts` along x and z."""
    size = 60 / parts
    text, cloud = folder / f"wall_{parts}.txt", folder / f"wall_{parts}.vdb"
    text.write_text("".join(f"{i} 0 {k} 0.05\n" for k in range(4 * parts) for i in range(2 * parts, 5 * parts)))
    cloudbow.call("cloud", "import", text, "--format", "columns", "--voxel-size-m", size, size, size, "--columns", 8 * parts, 1, "-o", cloud)
    return cloud


def study_thick_voxels(options, cloudbow, folder):
    counts, finest = (1, 2, 4), 32
    studies = []
    for mu0 in (0.3, 0.6):
        found = {}
        for n in (*counts, finest):
            tables = [("cloud", {"file": str(wall(n, cloudbow, folder)), "quantity": "extinction", "single_scattering_albedo": 0.99,
                                 "phase_function": "droplets"}),
                      ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
                      ("sun", {"zenith_deg": support.zenith_deg(mu0), "azimuth_deg": 180.0, "irradiance_w_m2": 1 / mu0}), ("surface", {"albedo": 0.1}),
                      ("solver", {"tolerance": 1e-6, "control_points": 42, "directions": "double-gauss-6x8", "gather_directions": 16,
                                  "max_level_optical_depth": 0, "max_column_optical_depth": 0}),
                      ("output", {"fields": ["fluxes", "absorption"]})]
            found[n] = solve(f"wall_{n}_{mu0}", tables, cloudbow, folder)["absorbed_power"].reshape(4, n, 8, n).mean(axis=(1, 3))[:, 2:5]
        truth = found[finest]
        error = [math.sqrt(np.mean((found[n] - truth) ** 2)) / truth.mean() for n in counts]
        studies.append(Study(f"thick voxels, mu0 {mu0}", "width of a cell / voxel", "absorbed power by voxel, RMS / mean", f"voxels in {finest} x {finest} parts",
                             [1 / n for n in counts], error, "1.5 and more", 1.5))
    return studies


SMOOTH_MOMENTS = [1.0, 0.6, 0.36, 0.2, 0.1, 0.04]
POINTS = (42, 162, 642)


def study_control_points(options, cloudbow, folder):
    moments = folder / "moments.txt"
    moments.write_text("".join(f"{degree} {chi}\n" for degree, chi in enumerate(SMOOTH_MOMENTS)))
    *truth, own = by_adding(options, "sun", MU0, "irradiance", 1 / MU0, "layer", 2, 1, "legendre", moments)
    step = [math.sqrt(42 / count) for count in POINTS]
    studies = []
    for fit in ("collocation", "least-squares", "linear-programming"):
        found = [solve(f"points_{fit}_{count}", layer(2.0, 1.0, {"type": "legendre", "moments": SMOOTH_MOMENTS}, 200, fit=fit, control_points=count,
                       directions="double-gauss-16x24", delta_m_order=8), cloudbow, folder) for count in POINTS]
        studies.append(Study(f"control points, {fit}", "distance of control points / that of 42", "phase function, worst / its largest value", "the function", step,
                             [result.solver["fit_max_error"] for result in found], "2", 1.7))
    # Of the last fit, which is the solver's own.
    studies.append(Study("control points, fluxes", "distance of control points / that of 42", "worst of R and T", adding(own), step,
                         [worst_flux(result, truth) for result in found], "none", -math.inf, 2e-5))
    return studies


def study_ordinates(options, cloudbow, folder):
    polar = (4, 8, 16, 32)
    *truth, own = by_adding(options, "sun", MU0, "irradiance", 1 / MU0, "layer", 1, 1, "isotropic")
    errors = [worst_flux(solve(f"ordinates_{n}", layer(1.0, 1.0, "isotropic", 400, control_points=42, directions=f"double-gauss-{n}x4"), cloudbow, folder), truth)
              for n in polar]
    return [Study("ordinates, isotropic", "1 / polar angles", "worst of R and T", adding(own), [1 / n for n in polar], errors, "4 and more", 4)]


def plot(path, studies):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.4), constrained_layout=True)
    for axis, title, names in ((axes[0], "space", ("layer", "field", "thick")), (axes[1], "directions", ("control", "ordinates"))):
        for study, marker in zip((s for s in studies if s.name.startswith(names)), "osD^v"):
            slope = f"slope {study.slope:.1f}" if math.isfinite(study.least) else "no order: moments are held"
            axis.loglog(study.step, study.error, f"{marker}-", markersize=4, label=f"{study.name}: {study.quantity.split(',')[0]}, {slope}")
        steps = np.array(axis.get_xlim())
        for order, style in ((2, ":"), (4, "-.")):
            axis.loglog(steps, 0.02 * (steps / steps[1]) ** order, style, color="0.6", lw=1, label=f"order {order}")
        axis.set_xlim(steps)
        axis.set_ylim(bottom=axis.get_ylim()[0] / 300)  # room for the legend
        axis.set_title(title)
        axis.set_xlabel("cell / field or layer" if title == "space" else "distance of control points / that of 42; 1 / polar angles")
        axis.set_ylabel("error (fluxes: of incident)")
        axis.grid(True, which="major", alpha=0.3)
        axis.legend(fontsize=7, loc="lower right")
    figure.savefig(path, dpi=110)


STUDIES = {"layer": study_layer, "field": study_field, "thick-voxels": study_thick_voxels, "control-points": study_control_points, "ordinates": study_ordinates}


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("studies", nargs="*", metavar="STUDY", help=f"{', '.join(STUDIES)} (default: all)")
    plane_parallel_truths.add_program(parser)
    parser.add_argument("--plot", type=Path, help="write the picture (PNG)")
    return parser


def figures(options):
    unknown = set(options.studies) - set(STUDIES)
    if unknown:
        sys.exit(f"unknown study {', '.join(sorted(unknown))} (there are {', '.join(STUDIES)})")
    cloudbow = support.Cloudbow(options.cloudbow, options.threads or 1)
    with support.Workspace(options.keep) as folder:
        return [study for name in options.studies or STUDIES for study in STUDIES[name](options, cloudbow, folder)]


def main():
    options = arguments().parse_args()
    studies = figures(options)
    if options.plot:
        plot(options.plot, studies)
    for study in studies:
        print(f"{'ok   ' if study.good else 'FAIL '} {study.name}: {', '.join(f'{e:.2e}' for e in study.error)}; slope {study.slope:.2f} "
              f"(order {study.order}, at least {study.least:g})")
    return 0 if all(study.good for study in studies) else 1


if __name__ == "__main__":
    sys.exit(main())
