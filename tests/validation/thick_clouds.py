#!/usr/bin/env python3
"""Clouds with voxels of several optical depths: fluxes by column, voxels and images against Monte Carlo.

Truth: an independent Monte Carlo on the same cells of constant extinction. Its tables are in the folder thick_clouds of CLOUDBOW_REFERENCE_DIR
(skipped without it). --folder names another folder of the same form. A scene is NAME.toml with its cloud and NAME_fluxes.csv; NAME_cells.csv and
NAME_radiance.csv are optional. The standard errors of the tables are taken out of every RMS. Prints one row per scene and accuracy, in %.

up, down: RMS / mean over the columns, up at the highest level, down with the direct beam at the lowest.
dR, dT: reflectance and transmittance of the domain, less the truth, of incident.
absorbed: RMS / mean over the absorbing cells, and difference of the totals.
actinic: RMS / mean over the cells. This field takes much of the CPU time; --set 'output.fields=["fluxes","absorption"]' leaves it out.
estimated: the program's own estimates of the errors `up` and `down`.
images: RMS / mean, and bias of the mean, by view.
sweeps: also says if the iteration did not converge.
CPU s: of the whole process, on one thread by default. The coarse solves are included unless --no-error-estimate is given.

usage: thick_clouds.py --cloudbow PROGRAM [--scenes NAME,...] [--accuracy LEVEL,...] [--set KEY=VALUE] [--folder DIR] [--limits]
"""
import csv
import json
import resource
import sys
import textwrap
import tomllib
from pathlib import Path

import numpy as np

import support
from support import Failure

SCENES = ("cu7", "stcu9", "chimney", "slab2d")
HEADER = ("scene", "accuracy", "up", "down", "dR", "dT", "absorbed", "actinic", "estimated", "images", "sweeps", "CPU s")
# Figures with limits; those of images, NAME_RMS and NAME_bias, have them too.
JUDGED = ("up", "down", "dR", "dT", "absorbed", "absorbed_total", "actinic")
# Least limits of figures that may be next to 0 by chance, because errors of both signs cancel [%].
LEAST_LIMITS = {"dR": 0.05, "dT": 0.05, "absorbed_total": 0.2, "bias": 0.5}
# Limits of the sizes of figures [%]: measured + 10 % (--new-limits).
LIMITS = {
    ("cu7", "draft"): dict(up=3.13, down=3.61, dR=1.28, dT=1.44, absorbed=14.1, absorbed_total=1.3, actinic=5.16, v0_RMS=19, v0_bias=1.58,
        v1_RMS=35.7, v1_bias=13.4, v2_RMS=25, v2_bias=7.26, v3_RMS=28.8, v3_bias=4.72),
    ("cu7", "balanced"): dict(up=1.18, down=1.25, dR=0.477, dT=0.545, absorbed=5.78, absorbed_total=1.28, actinic=2.83, v0_RMS=6.12, v0_bias=0.5,
        v1_RMS=10.1, v1_bias=2.27, v2_RMS=7.79, v2_bias=1.59, v3_RMS=16.5, v3_bias=1.54),
    ("stcu9", "draft"): dict(up=3.03, down=2.55, dR=0.122, dT=0.127, actinic=6.24, v0_RMS=11.1, v0_bias=0.594, v1_RMS=16.3, v1_bias=2.43, v2_RMS=11.4,
        v2_bias=5.04, v3_RMS=11.5, v3_bias=1.25),
    ("stcu9", "balanced"): dict(up=1.52, down=0.642, dR=0.0968, dT=0.105, actinic=1.82, v0_RMS=2.88, v0_bias=0.5, v1_RMS=3.82, v1_bias=0.516,
        v2_RMS=2.17, v2_bias=0.5, v3_RMS=4.25, v3_bias=1.25),
    ("chimney", "draft"): dict(up=0.462, down=2.18, dR=0.133, dT=0.148, absorbed=0.855, absorbed_total=0.2, actinic=1.25, v0_RMS=0.58, v0_bias=0.5,
        v1_RMS=1.31, v1_bias=0.996, v2_RMS=3.32, v2_bias=2),
    ("chimney", "balanced"): dict(up=0.299, down=0.779, dR=0.0555, dT=0.05, absorbed=0.704, absorbed_total=0.484, actinic=0.754, v0_RMS=0.44,
        v0_bias=0.5, v1_RMS=1.38, v1_bias=1.04, v2_RMS=2.33, v2_bias=0.634),
    ("slab2d", "draft"): dict(up=10.4, down=12.9, dR=2.25, dT=0.26, absorbed=13.2, absorbed_total=3.71, actinic=13.3),
    ("slab2d", "balanced"): dict(up=0.949, down=4.1, dR=0.05, dT=0.0543, absorbed=3.03, absorbed_total=0.2, actinic=3.35),
    ("cu21", "balanced"): dict(up=0.616, down=0.607, dR=0.05, dT=0.0738),
    ("cu33", "balanced"): dict(up=0.721, down=0.924, dR=0.126, dT=0.18),
    ("flat", "balanced"): dict(up=3.4, down=3.45, dR=0.304, dT=0.285),
    ("sc12", "balanced"): dict(up=1.87, down=1.94, dR=0.117, dT=0.14),
    ("sc31", "balanced"): dict(up=1.54, down=1.03, dR=0.107, dT=0.115),
    ("wall", "balanced"): dict(up=2.47, down=3.55, dR=0.219, dT=0.235),
    ("cu51", "balanced"): dict(up=0.41, down=1.37, dR=0.103, dT=0.152),
    ("cu53", "balanced"): dict(up=0.553, down=1.13, dR=0.05, dT=0.0778),
    ("cu55", "balanced"): dict(up=2.21, down=2.04, dR=0.254, dT=0.0915),
    ("sc52", "balanced"): dict(up=2.06, down=1.39, dR=0.05, dT=0.05),
    ("sc54", "balanced"): dict(up=2.08, down=3.2, dR=0.05, dT=0.0921),
}


