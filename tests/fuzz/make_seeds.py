#!/usr/bin/env python3
"""Small valid files for the fuzz targets to start from, FOLDER/TARGET/FILE: made by the program, or written here by hand.

usage: make_seeds.py --cloudbow PROGRAM FOLDER
"""
import argparse
import re
import struct
import subprocess
import zlib
from pathlib import Path

import h5py
import netCDF4
import numpy as np

ROOT = Path(__file__).resolve().parents[2]

RICH_SCENE = """\
title = "every table"
[spectrum]
wavelengths_um = [0.55, 0.67]
[cloud]
file = "cloud.vdb"
grid = "density"
quantity = "extinction"
scale = [1.0, 2.0]
voxel_size_m = [50.0, 50.0, 25.0]
up_axis = "z"
single_scattering_albedo = 0.99
phase_function = "two"
[phase_function.two]
type = "double-henyey-greenstein"
forward_asymmetry_parameter = 0.9
backward_asymmetry_parameter = -0.4
forward_weight = 0.9
[phase_function.moments]
type = "legendre"
file = "moments.txt"
[phase_function.few]
type = "legendre"
moments = [1.0, 0.5, 0.1]
[phase_function.angles]
type = "table"
file = "table.txt"
[phase_function.many]
type = "set"
file = "set.csv"
[[layer]]
name = "air"
bottom_m = 0.0
top_m = 2000.0
optical_depth = 0.1
optical_depth_wavelength_um = 0.55
single_scattering_albedo = 1.0
phase_function = "rayleigh"
[domain]
boundary = "open"
min_m = [0.0, 0.0, 0.0]
max_m = [1e3, 1e3, 2e3]
[sun]
zenith_deg = 30
bearing_deg = 180
[sky]
radiance_w_m2_sr = 0.1
[surface]
type = "rpv"
rho0 = 0.1
k = 0.8
theta = -0.1
[solver]
mode = "3d"
accuracy = "fine"
control_points = 162
[[radiance]]
name = "nadir"
zenith_deg = 0
width = 8
height = 8
[[camera]]
name = "eye"
type = "perspective"
position_m = [0, 0, 10]
look_at_m = [500, 500, 1000]
width = 16
height = 9
[output]
flux_levels = [0.0, 1000.0]
fields = ["fluxes", "absorption", "actinic", "radiance_field"]
"""

PHASE_FILES = {
    "moments.txt": "# l chi\n0 1\n1 0.5\n2 0.25\n",
    "column.txt": "1.0\n0.5\n0.25\n",
    "table.txt": "# angle value\n0 1.6\n90 1\n180 0.4\n",
    "radians.txt": "! radians\n0,1.6\n1.5707963,1.0D0\n3.1415927,4D-1\n",
    "set.csv": "l,one,two\n0,1,1\n1,0.5,0.3\n2,0.25,0.1\n",
    "factor.csv": "0 1 1\n1 1.5 1.2\n2 1.25 0.5\n",
}

CLOUD_TEXTS = {
    "columns.txt": "# i j k value\n0 0 0 0.01\n1 0 1 0.02\n0 1 2 0.03\n",
    "optics.csv": "# nx,ny,nz=2,2,3 dx=0.05 km dy=0.05 km\n# z levels km: 0.1 0.2 0.4\nix,iy,iz,extinction_per_km,ssa,iphase\n0,0,0,10,0.99,1\n1,1,2,20,1,2\n",
    "optics_edges.csv": "# dx=50 m\ni,j,k,z_bottom_m,z_top_m,extinction_per_m,ssa,phase_index\n0,0,0,0,100,0.01,0.99,1\n0,1,1,100,150,0.02,1,1\n",
    "extinction.prp": "Extinction-only property file\n2 2 2\n0.05 0.05 0.1 0.2\n280 270\n0.99 2 2.5 3.1\n1 1 1 10\n2 2 2 20\n",
    "tabulated.prp": "Tabulated phase function property file\n2 2 2\n0.05 0.05 0.1 0.2\n2\n2 2.5 3.1\n3 2.4 2.0 1.0\n1 1 1 280 10 0.99 1\n2 2 2 270 20 0.98 2\n",
    "one.lwc": "1  LWC file\n2 2 2\n0.05 0.05 0.1 0.2\n280 270\n1 1 1 0.1\n2 2 2 0.2\n",
    "two.lwc": "2  parameter LWC file\n2 2 2\n0.05 0.05 0.1 0.2\n280 270\n1 1 1 0.1 10\n2 2 2 0.2 12\n",
    "fortran.lwc": "1 PARAMETER LWC FILE\n2 1 3\n2*1.0D-1\n5.0d-1 .6 7.D-1\n3*290\n2*1 2 3.0D-01\n",
    "at3d.csv": "# cloud\n2,2,3 # nx,ny,nz\n0.02,0.02 # dx,dy\n0.44,0.48,0.52 # levels\nx,y,z,lwc,reff\n0,0,1,0.5,10\n1,1,2,0.3,8\n",
    "mystic.dat": "2 2 2 3\n0.1 0.1 0.5 0.6 0.7\n1 1 1 0.5 10\n2 1 2 0.3 8\n",
    "particles.txt": "3  particle file\n2 2 2\n0.05 0.05 0.1 0.2\n280 270\n1 1 1 1 1 0.1 10\n2 2 2 1 1 0.2 12\n",
}

