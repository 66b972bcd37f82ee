#!/usr/bin/env python3
"""A result opens in the tools that people use: xarray with both engines, ncdump, h5dump; units, coordinates and names are right.

Truth: the table of variables in docs/result-reference.md. Runs a small scene, or looks at the result that is given.

usage: check_result_file.py [RESULT.h5]
"""
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import xarray

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import support

DIMENSIONS = {
    "upwelling_flux": ("z_edge", "y", "x"),
    "downwelling_diffuse_flux": ("z_edge", "y", "x"),
    "direct_flux": ("z_edge", "y", "x"),
    "absorbed_power": ("z", "y", "x"),
    "actinic_flux": ("z", "y", "x"),
    "optical_depth": ("y", "x"),
    "extinction": ("z", "y", "x"),
}
UNITS = {"x": "m", "y": "m", "z": "m", "z_edge": "m", "upwelling_flux": "W m-2", "downwelling_diffuse_flux": "W m-2", "direct_flux": "W m-2",
         "absorbed_power": "W m-3", "actinic_flux": "W m-2", "optical_depth": "1", "extinction": "m-1"}
PROFILES = ("upwelling_flux", "downwelling_diffuse_flux", "direct_flux")
ROOT_ATTRIBUTES = ("Conventions", "title", "source", "history", "scene")
SUMMARY = ("reflectance", "transmittance", "transmittance_direct", "absorptance", "surface_absorptance", "side_gain", "side_loss", "energy_residual")
SOLVER = ("converged", "sweeps", "estimated_error", "gather_rescaling", "control_points", "directions", "mode", "active_voxels", "threads",
          "seconds_total", "seconds_tables", "seconds_sweeps", "seconds_scattering", "peak_memory_bytes")
DEPTH = 3
SCENE = [
    ("", {"title": "A slab under a Rayleigh layer"}),
    ("cloud", {"file": "slab.vdb", "quantity": "extinction", "single_scattering_albedo": 0.99, "phase_function": "droplets"}),
    ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
    ("[layer]", {"name": "molecules", "bottom_m": 0.0, "top_m": 600.0, "optical_depth": 0.1, "single_scattering_albedo": 1.0,
                 "phase_function": "rayleigh"}),
    ("sun", {"zenith_deg": 40.0, "azimuth_deg": 30.0, "irradiance_w_m2": 1000.0}),
    ("surface", {"type": "lambertian", "albedo": 0.2}),
    ("solver", {"accuracy": "draft", "mode": "3d"}),
    ("[camera]", {"name": "eye", "position_m": [150.0, 0.0, 900.0], "look_at_m": [150.0, 200.0, 100.0], "width": 4, "height": 3}),
    ("output", {"fields": ["fluxes", "absorption", "actinic", "optical_depth", "extinction"]}),
]


def check_dataset(path, engine, complain):
    with xarray.open_dataset(path, engine=engine) as data:
        data.load()
    for axis in ("x", "y", "z", "z_edge"):
        complain(axis in data.coords, f"{engine}: {axis} is no coordinate")
        complain(bool((np.diff(data[axis]) > 0).all()), f"{engine}: {axis} does not ascend")
    complain(data.sizes["z_edge"] == data.sizes["z"] + 1, f"{engine}: z_edge is not one longer than z")
    complain(data.z.attrs.get("bounds") == "z_bounds" and bool((data.z_bounds.mean("bound") == data.z).all()), f"{engine}: z_bounds are not the faces of the cells")
    for name, degrees in (("solar_zenith_angle", 40.0), ("solar_azimuth_angle", 60.0)):  # the azimuth clockwise from north
        complain(name in data.upwelling_flux.coords and float(data[name]) == degrees and data[name].attrs.get("standard_name") == name, f"{engine}: {name} is not {degrees}")
    for name, variable in data.drop_vars("z_bounds").variables.items():
        complain("units" in variable.attrs and "long_name" in variable.attrs, f"{engine}: {name} lacks units or long_name")
        complain(name not in UNITS or variable.attrs.get("units") == UNITS[name], f"{engine}: {name} has units {variable.attrs.get('units')}")
        complain(name not in DIMENSIONS or variable.dims == DIMENSIONS[name], f"{engine}: {name} has dimensions {variable.dims}")
    for name in PROFILES:
        complain(name in data, f"{engine}: {name} is missing")
    for name in ROOT_ATTRIBUTES:
        complain(name in data.attrs, f"{engine}: root attribute {name} is missing")
    complain(str(data.attrs.get("Conventions")) == "CF-1.10", f"{engine}: Conventions is {data.attrs.get('Conventions')}")
    with xarray.open_dataset(path, engine=engine, group="profile") as profile:
        for name in PROFILES:
            mean = data[name].mean(("x", "y"))
            if data[name].sizes["z_edge"] == profile.sizes["z_edge"]:
                # A mean of float32 numbers against the mean that was taken in double.
                complain(bool(np.allclose(profile[name], mean, rtol=2e-6, atol=1e-6 * float(data["direct_flux"].max()))),
                         f"{engine}: /profile/{name} is not the mean of /{name}")