def table(path, size):
    """Columns of a CSV file below its header, by name; `size` is how many lines precede the numbers."""
    with open(path) as file:
        header, *rows = list(csv.reader(file))[size - 1:]
    values = np.array(rows, float)
    return {name: values[:, n] for n, name in enumerate(header)}


def plane(data, chosen, name):
    """[iy, ix] of the chosen rows of a table."""
    iy, ix = data["iy"][chosen].astype(int), data["ix"][chosen].astype(int)
    values = np.full((iy.max() + 1, ix.max() + 1), np.nan)
    if len(set(zip(iy, ix))) != values.size or iy.size != values.size:
        raise Failure(f"{name}: the truth does not have every column once")
    values[iy, ix] = data[name][chosen]
    return values


def index_of(z_edge, height):
    index = int(np.argmin(np.abs(z_edge - height)))
    if abs(z_edge[index] - height) > 1e-3:
        raise Failure(f"the result has no interface at {height} m")
    return index


def known(values, what):
    if not np.isfinite(values).all():
        raise Failure(f"{what}: values that are not numbers")
    return values


def flux_figures(result, truth, incident):
    """Columns at top and bottom, and the domain's differences."""
    figures = {}
    for name, domain, height, value in (("up", "dR", truth["z_m"].max(), result.upward_at_top()),
                                        ("down", "dT", truth["z_m"].min(), result.downward_at_bottom())):
        index_of(result.z_edge[[-1 if name == "up" else 0]], height)
        chosen = truth["z_m"] == height
        reference = plane(truth, chosen, name)
        value = known(value, f"flux {name}")
        figures[name] = support.rms_percent(value / incident, reference, plane(truth, chosen, f"{name}_se"))
        figures[domain] = 100 * float(value.mean() / incident - reference.mean())
    return figures


def mean_between(result, name, bottom, top, incident):
    """[y, x] of a field of cells, mean over heights between two interfaces."""
    first, last = index_of(result.z_edge, bottom), index_of(result.z_edge, top)
    return np.average(result[name][first:last], axis=0, weights=np.diff(result.z_edge[first:last + 1])) / incident


