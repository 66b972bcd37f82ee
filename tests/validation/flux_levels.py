#!/usr/bin/env python3
"""Fluxes at a height are the same whichever levels are asked for. The printed error of the levels between holds.

Truth: in clear air above a cloud a plane is as good as the same plane as the top of the domain; a plane has the same bits whether it is listed
or one of all. With reference data (CLOUDBOW_REFERENCE_DIR): Monte Carlo fluxes at all levels of four fields of thick voxels.

usage: flux_levels.py --cloudbow PROGRAM [--accuracy balanced ...] [--keep FOLDER]
"""
import sys

import numpy as np

import support

SCENE = [
    ("cloud", {"file": "cloud.vdb", "quantity": "extinction", "single_scattering_albedo": 1.0, "phase_function": "droplets"}),
    ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
    ("sun", {"zenith_deg": 60.0, "azimuth_deg": 20.0}),
    ("surface", {"albedo": 0.1}),
    ("output", {"fields": ["fluxes"]}),
    ("[layer]", {"name": "clear air", "bottom_m": 800.0, "top_m": 2000.0, "optical_depth": 0.0, "single_scattering_albedo": 1.0,
                 "phase_function": "isotropic"}),
]
# Two sets of rays through the same field differ by the noise of either: measured 1.03 to 1.1.
SMOOTHNESS_LIMIT = 1.2
FLUXES = ("upwelling_flux", "downwelling_diffuse_flux", "direct_flux")


def heights_listed(heights):
    return "output.flux_levels=[" + ", ".join(repr(float(height)) for height in heights) + "]"


def check_clear_air(cloudbow, folder):
    """A cumulus field whose domain ends at 3 km, and the same whose domain ends at 2 km."""
    cloudbow.call("cloud", "make", "cumulus", "--cells", 30, 24, 16, "--voxel-size-m", 50, 50, 50, "--cover", 0.15, "--seed", 11,
                  "-o", folder / "cloud.vdb")

    def solve(name, top_m, *options):
        (folder / f"{name}.toml").write_text(support.scene_text(SCENE + [("domain", {"max_m": [1500.0, 1200.0, top_m]})]))
        return cloudbow.run(folder / f"{name}.toml", folder / f"{name}.h5", *options)

    everywhere = solve("all", 3000.0)
    ends = solve("ends", 2000.0, "--set", "output.flux_levels=boundaries")
    heights = everywhere.z_edge[1:-1:5]
    listed = solve("listed", 3000.0, "--set", heights_listed(heights))
    at_2_km = int(np.flatnonzero(everywhere.z_edge == 2000.0)[0])
    spread = [float(np.std(plane) / np.mean(plane)) for plane in (everywhere["upwelling_flux"][at_2_km], ends.upward_at_top())]
    print(f"spread of the columns' flux up at 2 km: one of all levels {100 * spread[0]:.3f} %, top of the domain {100 * spread[1]:.3f} %")
    good = spread[0] <= SMOOTHNESS_LIMIT * spread[1]
    for name in FLUXES:
        same = np.array_equal(listed.fields[name], everywhere.fields[name][1:-1:5])
        print(f"{name}: listed levels {'have the bits of' if same else 'DIFFER from'} the same levels of all")
        good = good and same
    return good


def thick_truth(reference, name):
    """Heights, and fluxes up and down with their standard errors, (z, y, x) of each, per incident flux."""
    lines = [line for line in (reference / f"{name}_fluxes.csv").read_text().splitlines() if not line.startswith("#")]
    table = np.array([[float(number) for number in line.split(",")] for line in lines[1:]])
    column = dict(zip(lines[0].split(","), table.T))
    heights = np.unique(column["z_m"])
    order = np.lexsort((column["ix"], column["iy"], column["z_m"]))
    shape = (len(heights), int(column["iy"].max()) + 1, int(column["ix"].max()) + 1)
    return heights, {key: column[key][order].reshape(shape) for key in ("up", "up_se", "down", "down_se")}


def check_thick_fields(cloudbow, folder, levels):
    reference = support.reference_folder()
    if reference is None or not (reference / "thick_clouds").is_dir():
        print("skipped: fields of thick voxels (CLOUDBOW_REFERENCE_DIR does not name reference data)")
        return True
    good = True
    rows = []
    for name in ("cu7", "stcu9", "chimney", "slab2d"):
        heights, truth = thick_truth(reference / "thick_clouds", name)
        row = [name]
        for accuracy in levels:
            result = cloudbow.run(reference / "thick_clouds" / f"{name}.toml", folder / f"{name}.h5", "--set", f"solver.accuracy={accuracy}",
                                  "--set", 'output.fields=["fluxes"]', accept=(0, 3), error_estimate=True)
            found = {"up": result["upwelling_flux"] / 1000, "down": (result["downwelling_diffuse_flux"] + result["direct_flux"]) / 1000}
            worst = 0.0
            for n, height in enumerate(heights):
                plane = int(np.argmin(abs(result.z_edge - height)))
                for flux, is_end in (("up", n == len(heights) - 1), ("down", n == 0)):
                    if is_end or np.mean(truth[flux][n]) < 1e-3:  # errors of hardly any light are not in terms of it
                        continue
                    worst = max(worst, support.rms_percent(found[flux][plane], truth[flux][n], truth[f"{flux}_se"][n]))
            estimated = 100 * result.error_estimate["columns_between"]
            row += [f"{worst:.1f}", f"{estimated:.0f}" if estimated >= 10 else f"{estimated:.1f}"]
            good = good and estimated >= worst
        rows.append(row)
    print(support.markdown_table(["field"] + [cell for accuracy in levels for cell in (f"true, {accuracy}", "estimated")], rows))
    return good


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--accuracy", nargs="+", default=["balanced"], help="levels for the fields of thick voxels")
    options = parser.parse_args()
    cloudbow = support.Cloudbow(options.cloudbow.resolve(), options.threads)
    with support.Workspace(options.keep) as folder:
        good = check_clear_air(cloudbow, folder)
        good = check_thick_fields(cloudbow, folder, options.accuracy) and good
    print("pass" if good else "FAIL")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
