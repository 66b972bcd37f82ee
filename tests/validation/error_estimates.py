#!/usr/bin/env python3
"""How honest the error estimates of `cloudbow run` are: estimated against true errors, over scenes whose truth is known.

Truths: the plane-parallel cases (discrete ordinates); the step cloud, RICO and, if requested, Landsat (Monte Carlo). Also the isolated
clouds of column_fluxes.py and clouds with thick voxels (Monte Carlo). Noise is taken out. Each is solved at every level named; per level and flux (domain, columns up, columns down) there is one row
of the table. An estimate is good if it is no less than the true error and yet not much more.

Every second case of each group, by name, is what the factors of src/app/planning/error_calibration.cpp were fitted to (`--fit` does it again and prints
them); the other half is what the figures are to be read from.

usage: error_estimates.py [--accuracy draft balanced fine] [--csv FILE] [--plot FILE.png] [--fit] [--landsat] [--table FILE NAME]
"""
import csv
import json
import math
import re
import sys
from pathlib import Path

import numpy as np

import column_fluxes
import intercomparison
import plane_parallel
import support
import thick_clouds
from support import ROOT

FLUXES = ("domain", "columns_up", "columns_down")
# Below this no error matters and the truths themselves are in doubt: 1e-6 of incident, of columns 1e-5 of the mean.
NEGLIGIBLE = {"domain": 1e-6, "columns_up": 1e-5, "columns_down": 1e-5}


def row_of(group, case, accuracy, result_path, result, true):
    import h5py
    with h5py.File(result_path) as file:
        found = {name: support.plain(value) for name, value in file["error_estimate"].attrs.items()}
    rows = []
    for flux in FLUXES:
        rows.append({"group": group, "case": case, "accuracy": accuracy, "flux": flux, "true": true[flux], "estimate": found[flux],
                     "angular_distance": found[f"{flux}_angular_distance"], "spatial_distance": found[f"{flux}_spatial_distance"],
                     "iteration": found[f"{flux}_iteration"], "cpu_seconds": result.cpu_seconds, "companion_cpu_seconds": found["cpu_seconds"]})
    return rows


def without_noise(difference, noise):
    return math.sqrt(max(0.0, difference**2 - noise**2))


def plane_parallel_rows(options, cloudbow, folder):
    reference = options.reference / "plane_parallel.json" if options.reference and not options.subset else ROOT / "tests/data/plane_parallel_subset.json"
    cases = [case for case in json.loads(reference.read_text())["cases"] if case["thermal"] is None]

    def solve(job):
        case, accuracy = job
        text, heights = plane_parallel.layers_scene(case, accuracy, column_fluxes.C1_MOMENTS)
        scene, output = folder / f"{case['id']}_{accuracy}.toml", folder / f"{case['id']}_{accuracy}.h5"
        scene.write_text(text)
        result = cloudbow.run(scene, output, accept=(0, 3), error_estimate=True)
        incident = case["mu0"] * case["F0"] + math.pi * case["isotropic_top"]
        top, bottom = case["results"]["levels"][0], case["results"]["levels"][-1]
        up, down = top["flux_up"], bottom["flux_down_diffuse"] + bottom["flux_down_direct"]
        up_error = abs(float(result.upward_at_top().mean()) - up)
        down_error = abs(float(result.downward_at_bottom().mean()) - down)
        # Its estimate is of the worst level, too.
        true = {"domain": plane_parallel.errors(case, result, heights)["profile"] / 100, "columns_up": up_error / up if up > 0 else 0.0,
                "columns_down": down_error / down if down > 0 else 0.0}
        rows = row_of("plane-parallel", case["id"], accuracy, output, result, true)
        # A flux that is next to nothing has no relative error worth the name.
        return [row for row in rows if not (row["flux"] == "columns_up" and up < 1e-3 * incident) and not (row["flux"] == "columns_down" and down < 1e-3 * incident)]

    jobs = [(case, accuracy) for case in cases for accuracy in options.accuracy]
    return [row for rows in support.in_parallel(options.jobs, solve, jobs) for row in rows]