def cell_figures(result, truth, incident):
    """Absorbed power and actinic flux by cell. A cell of the truth may span several of the result; one without number (NaN) does not count."""
    figures = {}
    edges = sorted(set(zip(truth["z_bottom_m"], truth["z_top_m"])))
    layers = [truth["z_bottom_m"] == bottom for bottom, _ in edges]
    thickness = np.array([top - bottom for bottom, top in edges])
    for name, variable in (("absorbed", "absorbed_power"), ("actinic", "actinic_flux")):
        if variable not in result.fields:
            continue
        value = np.array([mean_between(result, variable, bottom, top, incident) for bottom, top in edges])
        reference, error = (np.array([plane(truth, layer, column) for layer in layers]) for column in (name, f"{name}_se"))
        counted = reference > 0
        if not counted.any():
            continue
        figures[name] = support.rms_percent(known(value[counted], variable), reference[counted], error[counted])
        if name == "absorbed":
            total, wanted = (float(np.tensordot(thickness, field, 1).sum()) for field in (value, reference))
            figures["absorbed_total"] = 100 * (total / wanted - 1)
    return figures


def image_figures(result, truth, views, incident):
    figures = {}
    for view in views:
        chosen = (np.abs(truth["view_zenith_deg"] - view["zenith_deg"]) < 1e-6) & (truth["ix"] >= 0)
        chosen &= np.abs(truth["view_azimuth_deg"] - view.get("azimuth_deg", 0)) < 1e-6
        if not chosen.any():
            continue
        reference = plane(truth, chosen, "radiance")
        value = known(result[f"radiance_{view['name']}"], view["name"]) / incident
        figures[f"{view['name']}_RMS"] = support.rms_percent(value, reference, plane(truth, chosen, "se"))
        figures[f"{view['name']}_bias"] = 100 * float(value.mean() / reference.mean() - 1)
    return figures


def cpu_seconds_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def figures_of(cloudbow, scene, accuracy, folder, settings, error_estimate):
    """All figures of a run [%]."""
    begin = cpu_seconds_of_children()
    options = [word for setting in (f"solver.accuracy={accuracy}", *settings) for word in ("--set", setting)]
    result = cloudbow.run(scene, folder / f"{scene.stem}_{accuracy}.h5", *options, accept=(0, 3), error_estimate=error_estimate)
    seconds = cpu_seconds_of_children() - begin
    # Power through the horizontal top; nothing but the sun shines and the top lies above all matter.
    incident = float(result["direct_flux"][-1].mean())

    def data(part):
        path = scene.with_name(f"{scene.stem}_{part}.csv")
        return table(path, 2) if path.exists() else None

    figures = flux_figures(result, data("fluxes"), incident)
    if (cells := data("cells")) is not None:
        figures |= cell_figures(result, cells, incident)
    if (radiance := data("radiance")) is not None:
        views = tomllib.loads(scene.read_text()).get("radiance", [])
        figures |= image_figures(result, radiance, views, incident)
    estimated = {f"estimated_{side}": 100 * float(result.error_estimate[f"columns_{side}"]) for side in ("up", "down") if result.error_estimate}
    return {"scene": scene.stem, "accuracy": accuracy, **figures, **estimated, "coarse_cpu_seconds": float(result.error_estimate.get("cpu_seconds", 0)),
            "sweeps": int(result.solver["sweeps"]), "converged": bool(result.solver["converged"]), "cpu_seconds": seconds}


def views_of(figures):
    return [name.removesuffix("_RMS") for name in figures if name.endswith("_RMS")]


def row_of(figures):
    """The cells of a printed row."""
    def shown(*names, form="{:.2f}"):
        return "/".join(form.format(figures[name]) for name in names) if names[0] in figures else "-"

    images = ", ".join(f"{view} " + shown(f"{view}_RMS", form="{:.1f}") + shown(f"{view}_bias", form="/{:+.1f}") for view in views_of(figures))
    return (figures["scene"], figures["accuracy"], shown("up"), shown("down"), shown("dR", form="{:+.3f}"), shown("dT", form="{:+.3f}"),
            shown("absorbed") + (shown("absorbed_total", form="/{:+.2f}") if "absorbed" in figures else ""), shown("actinic"),
            shown("estimated_up", "estimated_down"), images or "-", f"{figures['sweeps']}{'' if figures['converged'] else ' not converged'}", shown("cpu_seconds"))