def check_optical_depth(path, complain):
    """The slab alone, without the layer beside it."""
    with xarray.open_dataset(path) as data:
        complain(bool(np.allclose(data.optical_depth, DEPTH, rtol=1e-6)), f"optical_depth is not that of the slab, {DEPTH}")
        height = data.z_bounds.diff("bound").squeeze("bound")
        complain(bool(np.allclose((data.extinction * height).sum("z"), DEPTH, rtol=1e-6)), f"extinction does not sum to the depth of the slab, {DEPTH}")


def check_upright(path, complain):
    """Plots by coordinates have a camera's first row on top, as it stands in the file."""
    with xarray.open_dataset(path) as data:
        if "camera_eye" not in data:
            return
        mesh = data.camera_eye.plot()
        complain(np.array_equal(mesh.get_array().reshape(data.camera_eye.shape), data.camera_eye), "the plot of a camera has other values")
        height = mesh.axes.transData.transform(mesh.get_coordinates()[:, 0])[:, 1]  # of the edges of rows, on the picture
        complain(bool((np.diff(height) < 0).all()), f"a camera's image is upside down in a plot (rows at {height})")
        plt.close(mesh.figure)


def check_groups(path, complain):
    result = support.Result(path, 0, 0, 0)
    for name in SUMMARY:
        complain(name in result.summary, f"/summary lacks {name}")
    for name in SOLVER:
        complain(name in result.solver, f"/solver lacks {name}")


def check_tools(path, complain):
    for command in (["ncdump", "-h"], ["h5dump", "-H"]):
        done = subprocess.run([*command, str(path)], capture_output=True, text=True)
        complain(done.returncode == 0, f"{' '.join(command)} fails: {done.stderr}")
        for name in PROFILES:
            complain(name in done.stdout, f"{' '.join(command)} does not show {name}")


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("result", nargs="?", type=Path, help="default: the result of a small scene that is run for it")
    options = parser.parse_args()
    faults = []

    def complain(good, message):
        if not good:
            faults.append(message)

    with support.Workspace(options.keep) as folder:
        path = options.result
        if path is None:
            cloudbow = support.Cloudbow(options.cloudbow, options.threads)
            cloudbow.call("cloud", "make", "slab", "--cells", 6, 5, 8, "--voxel-size-m", 50, 50, 25, "--optical-depth", DEPTH, "-o", folder / "slab.vdb")
            scene, path = folder / "slab.toml", folder / "slab.h5"
            scene.write_text(support.scene_text(SCENE))
            cloudbow.run(scene, path, error_estimate=True)
            check_optical_depth(path, complain)
        for engine in ("netcdf4", "h5netcdf"):
            check_dataset(path, engine, complain)
        check_upright(path, complain)
        check_groups(path, complain)
        check_tools(path, complain)
    print("\n".join(faults) or "the result reads well in every tool")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