def isolated_rows(options, cloudbow, folder):
    references, rows = column_fluxes.read_reference(), []
    for case in column_fluxes.CASES:
        cloud = column_fluxes.write_cloud(case, cloudbow, folder)
        planes = dict(zip(column_fluxes.QUANTITIES, references[case.name]))
        for accuracy in options.accuracy:
            scene, output = folder / "isolated.toml", folder / "isolated.h5"
            scene.write_text(column_fluxes.scene(case, cloud, accuracy))
            result = cloudbow.run(scene, output, accept=(0, 3), error_estimate=True)
            true = {}
            means = []
            for flux, name, plane in (("columns_up", "up_top", result.upward_at_top()), ("columns_down", "down_bottom", result.downward_at_bottom())):
                value, error = planes[name]
                true[flux] = support.rms_percent(plane, value, error) / 100
                noise = math.sqrt(float((error**2).sum())) / error.size
                means.append(without_noise(float(plane.mean() - value.mean()), noise))
            true["domain"] = max(means)  # unit flux comes in
            rows += row_of("isolated clouds", case.name, accuracy, output, result, true)
    return rows


def thick_rows(options, cloudbow, folder):
    """Clouds with voxels of several optical depths, of tests/data and of the reference folder."""
    folders = [ROOT / "tests/data/thick_clouds"] + ([options.reference / "thick_clouds"] if options.reference else [])
    rows = []
    for path in folders:
        for scene in sorted(path.glob("*.toml")):
            for accuracy in options.accuracy:
                # Fluxes alone: images and fields of cells have no estimates.
                text = scene.read_text().split("[[radiance]]")[0].replace(f'"{scene.stem}.vdb"', f'"{(path / scene.stem).resolve()}.vdb"')
                alone = folder / f"{scene.stem}.toml"
                alone.write_text(re.sub(r"fields = \[.*\]", 'fields = ["fluxes"]\nflux_levels = "boundaries"', text)
                                 .replace('accuracy = "balanced"', f'accuracy = "{accuracy}"'))
                output = folder / "thick.h5"
                result = cloudbow.run(alone, output, accept=(0, 3), error_estimate=True)
                truth = thick_clouds.table(scene.with_name(f"{scene.stem}_fluxes.csv"), 2)
                found = thick_clouds.flux_figures(result, truth, float(result["direct_flux"][-1].mean()))
                true = {"domain": max(abs(found["dR"]), abs(found["dT"])) / 100, "columns_up": found["up"] / 100, "columns_down": found["down"] / 100}
                rows += row_of("thick voxels", scene.stem, accuracy, output, result, true)
    return rows


def field_rows(options, cloudbow, folder):
    if options.reference is None:
        return []
    rows = []
    for name in ["step", "rico"] + (["landsat"] if options.landsat else []):
        for case in intercomparison.CASES[name]:
            for accuracy in options.accuracy:
                if name == "landsat" and accuracy == "fine":
                    continue
                scene, output = folder / "field.toml", folder / "field.h5"
                scene.write_text(intercomparison.scene(case, options.reference / "fields", accuracy))
                result = cloudbow.run(scene, output, accept=(0, 3), error_estimate=True)
                found = intercomparison.compare(case, result, intercomparison.read_reference(options.reference / case.reference))
                true = {"domain": without_noise(found["domain"], found["domain_noise"]) / 100, "columns_up": found["up"] / 100, "columns_down": found["down"] / 100}
                rows += row_of(name, case.name, accuracy, output, result, true)
    return rows


def halves(rows):
    """Whether each row's case is of the half that factors are fitted to."""
    order = {}
    for group in {row["group"] for row in rows}:
        for n, case in enumerate(sorted({row["case"] for row in rows if row["group"] == group})):
            order[group, case] = n % 2 == 0
    return [order[row["group"], row["case"]] for row in rows]


def share(rows):
    """Of estimates that are no less than the true error."""
    return sum(row["estimate"] >= row["true"] or row["true"] <= NEGLIGIBLE[row["flux"]] for row in rows) / len(rows)


def median_ratio(rows):
    ratios = [row["estimate"] / row["true"] for row in rows if row["true"] > NEGLIGIBLE[row["flux"]]]
    return float(np.median(ratios)) if ratios else math.nan


