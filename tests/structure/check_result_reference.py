#!/usr/bin/env python3
"""docs/result-reference.md names every variable and every attribute of a group that results hold, and no others.

Truth: results of a scene with all that it can ask for, at one and at two wavelengths, of scenes that emit, and of one with a gas model.

usage: check_result_reference.py CLOUDBOW DOCS/RESULT-REFERENCE.MD
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import netCDF4
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "robustness"))
from made_gas_files import write_bulk_table, write_gas_model

CELLS = "# nx,ny,nz=2,2,3 dx=0.05 km dy=0.05 km\n# z levels km: 0.1 0.2 0.3\nix,iy,iz,extinction_per_km,ssa,iphase\n0,0,0,10,0.99,1\n1,1,2,20,1,2\n"
FUNCTIONS = "0 1 1\n1 0.5 0.4\n2 0.3 0.2\n"
SCENE = """\
[cloud]
file = "cloud.vdb"
single_scattering_albedo_grid = "single_scattering_albedo"
phase_function = "droplets"
[phase_function.droplets]
type = "set"
file = "cloud.phase.csv"
[sun]
zenith_deg = 30.0
azimuth_deg = 0.0
[solver]
accuracy = "draft"
[[radiance]]
name = "NAME"
zenith_deg = 0.0
[[radiance]]
name = "PIXELS"
zenith_deg = 0.0
width = 2
height = 2
[[camera]]
name = "EYE"
type = "fisheye"
position_m = [10.0, 10.0, 60.0]
width = 2
height = 2
[output]
flux_levels = "boundaries"
fields = ["fluxes", "absorption", "actinic", "radiance_field", "errors", "optical_depth", "extinction"]
circumsolar_deg = 2.5
"""
THERMAL = """\
[cloud]
file = "les.vdb"
effective_radius_um = 10.0
single_scattering_albedo = 0.5
temperature_grid = "temperature"
phase_function = "isotropic"
[atmosphere]
standard = "us-1976"
[sky]
temperature_k = 200.0
[solver]
accuracy = "draft"
[[radiance]]
name = "NAME"
zenith_deg = 0.0
quantity = "brightness_temperature"
[output]
fields = ["fluxes", "absorption", "heating_rate"]
[surface]
"""
GROUND, GROUND_MAP = "temperature_k = 288.0\n", 'temperature_map = "ground.nc"\n'
WAVELENGTH, BAND = "[thermal]\nwavelength_um = 10.8\n", "[thermal]\nband_um = [8.0, 12.0]\n"
BROADBAND = """\
[cloud]
file = "cloud.vdb"
effective_radius_um = 10.0
phase_function = "water"
[phase_function.water]
type = "bulk"
file = "bulk.nc"
[atmosphere]
standard = "us-1976"
h2o = 1e-3
o3 = 1e-7
[spectrum]
gas_model = "model.nc"
[sun]
zenith_deg = 30.0
azimuth_deg = 0.0
irradiance_w_m2 = 1361.0
[solver]
accuracy = "draft"
[output]
fields = ["fluxes", "heating_rate", "optical_depth"]
"""
BANDS = BROADBAND.replace('"model.nc"', '"model.nc"\nmethod = "columns"').replace('"heating_rate"', '"absorption", "bands"')
CONSTITUENTS = """\
[[cloud]]
name = "NAME"
file = "les.vdb"
effective_radius_um = 10.0
single_scattering_albedo = 0.99
phase_function = "isotropic"
[sun]
zenith_deg = 30.0
azimuth_deg = 0.0
[solver]
accuracy = "draft"
"""
SPECTRUM = "[spectrum]\nwavelengths_um = [0.55, 0.67]\n"


def documented(text):
    """Of the tables below the first two headings."""
    variables, attributes = set(), set()
    section = None
    for line in text.splitlines():
        if line.startswith("## "):
            section = line[3:]
        cells = [re.findall(r"`([^`]+)`", cell) for cell in line.split("|")[1:-1]]
        if not cells or not cells[0] or not cells[0][0].startswith("/"):
            continue
        if section == "Variables":
            variables.update(cells[0])
        elif section == "Attributes":
            attributes.update((cells[0][0], name) for name in cells[1])
    return variables, attributes


def written(path):
    """The same of a file; the bookkeeping of netCDF and HDF5 (names in capitals, "_Netcdf4Dimid") left out."""
    variables, attributes = set(), set()
    general = lambda name: re.sub(r"_(PIXELS|EYE)$", "_NAME", name)
    with h5py.File(path) as file:
        nodes = [("/", file)]
        file.visititems(lambda name, node: nodes.append(("/" + name, node)))
        for name, node in nodes:
            if isinstance(node, h5py.Dataset):
                variables.add(general(name))
            else:
                attributes.update((name, attribute) for attribute in node.attrs if not attribute.startswith("_"))
    return variables, attributes


def write_thermal_files(folder):
    """A cloud of two voxels with their temperature, and a map of the ground's."""
    with netCDF4.Dataset(folder / "les.nc", "w") as file:
        for name in "zyx":
            file.createDimension(name, 2)
            file.createVariable(name, "f8", name)[:] = [25.0, 75.0]
            file[name].units = "m"
        for name, units, dimensions, value in (("QC", "g/kg", "zyx", [[[0, 0.2], [0, 0]], [[0, 0.3], [0, 0]]]), ("TABS", "K", "zyx", 8 * [280.0]), ("RHO", "kg/m3", "z", [1.1, 1.0])):
            variable = file.createVariable(name, "f4", tuple(dimensions))
            variable[:] = np.reshape(value, variable.shape)
            variable.units = units
    with netCDF4.Dataset(folder / "ground.nc", "w") as file:
        for name in "yx":
            file.createDimension(name, 2)
        file.createVariable("surface_temperature", "f4", ("y", "x"))[:] = [[288.0, 289.0], [290.0, 291.0]]
        file["surface_temperature"].units = "K"