def judged(figures):
    """Sizes of the figures that have limits, by name."""
    names = [*JUDGED, *(f"{view}_{part}" for view in views_of(figures) for part in ("RMS", "bias"))]
    return {name: abs(figures[name]) for name in names if name in figures}


def above_limits(figures):
    """Faults of a run, in words."""
    limits = LIMITS.get((figures["scene"], figures["accuracy"]))
    if limits is None:
        return ["has no limits"]
    sizes = judged(figures)
    faults = [f"{name} {size:.3g} % is above {limits[name]:.3g}" for name, size in sizes.items() if name in limits and size > limits[name]]
    faults += [f"{name} has no figure" for name in limits if name not in sizes]
    return faults + ([] if figures["converged"] else ["not converged"])


def new_limits(rows):
    """The table LIMITS as source text."""
    lines = ["LIMITS = {"]
    for figures in rows:
        least = {name: LEAST_LIMITS.get("bias" if name.endswith("_bias") else name, 0) for name in judged(figures)}
        limits = [f"{name}={max(least[name], 1.1 * size):.3g}" for name, size in judged(figures).items()]
        text = f'("{figures["scene"]}", "{figures["accuracy"]}"): dict({", ".join(limits)}),'
        lines += textwrap.wrap(text, 150, initial_indent="    ", subsequent_indent=" " * 8, break_long_words=False)
    return "\n".join([*lines, "}"])


def scene_files(options):
    """The scenes to run; skips if there are no data."""
    if options.folder:
        folder, names = options.folder, sorted(path.name.removesuffix("_fluxes.csv") for path in options.folder.glob("*_fluxes.csv"))
    else:
        reference = options.reference or support.reference_folder()
        if reference is None:
            support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with thick_clouds/")
        folder, names = reference / "thick_clouds", SCENES
    names = options.scenes.split(",") if options.scenes else names
    if not folder.is_dir():
        support.skip(f"no folder {folder}")
    missing = [name for name in names if not (folder / f"{name}.toml").exists() or not (folder / f"{name}_fluxes.csv").exists()]
    if missing or not names:
        raise SystemExit(f"{folder}: no scene with its truth: {', '.join(missing) or 'none at all'}")
    return [(folder / f"{name}.toml").resolve() for name in names]


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--reference", type=Path, metavar="FOLDER", help="reference data, with thick_clouds/ (default: $CLOUDBOW_REFERENCE_DIR)")
    parser.add_argument("--folder", type=Path, help="other scenes of the same form, in place of thick_clouds")
    parser.add_argument("--scenes", default="", metavar="NAME,...", help="some of them")
    parser.add_argument("--accuracy", default="balanced,fine", metavar="LEVEL,...", help="levels of accuracy (default: balanced,fine)")
    parser.add_argument("--set", dest="settings", action="append", default=[], metavar="KEY=VALUE", help="changes the scenes, as in cloudbow run")
    parser.add_argument("--no-error-estimate", action="store_true", help="without the coarse solves of the estimates: CPU seconds of the solve alone")
    parser.add_argument("--limits", action="store_true", help="exit code 1 if a figure is above its limit")
    parser.add_argument("--new-limits", action="store_true", help="print the table of limits that the figures make")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures")
    options = parser.parse_args()
    scenes = scene_files(options)
    cloudbow = support.Cloudbow(Path(options.cloudbow).resolve(), options.threads or 1)
    rows, faults = [], []
    print("| " + " | ".join(HEADER) + " |\n| " + " | ".join("---" for _ in HEADER) + " |", flush=True)
    with support.Workspace(options.keep) as folder:
        for scene in scenes:
            for accuracy in options.accuracy.split(","):
                try:
                    figures = figures_of(cloudbow, scene, accuracy, folder, options.settings, not options.no_error_estimate)
                except Failure as failure:
                    faults.append(f"{scene.stem}, {accuracy}: {failure}")
                    continue
                rows.append(figures)
                print("| " + " | ".join(row_of(figures)) + " |", flush=True)
                if options.limits:
                    faults += [f"{figures['scene']}, {accuracy}: {fault}" for fault in above_limits(figures)]
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    if options.new_limits:
        print(new_limits(rows))
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