SHDOM_MIE = """\
! Mie table vs. effective radius (LWC=1 g/m^3)
  0.670  0.670  wavelength range (micron)
  1.000  W  particle density and type
   7.00000  gamma size distribution shape parameter
   2   5.000  10.000  number, starting, ending effective radius
   2  maximum rank allowed
   5.0000  300.0  0.999  2  Reff  Ext  Alb  Nleg
   1.0  0.9  0.04
  10.0000  150.0  0.998  2  Reff  Ext  Alb  Nleg
   1.0  0.8  0.03
"""

TINY_RUN = """\
[cloud]
file = "CLOUD"
quantity = "extinction"
single_scattering_albedo = 0.99
phase_function = "rayleigh"
[sun]
zenith_deg = 30.0
azimuth_deg = 0.0
[solver]
accuracy = "draft"
[output]
fields = ["fluxes", "absorption", "actinic", "radiance_field"]
"""


def write_les(path, form):
    with netCDF4.Dataset(path, "w", format=form) as file:
        for name, length in (("time", 1), ("z", 3), ("y", 2), ("x", 2)):
            file.createDimension(name, length)
        for name, values, units in (("x", [25, 75], "m"), ("y", [25, 75], "m"), ("z", [100, 200, 400], "m")):
            file.createVariable(name, "f4", (name,))[:] = values
            file[name].units = units
        water = file.createVariable("qc", "f4", ("time", "z", "y", "x"))
        water.units = "g/kg"
        water[:] = np.linspace(0, 0.5, 12).reshape(1, 3, 2, 2)
        file.createVariable("rho", "f4", ("z",))[:] = [1.2, 1.1, 1.0]
        file["rho"].units = "kg/m3"
        file.createVariable("reff", "f4", ("time", "z", "y", "x"))[:] = 10
        file["reff"].units = "um"


def write_wrf(path, form):
    """The layout of WRF, with packed water and all attributes that exclude values."""
    with netCDF4.Dataset(path, "w", format=form) as file:
        for name, length in (("Time", 1), ("bottom_top", 3), ("bottom_top_stag", 4), ("south_north", 2), ("west_east", 2)):
            file.createDimension(name, length)
        water = file.createVariable("QCLOUD", "i2", ("Time", "bottom_top", "south_north", "west_east"), fill_value=-32767)
        water.set_auto_maskandscale(False)
        water.units, water.scale_factor, water.add_offset = "1e-3 KG/KG", 1e-4, 0.0
        water.missing_value, water.valid_range, water.valid_max = np.int16([-32766, -1]), np.int16([0, 32000]), np.float64(3.0)
        water[:] = np.arange(12).reshape(1, 3, 2, 2) * 1000
        for name, values in (("P", [200, 200, 200]), ("PB", [95000, 94000, 93000]), ("T", [1, 2, 3])):
            file.createVariable(name, "f4", ("Time", "bottom_top", "south_north", "west_east"))[:] = np.reshape(values, (1, 3, 1, 1))
        file["T"].description = "perturbation potential temperature theta-t0"
        for name, values in (("PH", [0, 1, 2, 3]), ("PHB", [3924, 4800, 5700, 6600])):
            file.createVariable(name, "f4", ("Time", "bottom_top_stag", "south_north", "west_east"))[:] = np.reshape(values, (1, 4, 1, 1))
        file.DX, file.DY = np.float32(100), np.float32(100)