def is_column(row):
    return row["group"] == "plane-parallel"


def with_weights(rows, weights):
    """Estimates as the program works them out (src/results/error_estimate.cpp)."""
    angular, spatial, least = weights
    part = {name: np.array([row[name] for row in rows]) for name in ("angular_distance", "spatial_distance", "iteration")}
    return np.sqrt(np.maximum(least, angular * part["angular_distance"])**2 + (spatial * part["spatial_distance"])**2 + part["iteration"]**2)


def fit(rows, column):
    """Angular and spatial weight and the least: of those that hold for the wanted share of rows the ones with the least median of estimate / true."""
    true = np.array([row["true"] for row in rows])
    matters = true > NEGLIGIBLE[rows[0]["flux"]]
    # Fields are few: all of them are to hold, with something to spare, and the spatial part has a share of its own in any case.
    wanted, spare, shares, floors = (0.96, 1.0, (0, 0.1, 0.3), (0, 1, 3, 10, 30)) if column else (1.0, 1.7, (0.3, 1, 2, 4, 8), (0,))
    best = None
    for least in NEGLIGIBLE[rows[0]["flux"]] * np.array(floors):
        for share_of_spatial in shares:
            low, high = 1e-4, 30.0
            for _ in range(40):
                factor = math.sqrt(low * high)
                holds = np.mean((with_weights(rows, (factor, factor * share_of_spatial, least)) >= true) | ~matters) >= wanted
                low, high = (low, factor) if holds else (factor, high)
            estimate = with_weights(rows, (high, high * share_of_spatial, least))
            cost = float(np.median(np.log(np.maximum(estimate, 1e-12)[matters] / true[matters]))) if matters.any() else 0.0
            if high < 29 and (best is None or cost < best[0]):
                best = (cost, (float(f"{spare * high:.2g}"), float(f"{spare * high * share_of_spatial:.2g}"), float(f"{least:.1g}")))
    return best[1]


def fit_all(rows, accuracies):
    """Prints the weights as src/app/planning/error_calibration.cpp has them. Estimates by them replace those in the rows."""
    learned = halves(rows)
    for column in (False, True):
        for accuracy in accuracies:
            weights = {}
            for flux in FLUXES:
                here = [(row, mine) for row, mine in zip(rows, learned) if row["flux"] == flux and row["accuracy"] == accuracy and is_column(row) == column]
                if not here:
                    continue
                weights[flux] = fit([row for row, mine in here if mine], column)
                for (row, _), estimate in zip(here, with_weights([row for row, _ in here], weights[flux])):
                    row["estimate"] = float(estimate)
            if weights:
                parts = [", ".join(f"{weights[flux][n]:g}" for flux in FLUXES) for n in range(3)]
                print(f"{'column' if column else 'field'} {accuracy}: {{{{{parts[0]}}}, {{{parts[1]}}}, {{{parts[2]}}}}}")
    # Error that the planner expects of a level, from the estimate of the draft: the upper quartile.
    index = {(row["case"], row["flux"], row["accuracy"]): row["estimate"] for row in rows}
    for column in (False, True):
        for accuracy in accuracies:
            ratios = []
            for flux in FLUXES:
                values = [row["estimate"] / index[row["case"], flux, "draft"] for row in rows if row["flux"] == flux and row["accuracy"] == accuracy
                          and is_column(row) == column and index.get((row["case"], flux, "draft"), 0) > 10 * NEGLIGIBLE[flux]]
                ratios.append(f"{np.percentile(values, 75):.2g}" if values else "-")
            print(f"{'column' if column else 'field'} {accuracy}: ratio to draft {{{', '.join(ratios)}}}")


