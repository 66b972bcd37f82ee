#!/usr/bin/env python3
"""Imports made files in the layout of each model. The water path of every column is compared with a sum over the file.

The fields are random cumuli of water and ice in air that thins with height. They lie over a hill if the model's levels follow the terrain.
The truth is the file as netCDF4 or h5py reads it. Its rules are those of docs/models.md; it shares nothing with the program.
Numbers in VDB files have 24 bits: sums of them are right to 1e-6. The table goes to docs/models.md by --write; --check compares it.

usage: model_layouts.py --cloudbow PROGRAM --column-paths PROGRAM [--only NAME] [--write PAGE]
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import netCDF4
import numpy as np

import support
from support import Failure

NX, NY, NZ = 7, 5, 16
TOLERANCE = 1e-6
GAS_CONSTANT, GRAVITY, CAPACITY = 287.05, 9.80665, 1004.0
RANDOM = np.random.default_rng(20)
BEGIN, END = "<!-- begin model-layouts -->", "<!-- end model-layouts -->"
SPECIES = {"liquid": "density", "ice": "ice_water_content", "rain": "rain_water_content", "snow": "snow_water_content"}

CENTRES_X, CENTRES_Y = 50.0 + 100 * np.arange(NX), 50.0 + 100 * np.arange(NY)
EDGES = 300 + np.cumsum(np.concatenate([[0.0], 30 * 1.03 ** np.arange(NZ)]))  # levels that grow
CENTRES = 0.5 * (EDGES[1:] + EDGES[:-1])
HILL = 120 * np.exp(-((CENTRES_X[None] - 300) ** 2 + (CENTRES_Y[:, None] - 200) ** 2) / 2e4)


def over_hill(levels):
    """Heights [k][j][i] of levels that follow the terrain and become flat at the top."""
    return levels[:, None, None] + HILL * (levels[-1] - levels[:, None, None]) / (levels[-1] - levels[0])


def temperature(z):
    return 288.15 - 0.0065 * z


def pressure(z):
    return 101325 * (temperature(z) / 288.15) ** (GRAVITY / 0.0065 / GAS_CONSTANT)


def density(z):
    return pressure(z) / (GAS_CONSTANT * temperature(z))


def theta(z):
    return temperature(z) * (1e5 / pressure(z)) ** (2 / 7)


def cumuli(first, last, largest):
    """kg/kg [k][j][i], in some columns clear."""
    water = np.zeros((NZ, NY, NX))
    water[first:last] = largest * RANDOM.random((last - first, NY, NX))
    water[:, RANDOM.random((NY, NX)) < 0.4] = 0
    water[first, 0, 0] = largest
    return water


WATER, ICE, RAIN = cumuli(3, 10, 1e-3), cumuli(8, 15, 3e-4), cumuli(0, 6, 2e-4)


def between(centres):
    """Edges of levels along the first axis: halfway, the outermost as far out as in and not below 0."""
    inner = 0.5 * (centres[1:] + centres[:-1])
    edges = np.concatenate([[2 * centres[0] - inner[0]], inner, [2 * centres[-1] - inner[-1]]])
    edges[0] = np.maximum(edges[0], 0)
    return edges


def path(content, edges):
    """Water path [j][i] in g/m2 of a content in kg/m3 [k][j][i], from the bottom."""
    thickness = np.diff(edges, axis=0)
    return 1e3 * np.sum(content * (thickness if thickness.ndim == 3 else thickness[:, None, None]), axis=0)


class File:
    """A netCDF file that is written, variable by variable."""

    def __init__(self, name, dimensions, **attributes):
        self.file = netCDF4.Dataset(name, "w", format="NETCDF4")
        for dimension, length in dimensions.items():
            self.file.createDimension(dimension, length)
        self.file.setncatts(attributes)

    def add(self, name, dimensions, values, units="", kind="f4", fill=None, **attributes):
        variable = self.file.createVariable(name, kind, dimensions, fill_value=fill)
        if units:
            variable.units = units
        variable.setncatts(attributes)
        variable[...] = values
        return self

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()


def opened(name):
    """All variables of a file in 64 bits, scaled; missing numbers are NaN."""
    with netCDF4.Dataset(name) as file:
        return {key: np.ma.filled(np.ma.asarray(variable[...], dtype=float), np.nan) for key, variable in file.variables.items()}


def decimal(values):
    """The numbers that were meant by coordinates of 32 bits: 0.42 for 0.41999998688697815."""
    return np.array([float(str(np.float32(value))) for value in np.ravel(values)])


# -- layouts: each writes its files into a folder and returns arguments of the import; then reads them ----------------------------------------------


class Wrf:
    title, species = "WRF", ["liquid", "ice", "rain"]
    whole, staggered = ("Time", "bottom_top", "south_north", "west_east"), ("Time", "bottom_top_stag", "south_north", "west_east")

    def write(self, folder):
        z_edge = over_hill(EDGES)
        z = 0.5 * (z_edge[1:] + z_edge[:-1])
        sizes = {"Time": 1, "bottom_top": NZ, "bottom_top_stag": NZ + 1, "south_north": NY, "west_east": NX}
        with File(folder / "wrfout", sizes, TITLE=" OUTPUT FROM WRF V4.5 MODEL", DX=np.float32(100), DY=np.float32(100)) as file:
            for name, values in (("QCLOUD", WATER), ("QICE", ICE), ("QRAIN", RAIN)):
                file.add(name, self.whole, values, "kg kg-1")
            file.add("P", self.whole, pressure(z) - 0.97 * pressure(z), "Pa", description="perturbation pressure")
            file.add("PB", self.whole, 0.97 * pressure(z), "Pa")
            file.add("T", self.whole, theta(z) - 300, "K", description="perturbation potential temperature theta-t0")
            file.add("PH", self.staggered, 9.81 * 0.01 * z_edge, "m2 s-2")
            file.add("PHB", self.staggered, 9.81 * 0.99 * z_edge, "m2 s-2")
        return ["wrfout"]

    def read(self, folder):
        f = {name: values[0] for name, values in opened(folder / "wrfout").items()}
        p = f["P"] + f["PB"]
        rho = p / (GAS_CONSTANT * (f["T"] + 300) * (p / 1e5) ** (2 / 7))
        edges = (f["PH"] + f["PHB"]) / 9.81
        return {name: path(rho * f[key], edges) for name, key in zip(self.species, ("QCLOUD", "QICE", "QRAIN"))}


class Cm1:
    title, species = "CM1", ["liquid", "ice"]

    def write(self, folder):
        with File(folder / "cm1out.nc", {"time": 1, "nk": NZ, "nj": NY, "ni": NX}) as file:
            file.add("xh", ("ni",), CENTRES_X / 1e3, "km").add("yh", ("nj",), CENTRES_Y / 1e3, "km").add("z", ("nk",), CENTRES / 1e3, "km")
            whole = ("time", "nk", "nj", "ni")
            file.add("qc", whole, WATER, "kg/kg").add("qi", whole, ICE, "kg/kg")
            file.add("prs", whole, np.broadcast_to(pressure(CENTRES)[:, None, None], WATER.shape), "Pa")
            file.add("th", whole, np.broadcast_to(theta(CENTRES)[:, None, None], WATER.shape), "K")
        return ["cm1out.nc"]

    def read(self, folder):
        f = opened(folder / "cm1out.nc")
        rho = f["prs"][0] / (GAS_CONSTANT * f["th"][0] * (f["prs"][0] / 1e5) ** (2 / 7))
        edges = between(1e3 * decimal(f["z"]))
        return {"liquid": path(rho * f["qc"][0], edges), "ice": path(rho * f["qi"][0], edges)}


class Sam:
    title, species = "SAM", ["liquid", "ice"]

    def write(self, folder):
        with File(folder / "sam.nc", {"x": NX, "y": NY, "z": NZ, "time": 1}) as file:
            file.add("x", ("x",), CENTRES_X, "m").add("y", ("y",), CENTRES_Y, "m").add("z", ("z",), CENTRES, "m")
            file.add("p", ("z",), pressure(CENTRES) / 100, "mb")
            whole = ("time", "z", "y", "x")
            file.add("QN", whole, 1e3 * (WATER + ICE), "g/kg").add("QI", whole, 1e3 * ICE, "g/kg").add("QP", whole, 1e3 * RAIN, "g/kg")
            file.add("TABS", whole, np.broadcast_to(temperature(CENTRES)[:, None, None], WATER.shape), "K")
        return ["sam.nc"]

    def read(self, folder):
        f = opened(folder / "sam.nc")
        rho = 100 * f["p"][:, None, None] / (GAS_CONSTANT * f["TABS"][0])
        edges = between(decimal(f["z"]))
        # The difference of numbers of 32 bits, as in the program. In cells with ice alone it is rounding, which counts as 0.
        liquid = (np.float32(f["QN"][0]) - np.float32(f["QI"][0])).astype(float)
        liquid[liquid <= 0] = 0
        return {"liquid": path(1e-3 * rho * liquid, edges), "ice": path(1e-3 * rho * f["QI"][0], edges)}


class Dales:
    title, species = "DALES", ["liquid"]

    def write(self, folder):
        with File(folder / "fielddump.nc", {"time": 1, "zt": NZ, "yt": NY, "xt": NX}) as file:
            file.add("xt", ("xt",), CENTRES_X, "m").add("yt", ("yt",), CENTRES_Y, "m").add("zt", ("zt",), CENTRES, "m")
            whole = ("time", "zt", "yt", "xt")
            file.add("ql", whole, np.round(1e5 * WATER), "1e-5kg/kg", kind="i2")
            file.add("thl", whole, np.broadcast_to(theta(CENTRES)[:, None, None], WATER.shape), "K")
        lines = [f"{z:.6f} {rho:.8f}" for z, rho in zip(CENTRES, density(CENTRES))]
        (folder / "baseprof.txt").write_text("# z(m) rhobf(kg/m3)\n" + "\n".join(lines) + "\n")
        return ["fielddump.nc", "--profile", "baseprof.txt"]

    def read(self, folder):
        f = opened(folder / "fielddump.nc")
        z, rho = np.loadtxt(folder / "baseprof.txt", unpack=True)
        centres = decimal(f["zt"])
        rho = np.exp(np.interp(centres, z, np.log(rho)))[:, None, None]
        return {"liquid": path(1e-5 * rho * f["ql"][0], between(centres))}


class MicroHh:
    title, species = "MicroHH", ["liquid", "rain"]

    def write(self, folder):
        for name, values in (("ql", WATER), ("qr", RAIN)):
            with File(folder / f"{name}.nc", {"time": 1, "z": NZ, "y": NY, "x": NX}) as file:
                file.add("x", ("x",), CENTRES_X, "m").add("y", ("y",), CENTRES_Y, "m").add("z", ("z",), CENTRES, "m")
                file.add(name, ("time", "z", "y", "x"), values, "kg kg-1")
        with File(folder / "default.nc", {"time": 2, "z": NZ}) as file:
            file.add("z", ("z",), CENTRES, "m", kind="f8").add("thermo/rhoref", ("z",), density(CENTRES), "kg m-3", kind="f8")
        return ["ql.nc", "--with", "qr.nc", "--profile", "default.nc", "--model", "microhh"]

    def read(self, folder):
        with netCDF4.Dataset(folder / "default.nc") as file:
            air = {"z": file["z"][...], "rhoref": file["thermo/rhoref"][...]}
        found = {}
        for species, name in (("liquid", "ql"), ("rain", "qr")):
            f = opened(folder / f"{name}.nc")
            centres = decimal(f["z"])
            rho = np.exp(np.interp(centres, air["z"], np.log(air["rhoref"])))[:, None, None]
            found[species] = path(rho * f[name][0], between(centres))
        return found


class Palm:
    title, species = "PALM", ["liquid"]

    def write(self, folder):
        water = np.where(over_hill(CENTRES) - CENTRES[:, None, None] > 60, -9999, WATER)  # a hill of solid cells
        with File(folder / "palm.nc", {"time": 1, "zu_3d": NZ, "y": NY, "x": NX}, title="PALM 23.10") as file:
            file.add("x", ("x",), CENTRES_X, "m").add("y", ("y",), CENTRES_Y, "m").add("zu_3d", ("zu_3d",), CENTRES, "m")
            file.add("ql", ("time", "zu_3d", "y", "x"), water, "kg/kg", fill=np.float32(-9999))
            file.add("p", ("time", "zu_3d", "y", "x"), 0.1 * WATER, "Pa")
        heights = np.arange(0, 2001, 50.0)
        lines = [f"{z:.1f} {pressure(z):.6f} {temperature(z):.6f}" for z in heights]
        (folder / "air.txt").write_text("# z(m) p(Pa) T(K)\n" + "\n".join(lines) + "\n")
        return ["palm.nc", "--fill", "clear", "--profile", "air.txt"]

    def read(self, folder):
        f = opened(folder / "palm.nc")
        z, p, t = np.loadtxt(folder / "air.txt", unpack=True)
        centres = decimal(f["zu_3d"])
        rho = np.exp(np.interp(centres, z, np.log(p / (GAS_CONSTANT * t))))[:, None, None]
        return {"liquid": path(rho * np.nan_to_num(f["ql"][0]), between(centres))}


class Uclales:
    title, species = "UCLALES", ["liquid", "rain"]

    def write(self, folder):
        with File(folder / "uclales.nc", {"time": 1, "zt": NZ, "yt": NY, "xt": NX}) as file:
            file.add("xt", ("xt",), CENTRES_X, "m").add("yt", ("yt",), CENTRES_Y, "m").add("zt", ("zt",), CENTRES, "m")
            file.add("dn0", ("zt",), density(CENTRES), "kg/m^3")
            for name, values in (("l", WATER), ("r", RAIN)):
                file.add(name, ("time", "yt", "xt", "zt"), np.moveaxis(values, 0, 2), "kg/kg")
        return ["uclales.nc"]

    def read(self, folder):
        f = opened(folder / "uclales.nc")
        rho, edges = f["dn0"][:, None, None], between(decimal(f["zt"]))
        return {name: path(rho * np.moveaxis(f[key][0], 2, 0), edges) for name, key in (("liquid", "l"), ("rain", "r"))}


class MesoNh:
    title, species = "Meso-NH", ["liquid", "ice", "rain"]

    def write(self, folder):
        with File(folder / "mesonh.nc", {"time": 1, "level": NZ, "nj": NY, "ni": NX}) as file:
            file.add("ni", ("ni",), CENTRES_X, "m").add("nj", ("nj",), CENTRES_Y, "m").add("level", ("level",), CENTRES, "m")
            whole = ("time", "level", "nj", "ni")
            for name, values in (("RCT", WATER), ("RIT", ICE), ("RRT", RAIN)):
                file.add(name, whole, values, "kg kg-1")
            file.add("PABST", whole, np.broadcast_to(pressure(CENTRES)[:, None, None], WATER.shape), "Pa")
            file.add("THT", whole, np.broadcast_to(theta(CENTRES)[:, None, None], WATER.shape), "K")
        return ["mesonh.nc"]

    def read(self, folder):
        f = opened(folder / "mesonh.nc")
        rho = f["PABST"][0] / (GAS_CONSTANT * f["THT"][0] * (f["PABST"][0] / 1e5) ** (2 / 7))
        edges = between(decimal(f["level"]))
        return {name: path(rho * f[key][0], edges) for name, key in zip(self.species, ("RCT", "RIT", "RRT"))}


class Icon:
    title, species = "ICON", ["liquid", "ice"]

    def write(self, folder):
        z = over_hill(EDGES)
        z_mc = 0.5 * (z[1:] + z[:-1])
        with File(folder / "icon.nc", {"time": 1, "height": NZ, "lat": NY, "lon": NX}) as file:
            file.add("lon", ("lon",), 8 + 0.001 * np.arange(NX), "degrees_east", kind="f8")
            file.add("lat", ("lat",), 50 + 0.001 * np.arange(NY), "degrees_north", kind="f8")
            file.add("height", ("height",), 1 + np.arange(NZ))
            whole = ("time", "height", "lat", "lon")
            file.add("qc", whole, WATER[::-1], "kg kg-1").add("qi", whole, ICE[::-1], "kg kg-1")
            file.add("pres", whole, pressure(z_mc)[::-1], "Pa").add("temp", whole, temperature(z_mc)[::-1], "K")
        with File(folder / "heights.nc", {"height_3": NZ + 1, "lat": NY, "lon": NX}) as file:
            file.add("z_ifc", ("height_3", "lat", "lon"), z[::-1], "m")
        return ["icon.nc", "--with", "heights.nc"]

    def read(self, folder):
        f, edges = opened(folder / "icon.nc"), opened(folder / "heights.nc")["z_ifc"][::-1]
        rho = f["pres"][0] / (GAS_CONSTANT * f["temp"][0])
        return {name: path((rho * f[key][0])[::-1], edges) for name, key in (("liquid", "qc"), ("ice", "qi"))}


class IconCentres(Icon):
    title = "ICON, heights of centres"

    def write(self, folder):
        super().write(folder)
        z = over_hill(CENTRES)
        with File(folder / "heights.nc", {"height_2": NZ, "lat": NY, "lon": NX}) as file:
            file.add("z_mc", ("height_2", "lat", "lon"), z[::-1], "m")
        return ["icon.nc", "--with", "heights.nc"]

    def read(self, folder):
        f, edges = opened(folder / "icon.nc"), between(opened(folder / "heights.nc")["z_mc"][::-1])
        rho = f["pres"][0] / (GAS_CONSTANT * f["temp"][0])
        return {name: path((rho * f[key][0])[::-1], edges) for name, key in (("liquid", "qc"), ("ice", "qi"))}


class Cosmo:
    title, species = "COSMO", ["liquid", "ice", "rain"]

    def write(self, folder):
        z = over_hill(EDGES)
        middle = 0.5 * (z[1:] + z[:-1])
        with File(folder / "lfff.nc", {"time": 1, "level": NZ, "level1": NZ + 1, "rlat": NY, "rlon": NX}) as file:
            file.add("rlon", ("rlon",), -1 + 0.01 * np.arange(NX), "degrees", kind="f8")
            file.add("rlat", ("rlat",), 2 + 0.01 * np.arange(NY), "degrees", kind="f8")
            whole = ("time", "level", "rlat", "rlon")
            for name, values in (("QC", WATER), ("QI", ICE), ("QR", RAIN), ):
                file.add(name, whole, values[::-1], "kg kg-1")
            file.add("P", whole, pressure(middle)[::-1], "Pa").add("T", whole, temperature(middle)[::-1], "K")
            file.add("HHL", ("time", "level1", "rlat", "rlon"), z[::-1], "m")
        return ["lfff.nc"]

    def read(self, folder):
        f = {name: values[0] for name, values in opened(folder / "lfff.nc").items() if values.ndim == 4}
        rho = f["P"] / (GAS_CONSTANT * f["T"])
        return {name: path((rho * f[key])[::-1], f["HHL"][::-1]) for name, key in zip(self.species, ("QC", "QI", "QR"))}


class Monc:
    title, species = "MONC", ["liquid", "rain", "ice"]
    names = ("q_cloud_liquid_mass", "q_rain_mass", "q_ice_mass")

    def write(self, folder):
        with File(folder / "monc.nc", {"time_series_600_600": 2, "x": NX, "y": NY, "z": NZ, "zn": NZ}) as file:
            file.add("z", ("z",), EDGES[1:], "m").add("zn", ("zn",), CENTRES, "m").add("rhon", ("zn",), density(CENTRES), "kg/m3")
            for name, values in zip(self.names, (WATER, RAIN, ICE)):
                turned = np.transpose(values, (2, 1, 0))
                file.add(name, ("time_series_600_600", "x", "y", "zn"), np.stack([0 * turned, turned]), "kg/kg")
        return ["monc.nc", "--voxel-size-m", "100", "--time", "1"]

    def read(self, folder):
        f = opened(folder / "monc.nc")
        rho, edges = f["rhon"][:, None, None], between(decimal(f["zn"]))
        return {name: path(rho * np.transpose(f[key][1], (2, 1, 0)), edges) for name, key in zip(self.species, self.names)}


class Rams:
    title, species = "RAMS", ["liquid", "ice", "rain"]

    def write(self, folder):
        z = 40.0 * (np.arange(NZ) + 0.5)
        with h5py.File(folder / "rams.h5", "w") as file:
            for name, values in (("RCP", WATER), ("RPP", ICE), ("RRP", RAIN)):
                file[name] = values.astype("f4")
            file["THETA"] = np.broadcast_to(theta(z)[:, None, None], WATER.shape).astype("f4")
            file["PI"] = np.broadcast_to((CAPACITY * (pressure(z) / 1e5) ** (2 / 7))[:, None, None], WATER.shape).astype("f4")
        return ["rams.h5", "--voxel-size-m", "100", "100", "40"]

    def read(self, folder):
        with h5py.File(folder / "rams.h5") as file:
            f = {name: values[...].astype(float) for name, values in file.items()}
        rho = 1e5 * (f["PI"] / CAPACITY) ** 3.5 / (GAS_CONSTANT * f["THETA"] * f["PI"] / CAPACITY)
        return {name: path(rho * f[key], 40.0 * np.arange(NZ + 1)) for name, key in zip(self.species, ("RCP", "RPP", "RRP"))}


class Oceananigans:
    title, species = "Oceananigans, Breeze", ["liquid"]

    def write(self, folder):
        with File(folder / "breeze.nc", {"time": 1, "z_aac": NZ, "y_aca": NY, "x_caa": NX}) as file:
            file.add("x_caa", ("x_caa",), CENTRES_X, "m", kind="f8").add("y_aca", ("y_aca",), CENTRES_Y, "m", kind="f8")
            file.add("z_aac", ("z_aac",), CENTRES, "m", kind="f8")
            whole = ("time", "z_aac", "y_aca", "x_caa")
            file.add("qˡ", whole, WATER, "kg/kg").add("ρ", ("z_aac",), density(CENTRES), "kg/m3")
        return ["breeze.nc"]

    def read(self, folder):
        f = opened(folder / "breeze.nc")
        return {"liquid": path(f["ρ"][:, None, None] * f["qˡ"][0], between(f["z_aac"]))}


class Era5:
    title, species = "ERA5", ["liquid", "ice", "rain"]
    names = ("clwc", "ciwc", "crwc")

    def write(self, folder):
        z = over_hill(4 * CENTRES)[::-1, ::-1]  # from the top, from north to south
        with File(folder / "era5.nc", {"valid_time": 1, "pressure_level": NZ, "latitude": NY, "longitude": NX}) as file:
            file.add("longitude", ("longitude",), 8 + 0.25 * np.arange(NX), "degrees_east", kind="f8")
            file.add("latitude", ("latitude",), 46 - 0.25 * np.arange(NY), "degrees_north", kind="f8")
            file.add("pressure_level", ("pressure_level",), pressure(4 * CENTRES[::-1]) / 100, "hPa", kind="f8")
            whole = ("valid_time", "pressure_level", "latitude", "longitude")
            for name, values in zip(self.names, (WATER, ICE, RAIN)):
                file.add(name, whole, values[::-1, ::-1], "kg kg**-1", kind="i2", scale_factor=1e-3 / 30000, add_offset=1e-3 / 3)
            file.add("t", whole, temperature(z), "K").add("z", whole, 9.80665 * z, "m**2 s**-2")
        return ["era5.nc"]

    def read(self, folder):
        f = opened(folder / "era5.nc")
        rho = 100 * f["pressure_level"][:, None, None] / (GAS_CONSTANT * f["t"][0])
        edges = between((f["z"][0] / 9.80665)[::-1, ::-1])
        step = 1e-3 / 30000
        found = {}
        for name, key in zip(self.species, self.names):
            water = np.where(np.abs(f[key][0]) <= 0.5001 * step, 0, f[key][0])  # within half a step of 0
            found[name] = path((rho * water)[::-1, ::-1], edges)
        return found


class ByCf:
    title, species = "CF", ["liquid", "ice"]

    def write(self, folder):
        with File(folder / "cf.nc", {"t": 1, "k": NZ, "j": NY, "i": NX}, Conventions="CF-1.8") as file:
            file.add("i", ("i",), CENTRES_X, "m", standard_name="projection_x_coordinate")
            file.add("j", ("j",), CENTRES_Y, "m", standard_name="projection_y_coordinate")
            file.add("k", ("k",), CENTRES, "m", standard_name="height", positive="up")
            whole = ("t", "k", "j", "i")
            for name, values, meaning, units in (("a", WATER, "mass_fraction_of_cloud_liquid_water_in_air", "1"),
                                                 ("b", ICE, "mass_fraction_of_cloud_ice_in_air", "g kg-1"),
                                                 ("c", pressure(CENTRES)[:, None, None] / 100, "air_pressure", "hPa"),
                                                 ("d", temperature(CENTRES)[:, None, None] - 273.15, "air_temperature", "degC")):
                scale = 1e3 if units == "g kg-1" else 1
                file.add(name, whole, scale * np.broadcast_to(values, WATER.shape), units, standard_name=meaning)
        return ["cf.nc", "--x-axis", "i", "--y-axis", "j", "--z-axis", "k", "--time-axis", "t"]

    def read(self, folder):
        f = opened(folder / "cf.nc")
        rho = 100 * f["c"][0] / (GAS_CONSTANT * (f["d"][0] + 273.15))
        edges = between(decimal(f["k"]))
        return {"liquid": path(rho * f["a"][0], edges), "ice": path(1e-3 * rho * f["b"][0], edges)}


class Npz:
    title, species = "NumPy archive", ["liquid"]

    def write(self, folder):
        np.savez_compressed(folder / "cloud.npz", lwc=1e3 * WATER * density(CENTRES)[:, None, None], reff=np.full(WATER.shape, 8.0), x=CENTRES_X, y=CENTRES_Y,
                            z=EDGES)
        return ["cloud.npz"]

    def read(self, folder):
        with np.load(folder / "cloud.npz") as arrays:
            return {"liquid": path(1e-3 * arrays["lwc"], arrays["z"])}


class NpzStored(Npz):
    title = "NumPy archive, not compressed"

    def write(self, folder):
        np.savez(folder / "cloud.npz", field=(1e3 * WATER).astype("f4"), other=np.zeros((2, 2)))
        return ["cloud.npz", "--variable", "field", "--quantity", "liquid_water_content", "--voxel-size-m", "100", "100", "40"]

    def read(self, folder):
        with np.load(folder / "cloud.npz") as arrays:
            return {"liquid": path(1e-3 * arrays["field"].astype(float), 40.0 * np.arange(NZ + 1))}


LAYOUTS = [Wrf(), Cm1(), Sam(), Dales(), MicroHh(), Palm(), Uclales(), MesoNh(), Icon(), IconCentres(), Cosmo(), Monc(), Rams(), Oceananigans(), Era5(),
           ByCf(), Npz(), NpzStored()]


def run(arguments, folder):
    done = subprocess.run([str(word) for word in arguments], cwd=folder, capture_output=True, text=True, timeout=120)
    if done.returncode != 0:
        raise Failure(f"exit code {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def row_of(layout, options, folder):
    """A row of the table: the model, how it was recognised, options that were needed, species, columns, and the largest difference."""
    needed = layout.write(folder)
    species = ["--species", ",".join(layout.species)] if len(layout.species) > 1 else []
    command = [options.cloudbow, "cloud", "import", *needed, *species, "-o", "cloud.vdb"]
    recognised = re.search(r"^model: (.*)$", run([*command, "--dry-run"], folder), re.MULTILINE)
    if (folder / "cloud.vdb").exists():
        raise Failure("--dry-run has written a file")
    run(command, folder)
    worst, columns = 0, 0
    for name, wanted in layout.read(folder).items():
        text = run([options.column_paths, "cloud.vdb", SPECIES[name]], folder)
        found = np.array([[float(word) for word in line.split()] for line in text.splitlines()])
        if found.shape != wanted.shape:
            raise Failure(f"{name}: {found.shape} columns, {wanted.shape} wanted")
        if np.any((found > 0) != (wanted > 0)):
            raise Failure(f"{name}: clouds in other columns")
        worst = max(worst, np.max(np.abs(found - wanted)) / np.max(wanted))
        worst = max(worst, np.max(np.abs(found[wanted > 0] / wanted[wanted > 0] - 1)))
        columns += int(np.sum(wanted > 0))
    if not worst <= TOLERANCE:
        raise Failure(f"a column differs by {worst:.2g}")
    shown = f"`{' '.join(needed[1:])}`" if needed[1:] else "none"
    return [layout.title, recognised[1] if recognised else "no model, by names", shown, ", ".join(layout.species), str(columns)], worst


def check_series(options, folder):
    """`--time all`: a numbered file for each moment with cloud, and none over an input."""
    def refused(name, arguments, *words):
        done = subprocess.run([options.cloudbow, "cloud", "import", *arguments], cwd=folder, capture_output=True, text=True, timeout=120)
        lines = done.stderr.strip().splitlines()
        if done.returncode != 2 or len(lines) != 1 or any(word not in lines[0] for word in words):
            raise Failure(f"{name}: exit code {done.returncode}, {done.stderr}")

    with File(folder / "series.nc", {"time": 3, "z": NZ, "y": NY, "x": NX}) as file:
        file.add("x", ("x",), CENTRES_X, "m").add("y", ("y",), CENTRES_Y, "m").add("z", ("z",), CENTRES, "m")
        file.add("rho", ("z",), density(CENTRES), "kg/m3").add("qc", ("time", "z", "y", "x"), np.stack([WATER, 0 * WATER, 2 * WATER]), "kg/kg")
    said = run([options.cloudbow, "cloud", "import", "series.nc", "--time", "all", "-o", "s.vdb"], folder)
    written = sorted(path.name for path in folder.glob("s*.vdb"))
    if written != ["s_0000.vdb", "s_0002.vdb"] or "time 1: no cloud, no file" not in said:
        raise Failure(f"files {written} of a series; {said}")
    first, last = (run([options.column_paths, name, "density"], folder) for name in written)
    if not np.allclose(2 * np.array(first.split(), float), np.array(last.split(), float), rtol=1e-6):
        raise Failure("the moments of the series are mixed up")
    (folder / "t_0002.vdb").write_bytes((folder / "series.nc").read_bytes())
    refused("series over a further file", ["series.nc", "--time", "all", "--with", "t_0002.vdb", "-o", "t.vdb"], "overwrite an input")
    refused("no output", ["series.nc"], "--output")
    refused("a moment beyond the last", ["series.nc", "--time", "3", "--dry-run"], "--time is beyond the time axis", "0 to 2")


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--column-paths", required=True, type=Path, metavar="PROGRAM")
    parser.add_argument("--only", default="", metavar="NAME", help="layouts whose title has this")
    parser.add_argument("--check", type=Path, metavar="PAGE", help="whether this page has the table")
    parser.add_argument("--write", type=Path, metavar="PAGE", help="put the table into this page")
    options = parser.parse_args()
    options.cloudbow, options.column_paths = Path(options.cloudbow).resolve(), options.column_paths.resolve()
    table = ["| model | recognised | options | species | columns within 1e-6 |", "| --- | --- | --- | --- | --- |"]
    failures, largest = 0, 0
    for layout in LAYOUTS:
        if options.only not in layout.title:
            continue
        with tempfile.TemporaryDirectory() as folder:
            try:
                row, worst = row_of(layout, options, Path(folder))
            except Failure as failure:
                print(f"FAIL  {layout.title}: {failure}", flush=True)
                failures += 1
                continue
        table.append("| " + " | ".join(row) + " |")
        largest = max(largest, worst)
        print(f"{table[-1]}  {worst:.1e}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        try:
            check_series(options, Path(folder))
        except Failure as failure:
            print(f"FAIL  series: {failure}")
            failures += 1
    print(f"{len(LAYOUTS)} layouts, {failures} failures, largest relative difference of a column {largest:.1e}")
    text = "\n".join([BEGIN, *table, END])
    for page in filter(None, (options.check, options.write)):
        before, rest = page.read_text().split(BEGIN)
        if options.write:
            page.write_text(before + text + rest.split(END)[1])
        elif text != BEGIN + rest.split(END)[0] + END:
            print(f"FAIL  {page}: its table is another one; --write {page} puts this one there")
            failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