def main():
    program, page = Path(sys.argv[1]).resolve(), documented(Path(sys.argv[2]).read_text())
    found = (set(), set())
    with tempfile.TemporaryDirectory() as folder:
        def cloudbow(*words):
            subprocess.run([program, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL)

        (Path(folder) / "cells.csv").write_text(CELLS)
        (Path(folder) / "functions.csv").write_text(FUNCTIONS)
        cloudbow("cloud", "import", "cells.csv", "--phase-functions", "functions.csv", "-o", "cloud.vdb", "--quiet")
        write_thermal_files(Path(folder))
        write_gas_model(Path(folder) / "model.nc", "solar")
        write_bulk_table(Path(folder) / "bulk.nc")
        cloudbow("cloud", "import", "les.nc", "--temperature-grid", "-o", "les.vdb", "--quiet")
        for name, text, options in (("one", SCENE, ["--compare"]), ("spectrum", SCENE + SPECTRUM, ["--compare"]), ("constituents", CONSTITUENTS, []),
                                    ("goal", SCENE, ["--target-error", "90%", "--of", "columns", "--budget", "1000s"]),
                                    ("thermal", THERMAL + GROUND + WAVELENGTH, ["--compare"]), ("thermal_band", THERMAL + GROUND_MAP + BAND, []), ("broadband", BROADBAND, ["--clear-sky"]), ("bands", BANDS, [])):
            (Path(folder) / f"{name}.toml").write_text(text)
            cloudbow("run", f"{name}.toml", "--quiet", *options, "-o", f"{name}.h5")
            for all_names, names in zip(found, written(Path(folder) / f"{name}.h5")):
                all_names |= names
    found[0].difference_update({name for name in found[0] if re.fullmatch(r"/\w+/wavelength", name)})  # the page says: in every group
    faults = []
    for kind, there, told in zip(("variables", "attributes"), found, page):
        if there != told:
            faults.append(f"{kind}: only the page has {sorted(told - there)}, only results {sorted(there - told)}")
    print("\n".join(faults) or f"{len(page[0])} variables, {len(page[1])} attributes")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