def write_terrain(path, form):
    """Levels from the top with heights of their own in every column, degrees, three species, theta_l and the Exner function."""
    with netCDF4.Dataset(path, "w", format=form) as file:
        for name, length in (("height", 3), ("height_2", 4), ("lat", 2), ("lon", 2)):
            file.createDimension(name, length)
        whole = ("height", "lat", "lon")
        for name, values, units in (("lon", [8, 8.01], "degrees_east"), ("lat", [50.01, 50], "degrees_north")):
            file.createVariable(name, "f8", (name,))[:] = values
            file[name].units = units
        file.createVariable("z_ifc", "f4", ("height_2", "lat", "lon"))[:] = np.reshape([900, 600, 300, 0], (4, 1, 1)) + np.arange(4).reshape(1, 2, 2) * 10
        file["z_ifc"].units = "m"
        for name, units, values in (("qc", "kg/kg", 1e-3), ("qi", "g/kg", 1e-2), ("qr", "kg m-3", 1e-4), ("reff_ice", "um", 30), ("thl", "K", 295), ("PI", "", 0.95)):
            file.createVariable(name, "f4", whole)[:] = values
            file[name].units = units


def write_checkpoint(path, libver, checkpoint_format):
    """The arrays of fuzz_checkpoint.cpp. Those of the oldest format have no checksums, which stop nearly every mutant."""
    with h5py.File(path, "w", libver=libver) as file:
        file.attrs["source"] = np.bytes_("cloudbow")
        file.attrs["checkpoint_format"] = checkpoint_format
        file.attrs["layout"] = np.int64(1)
        file.attrs["problem"] = np.int64(2)
        checked = libver != "earliest"
        for name, kind, rows, length in (("numbers", "f8", 1, 8), ("radiance", "f4", 6, 20), ("halves", "u2", 2, 20)):
            values = np.arange(rows * length, dtype=kind).reshape(rows, length)
            file.create_dataset(name, data=values, chunks=(1, length), fletcher32=checked)


def write_libradtran(path, form, axis="reff"):
    with netCDF4.Dataset(path, "w", format=form) as file:
        for name, length in (("nlam", 1), ("nreff", 2), ("nphamat", 1), ("nmommax", 3)):
            file.createDimension(name, length)
        file.createVariable("wavelen", "f8", ("nlam",))[:] = [0.67]
        file.createVariable(axis, "f8", ("nreff",))[:] = [5, 10] if axis == "reff" else [50, 80]
        for name, values in (("ext", [[300, 150]]), ("ssa", [[0.999, 0.998]]), ("gg", [[0.3, 0.267]])):
            file.createVariable(name, "f8", ("nlam", "nreff"))[:] = values
        file["ext"].units = "km^-1/(g/m^3)"
        file.createVariable("nmom", "i4", ("nlam", "nreff", "nphamat"))[:] = 3
        file.createVariable("pmom", "f4", ("nlam", "nreff", "nphamat", "nmommax"))[:] = [[[[1, 0.9, 0.04]], [[1, 0.8, 0.03]]]]


def png_chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def png(width, height, depth, colour, lines, more=b"", interlaced=0):
    """A PNG of given lines (bytes), each with filter 0."""
    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlaced)
    packed = zlib.compress(b"".join(b"\0" + line for line in lines))
    return b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", head) + more + png_chunk(b"IDAT", packed) + png_chunk(b"IEND", b"")


def write_albedo_maps(folder):
    grey, colour, palette, grey_and_alpha = 0, 2, 3, 4
    pictures = {"grey8": png(3, 2, 8, grey, [b"\x10\x20\x30", b"\x40\x50\x60"]),
                "grey16_gamma": png(2, 2, 16, grey, [b"\x10\0\x20\0", b"\x40\0\x50\0"], png_chunk(b"gAMA", struct.pack(">I", 45455))),
                "grey1": png(8, 2, 1, grey, [b"\xaa", b"\x55"]),
                "colour": png(2, 1, 8, colour, [b"\x10\x10\x10\x20\x20\x20"]),
                "palette": png(4, 1, 2, palette, [b"\x1b"], png_chunk(b"PLTE", bytes([0, 0, 0, 85, 85, 85, 170, 170, 170, 255, 255, 255]))),
                "alpha": png(2, 1, 8, grey_and_alpha, [b"\x10\xff\x20\xff"]),
                "interlaced": png(2, 2, 8, grey, [b"\x10", b"\x20", b"\x30\x40"], interlaced=1)}
    for name, content in pictures.items():
        (folder / f"{name}.png").write_bytes(content)
    for form in ("NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF4"):
        with netCDF4.Dataset(folder / f"{form}.nc", "w", format=form) as file:
            for name, length in (("time", 1), ("lat", 3), ("lon", 2)):
                file.createDimension(name, length)
            file.createVariable("lat", "f4", ("lat",))[:] = [51, 50.5, 50]
            file.createVariable("lon", "f4", ("lon",))[:] = [8, 8.5]
            albedo = file.createVariable("albedo", "i2", ("time", "lat", "lon"), fill_value=-1)
            albedo.setncatts({"scale_factor": 0.01, "add_offset": 0.1, "units": "%", "valid_range": np.array([0, 10000], "i2")})
            albedo.set_auto_maskandscale(False)
            albedo[:] = 1000