def table(rows):
    learned = halves(rows)
    lines = []
    kinds = {"plane-parallel": is_column, "clouds in 2D and 3D": lambda row: not is_column(row)}
    for kind, belongs in kinds.items():
        for accuracy in dict.fromkeys(row["accuracy"] for row in rows):
            for flux in FLUXES:
                those = [(row, mine) for row, mine in zip(rows, learned) if belongs(row) and row["accuracy"] == accuracy and row["flux"] == flux]
                if not those:
                    continue
                fitted, other = [row for row, mine in those if mine], [row for row, mine in those if not mine]
                lines.append([kind, accuracy, flux, len(those), f"{100 * share(fitted):.0f} %", f"{100 * share(other):.0f} %", f"{median_ratio(fitted):.1f}", f"{median_ratio(other):.1f}"])
    for name, part in (("fitted half", True), ("other half", False)):
        those = [row for row, mine in zip(rows, learned) if mine == part]
        lines.append([f"**all, {name}**", "", "", len(those), *((f"{100 * share(those):.1f} %", "") if part else ("", f"{100 * share(those):.1f} %")),
                      *((f"{median_ratio(those):.1f}", "") if part else ("", f"{median_ratio(those):.1f}"))])
    return support.markdown_table(["scenes", "accuracy", "flux", "rows", "held, fitted half", "held, other half", "median estimate / true, fitted half", "other half"], lines)


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        for row in rows:
            writer.writerow({name: f"{value:.4g}" if isinstance(value, float) else value for name, value in row.items()})


def plot(path, rows):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 3, figsize=(12, 4.2), sharex=True, sharey=True)
    for axis, flux in zip(axes, FLUXES):
        for kind, marker, colour in ((True, ".", "tab:blue"), (False, "x", "tab:red")):
            those = [row for row in rows if row["flux"] == flux and is_column(row) == kind]
            axis.loglog([100 * max(row["true"], 1e-7) for row in those], [100 * max(row["estimate"], 1e-7) for row in those], marker, color=colour,
                        markersize=4, label="plane-parallel" if kind else "clouds in 2D and 3D")
        axis.plot([1e-5, 30], [1e-5, 30], "k-", linewidth=0.8)
        axis.set_title(flux.replace("_", " "))
        axis.set_xlabel("true error, %")
    axes[0].set_ylabel("estimated error, %")
    axes[0].legend(loc="lower right")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--reference", type=Path, default=support.reference_folder())
    parser.add_argument("--accuracy", nargs="+", default=["draft", "balanced", "fine"])
    parser.add_argument("--jobs", type=int, default=1, help="plane-parallel scenes at a time")
    parser.add_argument("--csv", type=Path, help="write all rows")
    parser.add_argument("--only", choices=["plane-parallel", "clouds"], help="these scenes alone")
    parser.add_argument("--subset", action="store_true", help="of the plane-parallel cases those in tests/data")
    parser.add_argument("--read", type=Path, nargs="+", help="rows of earlier runs (--csv), in place of solving")
    parser.add_argument("--plot", type=Path, help="write the scatter plot (PNG)")
    parser.add_argument("--fit", action="store_true", help="fit the weights anew, print them, and judge the estimates that they make")
    parser.add_argument("--landsat", action="store_true", help="with Landsat (minutes)")
    parser.add_argument("--share", type=float, default=0.95, help="least share of estimates that hold")
    parser.add_argument("--median", type=float, default=5, help="largest median of estimate / true")
    parser.add_argument("--table", nargs=2, metavar=("FILE", "NAME"), help="write the table between the markers NAME of a document")
    options = parser.parse_args()
    if options.read:
        rows = [{name: value if name in ("group", "case", "accuracy", "flux") else float(value) for name, value in row.items()}
                for path in options.read for row in csv.DictReader(open(path))]
    else:
        cloudbow = support.Cloudbow(options.cloudbow, options.threads or 1)
        with support.Workspace(options.keep) as folder:
            rows = []
            if options.only != "plane-parallel":
                rows += thick_rows(options, cloudbow, folder) + isolated_rows(options, cloudbow, folder) + field_rows(options, cloudbow, folder)
            if options.only != "clouds":
                rows += plane_parallel_rows(options, cloudbow, folder)
    if options.fit:
        fit_all(rows, list(dict.fromkeys(row["accuracy"] for row in rows)))
    if options.csv:
        write_csv(options.csv, rows)
    if options.plot:
        plot(options.plot, rows)
    print(table(rows))
    if options.table:
        support.write_between_markers(*options.table, table(rows))
    other = [row for row, mine in zip(rows, halves(rows)) if not mine]
    bad = share(other) < options.share or median_ratio(other) > options.median
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
