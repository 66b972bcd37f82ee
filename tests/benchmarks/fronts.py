#!/usr/bin/env python3
"""Error against time of every level of accuracy on six fields, with Monte Carlo and SHDOM if they have figures: a table and a picture.

Truth: Monte Carlo of CLOUDBOW_REFERENCE_DIR for step cloud, RICO and Landsat (its noise taken out of the RMS over columns), the level `reference` for
the scenes of configs/. Each code is scored against the truth of its own medium: cloudbow and Monte Carlo against Monte Carlo in cells, SHDOM
(shdom/rico32/summary_pareto.csv; trilinear between points) against an extrapolation of its own finest runs. Monte Carlo's error is its standard error,
which falls with the root of the photons: a line. CPU seconds on one thread; those of SHDOM are of another machine.
Fails if SHDOM has a smaller error in less time than a level of cloudbow.

usage: CLOUDBOW_REFERENCE_DIR=... fronts.py [FIELD ...] [--document docs/speed.md] [--plot docs/images/fronts.png]
"""
import csv
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "validation"))
import intercomparison  # noqa: E402
import monte_carlo  # noqa: E402
import support  # noqa: E402
from monte_carlo_references import job  # noqa: E402

COLUMNS = ("independent-columns", "independent-diffuse")  # modes, at draft
LEVELS = ("draft", "balanced", "fine", "reference")
ENDS = ("--set", "output.flux_levels=boundaries", "--set", 'output.fields=["fluxes"]')
FIELDS = {  # with a Monte Carlo truth: case and levels
    "step cloud": (intercomparison.CASES["step"][1], LEVELS),
    "RICO": (intercomparison.CASES["rico"][0], LEVELS),
    "Landsat": (intercomparison.CASES["landsat"][0], LEVELS[:2]),
}
SCENES = {"slab": "slab", "cumulus": "cumulus", "stratocumulus": "stratocumulus"}  # with the best level as truth


class Point:
    def __init__(self, label, seconds, megabytes, domain, up, down):
        self.label, self.seconds, self.megabytes = label, seconds, megabytes
        self.domain, self.up, self.down = domain, up, down

    def cells(self):
        error = lambda e: f"{e:.2g}" if e < 1 else f"{e:.3g}"
        return [self.label, f"{self.seconds:.2g}" if self.seconds < 10 else f"{self.seconds:.0f}", "" if math.isnan(self.megabytes) else f"{self.megabytes:.0f}", error(self.domain), error(self.up),
                error(self.down)]


def settings(label):
    return ("--set", "solver.accuracy=draft", "--set", f"solver.mode={label}") if label in COLUMNS else ("--set", f"solver.accuracy={label}")


def against_monte_carlo(case, labels, references, cloudbow, folder):
    path = folder / "field.toml"
    path.write_text(intercomparison.scene(case, references / "fields", "draft"))
    truth = intercomparison.read_reference(references / case.reference)
    for label in labels:
        row = intercomparison.compare(case, cloudbow.run(path, folder / "field.h5", *settings(label), *ENDS, accept=(0, 3)), truth)
        yield Point(label, row["cpu_seconds"], row["memory_mb"], row["domain"], row["up"], row["down"])


def against_the_best(scene, cloudbow, folder):
    results = {label: cloudbow.run(support.ROOT / f"configs/{scene}.toml", folder / f"{label}.h5", *settings(label), *ENDS, accept=(0, 3))
               for label in (*COLUMNS[:1], *LEVELS)}
    truth = results[LEVELS[-1]]
    incident = float(np.mean(truth["direct_flux"][-1] + truth["downwelling_diffuse_flux"][-1]))
    for label in (*COLUMNS[:1], *LEVELS[:-1]):
        planes = [(r.upward_at_top(), r.downward_at_bottom()) for r in (results[label], truth)]
        domain = 100 * max(abs(a.mean() - b.mean()) for a, b in zip(*planes)) / incident
        up, down = (100 * math.sqrt(np.mean((a - b) ** 2)) / b.mean() for a, b in zip(*planes))
        yield Point(label, results[label].cpu_seconds, results[label].peak_memory_bytes / 1e6, domain, up, down)


def monte_carlo_point(case, references, options):
    solution = monte_carlo.MonteCarlo(options.monte_carlo).run(job(case, references / "fields", options), options.photons, seed=11)
    up, down = solution.up[1], solution.down[0]
    percent = lambda plane: 100 * math.sqrt(np.mean(intercomparison.blocks(plane.error, case.block, error=True) ** 2)) / plane.mean
    return Point(f"Monte Carlo, {solution.photons:.0e} photons", solution.cpu_seconds, math.nan, 100 * max(up.mean_error, down.mean_error), percent(up), percent(down))