def write_gas_model(path, form, light):
    """A model of two g-points with a gas of each kind, as ecCKD's definition files have them."""
    sizes = {"temperature": 2, "pressure": 3, "g_point": 2, "wavenumber": 2, "h2o_mole_fraction": 2, "temperature_planck": 2}
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.constituent_id = "composite h2o o3 ch4"
        for name, length in sizes.items():
            file.createDimension(name, length)

        def write(name, dimensions, values):
            file.createVariable(name, "f4", dimensions)[...] = values

        table = ("temperature", "pressure", "g_point")
        write("pressure", ("pressure",), [1e3, 1e4, 1e5])
        write("temperature", ("temperature", "pressure"), [[200, 210, 220], [220, 230, 240]])
        for code, gas in enumerate(("composite", "o3", "h2o", "ch4")):
            write(f"{gas}_conc_dependence_code", (), code)
            write(f"{gas}_molar_absorption_coeff", ("h2o_mole_fraction", *table) if gas == "h2o" else table, 1e-3)
        write("h2o_mole_fraction", ("h2o_mole_fraction",), [1e-4, 1e-2])
        write("ch4_reference_mole_fraction", (), 1.9e-6)
        write("wavenumber1", ("wavenumber",), [600, 700])
        write("wavenumber2", ("wavenumber",), [700, 900])
        write("gpoint_fraction", ("g_point", "wavenumber"), [[0.25, 0.75], [0.5, 0.5]])
        if light == "solar":
            write("solar_irradiance", ("g_point",), [30, 10])
            write("solar_spectral_irradiance", ("wavenumber",), [15, 25])
            write("rayleigh_molar_scattering_coeff", ("g_point",), 1e-6)
        else:
            write("temperature_planck", ("temperature_planck",), [200, 300])
            write("planck_function", ("temperature_planck", "g_point"), [[1, 2], [3, 5]])


def write_bulk_table(path, form, slowest):
    """Two wavenumbers and two radii, as ecRad's scattering files have them."""
    with netCDF4.Dataset(path, "w", format=form) as file:
        for name, values, units in (("wavenumber", [1000, 2000], "cm-1"), ("effective_radius", [5e-6, 1e-5], "m")):
            file.createDimension(name, 2)
            file.createVariable(name, "f4", (name,))[:] = values
            file[name].units = units
        both = ("effective_radius", "wavenumber")
        for name, values, units in (("mass_extinction_coefficient", [[300, 200], [150, 100]], "m2 kg-1"),
                                    ("single_scattering_albedo", [[1, 0.9], [0.7, 0.6]], "1"), ("asymmetry_factor", [[0.8, 0.85], [0.86, 0.9]], "1")):
            file.createVariable(name, "f4", both if slowest == "radius" else both[::-1])[:] = values
            file[name].units = units


AIR_TEXTS = {
    "afgl.txt": "# z(km) p(mb) T(K) air(cm-3) o3(cm-3) o2(cm-3) h2o(cm-3) co2(cm-3) no2(cm-3)\n20 55.3 216.7 1.85E+18 4.8E+12 3.9E+17 8.5E+12 6.1E+14 1.1E+09\n"
                "5.0 540.5 255.7 1.53E+19 5.7E+11 3.2E+18 2.1E+16 5.1E+15 3.5E+08\n0 1013 288.2 2.55E+19 6.8E+11 5.3E+18 2.0E+17 8.4E+15 5.9E+08\n",
    "bare.txt": "10 264 223\n5 540 255\n0 1013 288\n",
    "units.txt": "# p(hPa) T(K) height(m) h2o(ppm)\n1013 288 0 7000\n900 281 1000 5000\n",
}


def write_air(path, form):
    """Heights, pressure, temperature and gases by CF names, in other units than the program's."""
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.createDimension("height", 3)
        profiles = (("height", [0, 1, 12], "km", "height"), ("p", [1013, 900, 200], "hPa", "air_pressure"), ("T", [288, 281, 217], "K", "air_temperature"),
                    ("h2o", [7e-3, 5e-3, 1e-5], "1", "mole_fraction_of_water_vapor_in_air"), ("o3", [0.03, 0.04, 0.5], "ppm", "mole_fraction_of_ozone_in_air"))
        for name, values, units, standard_name in profiles:
            file.createVariable(name, "f4", ("height",))[:] = values
            file[name].units, file[name].standard_name = units, standard_name


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True, type=Path)
    parser.add_argument("folder", type=Path)
    options = parser.parse_args()

    def folder(target):
        path = options.folder / target
        path.mkdir(parents=True, exist_ok=True)
        return path

    def cloudbow(*words):
        subprocess.run([options.cloudbow.resolve(), *map(str, words)], check=True, stdout=subprocess.DEVNULL)

    def write_texts(target, texts):
        for name, text in texts.items():
            (folder(target) / name).write_text(text)

    # The cloud that fuzz_scene has made, so that a mutant is not refused for its file.
    scenes = {path.name: re.sub(r'"[^"]*\.vdb"', '"cloud.vdb"', path.read_text()) for path in sorted((ROOT / "configs").glob("*.toml"))}
    write_texts("scene", scenes | {"rich.toml": RICH_SCENE})
    write_texts("phase_files", PHASE_FILES)
    write_texts("cloud_text", CLOUD_TEXTS)
    write_texts("atmosphere", AIR_TEXTS)
    np.save(folder("cloud_text") / "array.npy", np.arange(12.0).reshape(3, 2, 2) / 100)
    for name, save in (("stored.npz", np.savez), ("deflated.npz", np.savez_compressed)):
        save(folder("cloud_text") / name, lwc=np.arange(12.0).reshape(3, 2, 2) / 100, reff=np.full((3, 2, 2), 9.0), x=[0.0, 50], y=[0.0, 50], z=[0.0, 40, 90])
    write_texts("droplet_table", {"shdom.mie": SHDOM_MIE})
    for form in ("NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF4"):
        write_les(folder("cloud_netcdf") / f"{form}.nc", form)
        write_terrain(folder("cloud_netcdf") / f"terrain_{form}.nc", form)
        write_wrf(folder("cloud_netcdf") / f"wrf_{form}.nc", form)
        for light in ("solar", "longwave"):
            write_gas_model(folder("gas_model") / f"{light}_{form}.nc", form, light)
        for axis in ("reff", "hum"):
            write_libradtran(folder("droplet_table") / f"{axis}_{form}.nc", form, axis)
        write_air(folder("atmosphere") / f"{form}.nc", form)
        for slowest in ("radius", "wavenumber"):
            write_bulk_table(folder("bulk_table") / f"{slowest}_{form}.nc", form, slowest)
    write_albedo_maps(folder("albedo_map"))
    clouds = folder("cloud_vdb")
    size = ["--cells", 4, 4, 4, "--voxel-size-m", 50, 50, 50]
    cloudbow("cloud", "make", "slab", *size, "-o", clouds / "float.vdb")
    cloudbow("cloud", "make", "sphere", *size, "--half", "-o", clouds / "half.vdb")
    cloudbow("mie", "--wavelength-um", 0.67, "--effective-radius-um", "1:2:1", "-o", folder("droplet_table") / "own.h5")
    results = folder("result")
    scene = options.folder / "tiny.toml"
    scene.write_text(TINY_RUN.replace("CLOUD", str((clouds / "float.vdb").resolve())))
    checkpoints = folder("checkpoint")
    cloudbow("run", scene, "--quiet", "-o", results / "result.h5", "--checkpoint", checkpoints / "own.h5")
    with h5py.File(checkpoints / "own.h5") as file:
        checkpoint_format = file.attrs["checkpoint_format"]  # any other is refused before its values are read
    for name, libver in (("earliest", "earliest"), ("v108", ("v108", "v108")), ("latest", "latest")):
        write_checkpoint(checkpoints / f"{name}.h5", libver, checkpoint_format)
    scene.unlink()


if __name__ == "__main__":
    main()