def shdom_points(references):
    with open(references / "shdom/rico32/summary_pareto.csv") as file:
        for row in csv.DictReader(file):
            bias = max(abs(float(row["bias_up_pct"])) * float(row["R"]), abs(float(row["bias_dn_pct"])) * float(row["T"]))
            yield Point(f"SHDOM {row['nmu']} x {row['nphi']}, splitting {row['split']}" + (", transmin .1" if row["transmin"] != "1" else ""), float(row["solve_cpu_s"]),
                        float(row["shdom_needed_MB"]), bias, float(row["rms_up_pct"]), float(row["rms_dn_pct"]))


def dominated(ours, others):
    """Levels of ours than which another is both better and quicker, by quantity."""
    return [(own.label, other.label, quantity) for own in ours if own.label in LEVELS for other in others for quantity in ("domain", "up", "down")
            if other.seconds < own.seconds and getattr(other, quantity) < getattr(own, quantity)]


def picture(points, file):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(2, 3, figsize=(12, 7.2), constrained_layout=True)
    for axis, (name, all_points) in zip(axes.flat, points.items()):
        quantity, what = ("domain", "reflectance, transmittance") if name == "slab" else ("up", "columns up")
        own = [p for p in all_points if not p.label.startswith(("SHDOM", "Monte"))]
        axis.loglog([p.seconds for p in own if p.label in LEVELS], [getattr(p, quantity) for p in own if p.label in LEVELS], "-", color="0.6", lw=1)
        for p in own:
            axis.loglog(p.seconds, max(getattr(p, quantity), 1e-4), "o", color="tab:blue" if p.label in LEVELS else "tab:cyan")
            axis.annotate(p.label, (p.seconds, max(getattr(p, quantity), 1e-4)), fontsize=7, xytext=(4, 4), textcoords="offset points")
        shdom = [p for p in all_points if p.label.startswith("SHDOM")]
        if shdom:
            axis.loglog([p.seconds for p in shdom], [getattr(p, quantity) for p in shdom], "s", color="tab:red", label="SHDOM (another machine)")
        for p in (p for p in all_points if p.label.startswith("Monte")):
            spread = np.array([1e-2, 1e4])
            axis.loglog(p.seconds * spread, getattr(p, quantity) / np.sqrt(spread), "--", color="tab:green", lw=1, label="Monte Carlo")
        if axis.get_legend_handles_labels()[0]:
            axis.legend(fontsize=7)
        axis.set_title(name, fontsize=10)
        axis.set_xlabel("CPU seconds")
        axis.set_ylabel(f"error of {what}, %")
        axis.grid(True, which="major", alpha=.3)
    figure.savefig(file, dpi=110)


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("fields", nargs="*", metavar="FIELD", help=f"{', '.join((*SCENES, *FIELDS))} (default: all)")
    parser.add_argument("--photons", type=float, default=3e5, help="of the Monte Carlo run that gives its line")
    parser.add_argument("--document", type=Path, help="write the table between its markers `fronts`")
    parser.add_argument("--plot", type=Path, help="write the picture")
    monte_carlo.add_programs(parser)
    options = parser.parse_args()
    references = support.reference_folder()
    if references is None:
        support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with fields/, montecarlo/ and shdom/")
    cloudbow = support.Cloudbow(options.cloudbow, 1)
    points = {}
    with support.Workspace(options.keep) as folder:
        for name in options.fields or (*SCENES, *FIELDS):
            if name in SCENES:
                points[name] = list(against_the_best(SCENES[name], cloudbow, folder))
            else:
                case, levels = FIELDS[name]
                points[name] = list(against_monte_carlo(case, (*COLUMNS, *levels), references, cloudbow, folder))
                points[name].append(monte_carlo_point(case, references, options))
            if name == "RICO":
                points[name] += shdom_points(references)
            print("\n".join(" ".join([name, *p.cells()]) for p in points[name]), file=sys.stderr, flush=True)
    rows = [[name, *p.cells()] for name, found in points.items() for p in found]
    text = support.markdown_table(["field", "solved by", "CPU s", "MB", "domain %", "columns up %", "columns down %"], rows)
    print(text)
    if options.document:
        support.write_between_markers(options.document, "fronts", text)
    if options.plot:
        picture(points, options.plot)
    worse = dominated([p for p in points.get("RICO", []) if not p.label.startswith(("SHDOM", "Monte"))],
                      [p for p in points.get("RICO", []) if p.label.startswith("SHDOM")])
    for own, other, quantity in worse:
        print(f"{other} is better and quicker than {own}: {quantity}", file=sys.stderr)
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main())
