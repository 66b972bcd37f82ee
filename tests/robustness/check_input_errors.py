#!/usr/bin/env python3
"""Wrong input ends with exit code 2 and no output file. One message names the place, what was found and what is allowed.

Each case spoils one thing in a scene that runs; the words are those that a user needs to put it right. That the unspoiled scene is accepted is
checked first.

usage: check_input_errors.py --cloudbow PROGRAM --faulty-vdb PROGRAM
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py

from made_gas_files import write_bulk_table, write_gas_model
from sound_scene import SCENE

# One VDB file each, made by faulty_vdb, and words of the message.
VDB_FAULTS = {
    "nan": ["nan"], "infinite": ["inf"], "negative": ["-0.01", "counts as 0"], "rotated": ["rotates", "resample"], "sheared": ["shears", "resample"], "empty": ["empty"],
    "double": ["double", "float"], "mask": ["float"], "background": ["background is 0.001", "[domain]", "min_m = [-25, -25, 75]"],
    "nan_background": ["background is nan"], "level_set": ["vdb_tool", "-ls2fog"], "twins": ['"density[0]"', '"density[1]"'],
    "water": ["scene.toml:5: cloud.quantity", "contradicts", "liquid_water_content"], "per_km": ["km^-1", "cloud.scale = 0.001"], "named": ["den\\x1b[2Jsity"]}


def replaced(old, new):
    assert old in SCENE, old
    return SCENE.replace(old, new)


def scenes():
    """(name, scene, words of the message)"""
    layer = "[[layer]]\nbottom_m = 0.0\ntop_m = 100.0\noptical_depth = 0.1\nsingle_scattering_albedo = 1.0\nphase_function = 'rayleigh'\n"
    yield "unknown key", replaced("scale = 1.0", "skale = 1.0"), ["scene.toml:6", "skale", "scale"]
    yield "unknown table", SCENE + "[clouds]\n", ["scene.toml", "clouds"]
    yield "wrong type", replaced("zenith_deg = 60.0", 'zenith_deg = "high"'), ["scene.toml:13", "sun.zenith_deg", "high"]
    yield "nan", replaced("zenith_deg = 60.0", "zenith_deg = nan"), ["scene.toml:13", "sun.zenith_deg", "nan"]
    yield "infinity", replaced("scale = 1.0", "scale = inf"), ["scene.toml:6", "cloud.scale", "inf"]
    yield "not TOML", SCENE + "albedo = = 3\n", ["scene.toml:20"]
    yield "text without quotes", replaced('"cloud.vdb"', "cloud.vdb"), ["scene.toml:3", 'file = "cloud.vdb"', "quotes"]
    yield "number in quotes", replaced("60.0", '"60.0"'), ["scene.toml:13", "sun.zenith_deg", "without quotes"]
    yield "number with its unit", replaced("60.0", "60 deg"), ["scene.toml:13", "unit"]
    yield "key of too many parts", 'x = "#"\n"#"' + 20000 * ".a" + " = 1\n" + SCENE, ["scene.toml:2", "nested", "32"]
    yield "value out of range", replaced("albedo = 0.05", "albedo = -0.1"), ["scene.toml:17", "surface.albedo", "-0.1", "0 to 1"]
    yield "albedo 1.2", replaced("albedo = 0.05", "albedo = 1.2"), ["scene.toml:17", "surface.albedo", "1.2", "0 to 1"]
    yield "surface of an unknown type", replaced('"lambertian"', '"snow"'), ["scene.toml:16", "surface.type", "snow", "rpv"]
    yield "surface without its parameter", replaced('"lambertian"\nalbedo = 0.05', '"cox-munk"'), ["surface.wind_speed_m_s", "missing"]
    yield "missing albedo map", replaced("albedo = 0.05", 'albedo_map = "none.h5"'), ["scene.toml:17", "surface.albedo_map", "none.h5"]
    yield "a cloud as albedo map", replaced("albedo = 0.05", 'albedo_map = "cloud.vdb"'), ["scene.toml:17", "cloud.vdb", "neither PNG nor HDF5"]
    yield "albedo map above 1", replaced("albedo = 0.05", 'albedo_map = "bright.h5"'), ["scene.toml:17", "bright.h5", "1.5", "0 to 1"]
    yield "radiance along the horizon", SCENE + '[[radiance]]\nname = "a"\nzenith_deg = 90.0\n', ["radiance.0.zenith_deg", "90"]
    yield "two images of one name", SCENE + 2 * '[[radiance]]\nname = "a"\nzenith_deg = 0.0\n', ["radiance.1.name", "already in use"]
    camera = '[[camera]]\nname = "a"\nposition_m = [0.0, 0.0, 0.0]\nwidth = 4\nheight = 4\n'
    yield "camera without a point to look at", SCENE + camera, ["camera.0.look_at_m", "missing"]
    yield "camera that looks at itself", SCENE + camera + "look_at_m = [0.0, 0.0, 0.0]\n", ["camera.0.look_at_m", "its own position"]
    yield "camera without up", SCENE + camera + "look_at_m = [0.0, 0.0, 9.0]\nup = [0.0, 0.0, 1.0]\n", ["camera.0.look_at_m", "parallel"]
    yield "camera below the ground", SCENE + camera.replace("0.0]", "-1.0]") + 'type = "fisheye"\n', ["camera.0.position_m", "below the ground", "-1"]
    yield "camera and image of one name", SCENE + camera + 'type = "fisheye"\n[[radiance]]\nname = "a"\nzenith_deg = 0.0\n', ["name", "already in use"]
    yield "image width without height", SCENE + '[[radiance]]\nname = "a"\nzenith_deg = 0.0\nwidth = 4\n', ["radiance.0.height", "missing"]
    spectrum = "[spectrum]\nwavelengths_um = [0.67, 0.55]\n"
    yield "list without spectrum", replaced("albedo = 0.05", "albedo = [0.05, 0.1]"), ["scene.toml:17", "surface.albedo", "[spectrum]"]
    yield "list of another length", replaced("albedo = 0.05", "albedo = [0.05]") + spectrum, ["scene.toml:17", "surface.albedo", "a list of 2"]
    yield "value out of range at one wavelength", replaced("albedo = 0.05", "albedo = [0.05, 1.5]") + spectrum, ["scene.toml:17", "surface.albedo", "1.5", "0 to 1"]
    yield "spectrum without wavelengths", SCENE + "[spectrum]\n", ["spectrum.wavelengths_um", "missing"]
    yield "g = 1", replaced("= 0.85", "= 1.0"), ["scene.toml:11", "asymmetry_parameter", "1"]
    yield "ssa 1.01", replaced("= 0.99", "= 1.01"), ["scene.toml:7", "single_scattering_albedo", "1.01", "0 to 1"]
    yield "sun below the horizon", replaced("zenith_deg = 60.0", "zenith_deg = 95.0"), ["scene.toml:13", "sun.zenith_deg", "95", "90"]
    yield "azimuth and bearing", replaced("azimuth_deg = 0.0", "azimuth_deg = 0.0\nbearing_deg = 90.0"), ["scene.toml", "azimuth_deg", "bearing_deg"]
    yield "neither azimuth nor bearing", replaced("azimuth_deg = 0.0\n", ""), ["scene.toml", "azimuth_deg", "bearing_deg"]
    yield "negative density scale", replaced("scale = 1.0", "scale = -1.0"), ["scene.toml:6", "cloud.scale", "-1", "> 0"]
    for key, text in (("cloud.scale", replaced("scale = 1.0", "scale = 1e-320")), ("layer.0.top_m", SCENE + layer.replace("100.0", "1e-320")),
                      ("layer.0.optical_depth", SCENE + layer.replace("0.1", "1e-320")), ("domain.min_m", SCENE + "[domain]\nmin_m = [0.0, 0.0, -1e-320]\n")):
        yield f"denormal {key}", text, [key, "too small"]
    yield "layer of 1e-300 m", SCENE + layer.replace("100.0", "1e-300") + "[domain]\nmax_m = [300.0, 300.0, 400.0]\n", ["layer", "too thin"]
    yield "radius in metres", replaced("scale = 1.0", "effective_radius_um = 1e-5"), ["scene.toml:6", "cloud.effective_radius_um", "0.1 to 5000 um"]
    yield "netCDF as cloud", replaced("cloud.vdb", "les.nc"), ["les.nc", "netCDF", "cloudbow cloud import"]
    yield "HDF5 as cloud", replaced("cloud.vdb", "bright.h5"), ["bright.h5", "HDF5", "cloudbow cloud import"]
    yield "missing cloud file", replaced("cloud.vdb", "none.vdb"), ["none.vdb"]
    yield "a directory as cloud", replaced("cloud.vdb", "folder"), ["folder", "directory"]
    yield "a text file as cloud", replaced("cloud.vdb", "scene.toml"), ["scene.toml"]
    yield "wrong grid name", replaced('grid = "density"', 'grid = "clouds"'), ["cloud.vdb", "clouds", "density"]
    yield "unknown phase function", replaced('phase_function = "droplets"', 'phase_function = "drops"'), ["scene.toml", "drops", "droplets"]
    yield "unknown accuracy", replaced('"draft"', '"best"'), ["scene.toml:19", "best", "draft, balanced, fine, reference"]
    yield "no light", SCENE.replace("[sun]\nzenith_deg = 60.0\nazimuth_deg = 0.0\n", ""), ["sun", "sky"]
    yield "domain off the voxel faces", SCENE + "[domain]\nmin_m = [0.0, 0.0, 0.0]\nmax_m = [310.0, 300.0, 400.0]\n", ["310", "300", "350"]
    yield "domain smaller than the cloud", SCENE + "[domain]\nmin_m = [0.0, 0.0, 0.0]\nmax_m = [200.0, 300.0, 400.0]\n", ["200", "300"]
    liquid = SCENE[SCENE.index("file"):SCENE.index("[phase_function")]
    both = replaced("[cloud]\n" + liquid, '[[cloud]]\nname = "liquid"\n' + liquid + '[[cloud]]\nname = "ice"\n' + liquid)
    second = lambda old, new: both[:both.index('"ice"')] + both[both.index('"ice"'):].replace(old, new, 1)
    yield "a table beside an array of tables", second('"ice"', '"ice"\n[cloud]'), ["scene.toml:12", "[[cloud]] for each constituent"]
    yield "constituents of one name", second('"ice"', '"liquid"'), ["scene.toml:11: cloud.1.name", "already in use", "liquid"]
    yield "a constituent without name", second('name = "ice"\n', "").replace('name = "ice"\n', ""), ["scene.toml:10: cloud.1.name", "missing"]
    yield "unknown phase function of the second", second('"droplets"', '"crystals"'), ["scene.toml:17: cloud.1.phase_function", "crystals", "droplets"]
    yield "constituents on other voxels", second("scale = 1.0", "scale = 1.0\nvoxel_size_m = 40.0"), ["scene.toml:12: cloud.1.file", '"ice"', '"liquid"', "along x", "40 m", "50 m", "resample"]
    yield "an array of no tables", replaced("[cloud]\n" + liquid, "cloud = [1.0]\n"), ["scene.toml:2", "cloud", "[[cloud]]"]
    yield "grids of which one is missing", replaced('"density"', '["density", "rain"]'), ["cloud.vdb", "rain", "density"]
    yield "more memory than the machine has", SCENE + ("[domain]\nmin_m = [0.0, 0.0, 0.0]\nmax_m = [1500000.0, 1500000.0, 400.0]\n[[layer]]\nname = 'air'\n"
           "bottom_m = 0.0\ntop_m = 400.0\noptical_depth = 0.1\nsingle_scattering_albedo = 1.0\nphase_function = 'rayleigh'\n"), ["memory"]
    thermal, air, warm = "[thermal]\nwavelength_um = 10.8\n", '[atmosphere]\nstandard = "us-1976"\n', "albedo = 0.05\ntemperature_k = 288.0"
    hot = replaced("albedo = 0.05", warm)
    yield "emission without a temperature of the ground", SCENE.replace("[sun]\nzenith_deg = 60.0\nazimuth_deg = 0.0\n", "") + air + thermal, ["scene.toml:12", "surface.temperature_k", "missing"]
    yield "emission without air", hot.replace("azimuth_deg = 0.0", "azimuth_deg = 0.0\nirradiance_w_m2 = 0.2") + thermal, ["atmosphere", "missing", "us-1976"]
    yield "a sun beside emission, of no irradiance", hot + air + thermal, ["sun.irradiance_w_m2", "missing", "W m-2 um-1"]
    yield "temperature without emission", hot, ["scene.toml:18", "surface.temperature_k", "[thermal]"]
    emitting = hot.replace("[sun]\nzenith_deg = 60.0\nazimuth_deg = 0.0\n", "") + air
    yield "degrees Celsius", emitting.replace("288.0", "15.0") + thermal, ["scene.toml:15", "surface.temperature_k", "15", "not Celsius"]
    yield "wavelength and band", emitting + thermal + "band_um = [8.0, 12.0]\n", ["thermal.band_um", "exclude"]
    yield "band that descends", emitting + "[thermal]\nband_um = [12.0, 8.0]\n", ["thermal.band_um", "[12, 8]", "a < b"]
    yield "wavelength in nanometres", emitting + "[thermal]\nwavelength_um = 10800.0\n", ["thermal.wavelength_um", "10800", "10000"]
    yield "emission in the ultraviolet", emitting + "[thermal]\nwavelength_um = 0.2\n", ["thermal", "longer wavelengths"]
    yield "missing temperature grid", emitting.replace("scale = 1.0", 'temperature_grid = "T"') + thermal, ["scene.toml:6", "cloud.temperature_grid", '"T"', "density"]
    yield "extinction as temperature", emitting.replace("scale = 1.0", 'temperature_grid = "density"') + thermal, ["cloud.temperature_grid", "extinction", "temperature"]
    yield "albedo as temperature map", emitting.replace("temperature_k = 288.0", 'temperature_map = "bright.h5"') + thermal, ["surface.temperature_map", "bright.h5", "100 to 1000 K"]
    yield "heating rates without air", SCENE + '[output]\nfields = ["heating_rate"]\n', ["output.fields", "[atmosphere]"]
    yield "optical depth without a cloud", layer + '[sun]\nzenith_deg = 0.0\nazimuth_deg = 0.0\n[output]\nfields = ["optical_depth"]\n', ["output.fields", "no [cloud]", "[[layer]]"]
    yield "missing atmosphere file", emitting.replace('standard = "us-1976"', 'file = "none.dat"') + thermal, ["atmosphere.file", "none.dat"]
    yield "a cloud as atmosphere", emitting.replace('standard = "us-1976"', 'file = "cloud.vdb"') + thermal, ["atmosphere.file", "cloud.vdb"]
    yield "brightness temperature of sunlight", SCENE + '[[radiance]]\nname = "a"\nzenith_deg = 0.0\nquantity = "brightness_temperature"\n', ["radiance.0.quantity", "[thermal]"]
    yield from broadband_scenes()
    for fault, words in VDB_FAULTS.items():
        yield f"VDB file: {fault}", replaced("cloud.vdb", f"{fault}.vdb"), [f"{fault}.vdb", *words]
    for cut in (50, 90, 99):
        yield f"VDB file cut at {cut} %", replaced("cloud.vdb", f"cut_{cut}.vdb"), [f"cut_{cut}.vdb"]


def broadband_scenes():
    """Of scenes with a gas model; the files are made up."""
    air, model, sun = '[atmosphere]\nstandard = "us-1976"\nh2o = 1e-3\no3 = 1e-7\n', '[spectrum]\ngas_model = "sun.nc"\n', "[sun]\nzenith_deg = 60.0\nazimuth_deg = 0.0\n"
    lit = replaced("azimuth_deg = 0.0", "azimuth_deg = 0.0\nirradiance_w_m2 = 1361.0") + air + model
    longwave = replaced(sun, "").replace("albedo = 0.05", "albedo = 0.05\ntemperature_k = 288.0") + air + model.replace("sun.nc", "long.nc")
    bulk = (lit.replace("single_scattering_albedo = 0.99", "effective_radius_um = 10.0").replace('type = "henyey-greenstein"\nasymmetry_parameter = 0.85', 'type = "bulk"\nfile = "bulk.nc"'))
    for name, file, words in (("a result", "gas.h5", ["netCDF", "upwelling_flux"]), ("a cloud", "cloud.vdb", ["neither netCDF nor HDF5"]), ("bulk optics", "bulk.nc", ["mass_extinction_coefficient"])):
        yield f"{name} as gas model", lit.replace("sun.nc", file), ["scene.toml:26: spectrum.gas_model", file, "no gas model", "ecCKD", *words]
    yield "missing gas model", lit.replace("sun.nc", "none.nc"), ["scene.toml:26: spectrum.gas_model", "no such file", "none.nc"]
    yield "a longwave model with a sun", lit.replace("sun.nc", "long.nc"), ["scene.toml:12: sun", "longwave", "long.nc", "without [sun]"]
    yield "a model of sunlight with emission", lit + "[thermal]\n", ["scene.toml:27: thermal", "sunlight", "sun.nc", "without [thermal]"]
    yield "a model of sunlight without sun", replaced(sun, "") + air + model, ["scene.toml:21: sun", "missing", "sun.nc", "[sun]"]
    yield "sunlight without a total", lit.replace("irradiance_w_m2 = 1361.0\n", ""), ["scene.toml:12: sun.irradiance_w_m2", "missing", "1361"]
    yield "a gas that is missing", lit.replace("h2o = 1e-3\n", ""), ["scene.toml:21: atmosphere", "h2o", "found o3", "allowed all of h2o, o3"]
    yield "a gas model without air", lit.replace(air, ""), ["scene.toml:21: atmosphere", "missing", "h2o, o3"]
    yield "water vapour in g/kg", lit.replace("1e-3", "7.0"), ["scene.toml:23: atmosphere.h2o", "7", "mole fraction, 0 to 1"]
    yield "a list of water vapour without heights", lit.replace("1e-3", "[1e-3, 1e-4]"), ["scene.toml:23: atmosphere.h2o", "2 numbers", "height_m"]
    yield "carbon dioxide twice", lit.replace("o3 = 1e-7", "o3 = 1e-7\nco2 = 4e-4\nco2_ppm = 400.0"), ["scene.toml:26: atmosphere.co2_ppm", "co2"]
    yield "bulk without gas model", bulk.replace(model, ""), ["scene.toml:10: phase_function.droplets.type", "spectrum.gas_model", "mie"]
    yield "bulk of a radius outside its table", bulk.replace("= 10.0", "= 50.0"), ["scene.toml:7: cloud.effective_radius_um", "bulk.nc", "50", "4 to 20 um"]
    yield "bulk without radius", bulk.replace("effective_radius_um = 10.0\n", ""), ["cloud.effective_radius_um", "missing", "phase_function.droplets.effective_radius_um"]
    yield "a gas model as bulk optics", bulk.replace("bulk.nc", "sun.nc"), ["scene.toml:11: phase_function.droplets.file", "sun.nc", "not a table of bulk optics", "mass_extinction_coefficient"]
    yield "bulk of file and substance", bulk.replace('"bulk.nc"', '"bulk.nc"\nsubstance = "water"'), ["scene.toml:12: phase_function.droplets.substance", "file", "both"]
    yield "bulk of nothing", bulk.replace('file = "bulk.nc"\n', ""), ["phase_function.droplets.file", "missing", "substance"]
    yield "bulk of another substance", bulk.replace('file = "bulk.nc"', 'substance = "honey"'), ["scene.toml:11: phase_function.droplets.substance", "honey", "water, ice"]
    for key, value in (("few_points", "3"), ("few_tolerance", "0.01")):
        for method in ("all", "columns"):
            yield f"{key} of method {method}", lit + f'method = "{method}"\n{key} = {value}\n', [f"scene.toml:28: spectrum.{key}", method, '"few"']
        yield f"{key} without a model", SCENE + f"[spectrum]\nwavelengths_um = [0.5]\n{key} = {value}\n", [f"scene.toml:22: spectrum.{key}", "wavelengths alone", "gas_model"]
    yield "more points than there are", lit + "few_points = 30\n", ["scene.toml:27: spectrum.few_points", "30", "1 to 2"]
    yield "a method that there is not", lit + 'method = "some"\n', ["scene.toml:27: spectrum.method", "some", "few, all, columns"]
    yield "bands of few g-points", lit + '[output]\nfields = ["bands"]\n', ["scene.toml:28: output.fields", "few", "columns"]
    yield "wavelengths beside a gas model", lit + "wavelengths_um = [0.5]\n", ["spectrum.gas_model", "wavelengths_um", "both"]
    yield "albedo twice", lit.replace("albedo = 0.05", 'albedo = 0.05\nspectral_albedo = "albedo.txt"'), ["scene.toml:19: surface.spectral_albedo", "albedo", "both"]
    spectral = lit.replace("albedo = 0.05", 'spectral_albedo = "albedo.txt"')
    yield "albedo of too few wavelengths", spectral, ["scene.toml:18: surface.spectral_albedo", "albedo.txt", "0.8 to 0.9", "repeat the last albedo"]
    yield "a table of optics as albedo", spectral.replace("albedo.txt", "bulk.nc"), ["scene.toml:18: surface.spectral_albedo", "bulk.nc:1", "two columns"]
    yield "spectral albedo without gas model", spectral.replace(model, ""), ["scene.toml:18: surface.spectral_albedo", "spectrum.gas_model"]
    yield "wavelength of emission beside a gas model", longwave + "[thermal]\nwavelength_um = 10.8\n", ["scene.toml:25: thermal.wavelength_um", "spectrum.gas_model"]
    yield "broadband brightness temperature", longwave + '[thermal]\n[[radiance]]\nname = "a"\nzenith_deg = 0.0\nquantity = "brightness_temperature"\n', ["scene.toml:28: radiance.0.quantity", "one spectral interval", "radiance with spectrum.gas_model"]
    yield "broadband emission without a temperature of the ground", longwave.replace("temperature_k = 288.0\n", "") + "[thermal]\n", ["surface.temperature_k", "missing"]
    yield "a sky of no spectrum", lit + "[sky]\nradiance_w_m2_sr = 1.0\n", ["scene.toml:28: sky.radiance_w_m2_sr", "no spectrum"]


def sweep_commands():
    """(name, arguments, words of the message) of `cloudbow sweep`."""
    suns = "sun.zenith_deg=0,30"
    for name, lists, words in (
            ("no list", ["sun.zenith_deg=30"], ["sun.zenith_deg", "nothing to sweep", "cloudbow run"]),
            ("an empty value", ["sun.zenith_deg=0,"], ["sun.zenith_deg", "an empty value"]),
            ("an empty part of a key", ["sun.zenith_deg.=0,30"], ["sun.zenith_deg.", "dotted key"]),
            ("an open bracket", ["sun.zenith_deg=[0,30"], ["[0,30", "without its partner"]),
            ("a range without end", ["sun.zenith_deg=0:30:-1"], ["0:30:-1", "FIRST:LAST:STEP"]),
            ("NaN", ["sun.zenith_deg=nan,1"], ["sun.zenith_deg=nan"]),
            ("a value twice", ["sun.zenith_deg=0,0.0"], ["sun.zenith_deg", "a value twice"]),
            ("a key twice", [suns, suns], ["sun.zenith_deg", "a key twice"]),
            ("a key inside another", [suns, "sun={zenith_deg=1,azimuth_deg=0},{zenith_deg=2,azimuth_deg=0}"], ["sun.zenith_deg", "inside a key that has a list"]),
            ("the last value out of range", ["sun.zenith_deg=0,30,91"], ["sun.zenith_deg=91", "out of range"]),
            ("an unknown key", ["sun.zenit_deg=0,30"], ["sun.zenit_deg", "did you mean zenith_deg?"]),
            ("too many runs", ["surface.albedo=0:1:0.001", "sun.zenith_deg=0:80:1"], ["too many runs", "10000"])):
        yield name, [word for one in lists for word in ("--set", one)], words
    for share in ("0/2", "3/2", "1", "1/99999999999999999999"):
        yield f"share {share}", ["--set", suns, "--share", share], ["--share", share, "I/N"]
    yield "no job", ["--set", suns, "--jobs", "0"], ["--jobs", "1 to 4096"]


def phase_commands(folder):
    """(name, arguments, words of the message) of `cloudbow phase`; the files are in the folder."""
    for name, text in (("moments.txt", "0 1\n1 0.3\n"), ("factor.txt", "0 1\n1 0\n2 0.5\n"), ("coarse.txt", "0 1.2\n180 1.2\n"), ("gap.txt", "0 1\n2 0.85\n"), ("large.txt", "0 1\n1 1.85\n"), ("words.txt", "0 1\n1 much\n"), ("nothing.txt", ""),
                       ("half.txt", "0 1\n90 1\n"), ("falling.txt", "0 1\n90 1\n80 1\n180 1\n"), ("negative.txt", "0 1\n180 -1\n"), ("zero.txt", "0 0\n180 0\n")):
        (folder / name).write_text(text)
    hg = ["henyey-greenstein", "--asymmetry-parameter", "0.5"]
    yield "no type", [], ["type"]
    yield "unknown type", ["henyey"], ["henyey", "henyey-greenstein", "legendre"]
    yield "no asymmetry parameter", ["henyey-greenstein"], ["--asymmetry-parameter", "missing"]
    for g in ("1", "-1", "nan", "inf", "1e+300"):
        yield f"asymmetry parameter {g}", ["henyey-greenstein", "--asymmetry-parameter", g], ["asymmetry", g, "-1 < g < 1"]
    yield "asymmetry parameter in words", ["henyey-greenstein", "--asymmetry-parameter", "much"], ["--asymmetry-parameter", "much"]
    yield "an option of another type", ["rayleigh", "--asymmetry-parameter", "0.5"], ["rayleigh", "--asymmetry-parameter", "henyey-greenstein"]
    yield "forward weight 2", ["double-henyey-greenstein", "--forward-asymmetry-parameter", "0.8", "--backward-asymmetry-parameter", "-0.5", "--forward-weight", "2"], ["weight", "0 to 1"]
    yield "control points 100", [*hg, "--control-points", "100"], ["100", "162"]
    yield "delta-M order 0", [*hg, "--delta-m-order", "0"], ["delta-M", "0", "64"]
    yield "unknown fit", [*hg, "--fit", "spline"], ["spline", "least-squares"]
    yield "exact moments 99", [*hg, "--exact-moments", "99"], ["99", "12"]
    yield "unknown quadrature", [*hg, "--quadrature", "gauss"], ["gauss", "double-gauss"]
    yield "travel without length", [*hg, "--travel", "0", "0", "0"], ["travel"]
    yield "travel that is no number", [*hg, "--travel", "nan", "0", "0"], ["travel"]
    yield "no file", ["legendre"], ["--file", "missing"]
    yield "missing file", ["legendre", "--file", folder / "none.txt"], ["none.txt"]
    yield "a directory as file", ["table", "--file", folder / "folder"], ["folder", "directory"]
    yield "a binary file as table", ["table", "--file", folder / "cloud.vdb"], ["cloud.vdb:1", "wrong layout", "angle_deg value"]
    yield "a moment left out", ["legendre", "--file", folder / "gap.txt"], ["gap.txt", "l = 2", "l = 1"]
    yield "a moment above 1", ["legendre", "--file", folder / "large.txt"], ["large.txt", "1.85", "-1 to 1"]
    yield "a moment in words", ["legendre", "--file", folder / "words.txt"], ["words.txt:2", "much"]
    yield "moments with the factor 2l+1", ["legendre", "--file", folder / "factor.txt"], ["factor.txt", "-0.25 at 90 degrees", "2l+1"]
    yield "a table of another norm", ["table", "--file", folder / "coarse.txt"], ["coarse.txt", "1.2", "1 %"]
    yield "no moments", ["legendre", "--file", folder / "nothing.txt"], ["nothing.txt", "missing"]
    yield "a table of half the angles", ["table", "--file", folder / "half.txt"], ["half.txt", "90", "180"]
    yield "a table that turns back", ["table", "--file", folder / "falling.txt"], ["falling.txt", "80", "ascending"]
    yield "a negative table", ["table", "--file", folder / "negative.txt"], ["negative.txt", "-1", ">= 0"]
    yield "a table of zeros", ["table", "--file", folder / "zero.txt"], ["zero.txt", "0"]
    yield "plot in a missing folder", [*hg, "--plot", folder / "nowhere/plot.png"], ["nowhere"]
    yield "plot is a directory", [*hg, "--plot", folder / "folder"], ["folder"]
    yield "plot and file the same", [*hg, "--plot", folder / "output.h5"], ["output.h5", "plot"]
    yield "plot over its own input", ["legendre", "--file", folder / "moments.txt", "--plot", folder / "moments.txt"], ["moments.txt", "overwrite"]


def export_commands(folder):
    """(name, arguments, words of the message) of `cloudbow export`. One result has actinic flux and absorption, the other layers alone."""
    result, up = folder / "result.h5", ["--direction", "0", "0", "1"]
    (folder / "cut.h5").write_bytes(result.read_bytes()[:4000])
    yield "nothing asked for", [result], ["--direction", "--actinic"]
    yield "missing file", [folder / "none.h5", *up], ["none.h5", "no such file"]
    yield "a directory as result", [folder / "folder", *up], ["folder", "a directory"]
    yield "a cloud as result", [folder / "cloud.vdb", *up], ["cloud.vdb", "result file"]
    yield "HDF5 that is no result", [folder / "bright.h5", *up], ["bright.h5", "not a result file"]
    yield "a result cut off", [folder / "cut.h5", *up], ["cut.h5", "can't be read"]
    yield "no radiance field", [result, *up], ["result.h5", "radiance_field", "output.fields"]
    yield "no radiance field, all directions", [result, "--all-directions"], ["result.h5", "radiance_field", "output.fields"]
    yield "uneven levels without a cloud", [folder / "layers.h5", "--actinic"], ["layers.h5", "uneven", "domain.vertical_cells"]
    yield "no actinic flux", [folder / "even.h5", "--actinic"], ["even.h5", '"actinic"', "output.fields"]
    yield "direction without length", [result, "--direction", "0", "0", "0"], ["direction", "0 0 0"]
    yield "direction that is no number", [result, "--direction", "0", "nan", "0"], ["--direction", "nan"]
    yield "direction of two numbers", [result, "--direction", "0", "1"], ["--direction", "3"]
    yield "direction and zenith", [result, *up, "--zenith-deg", "0"], ["--direction", "--zenith-deg"]
    yield "azimuth alone", [result, "--azimuth-deg", "0"], ["--azimuth-deg", "--zenith-deg"]
    yield "zenith 181", [result, "--zenith-deg", "181"], ["--zenith-deg", "181", "0 to 180"]


def import_commands(folder):
    """(name, arguments, words of the message) of `cloudbow cloud import`: options that the file's format has no use for."""
    import numpy
    at3d, array, columns, les = folder / "at3d.csv", folder / "array.npy", folder / "columns.txt", folder / "les.nc"
    at3d.write_text("#a\n2,2,2\n0.1,0.1\n0.1,0.2\nx,y,z,lwc,reff\n0,0,0,0.1,10\n")
    numpy.save(array, numpy.ones((2, 2, 2), "float32"))
    columns.write_text("0 0 0 1\n")
    size = ["--voxel-size-m", "100"]
    for option, value in (("--time", "0"), ("--units", "g/kg"), ("--x-axis", "x"), ("--time-axis", "x"), ("--air-density", "1"), ("--pressure", "p"), ("--temperature", "t"), ("--fill", "error"),
                          ("--droplet-number", "n"), ("--droplet-number-cm3", "100"), ("--radius-ratio-cubed", "0.8"), ("--effective-radius", "r")):
        yield f"AT3D with {option}", [at3d, option, value], [f"{option}:", "at3d.csv", "found", "at3d", "allowed les"]
    archive, cut, other = folder / "archive.npz", folder / "cut.npz", folder / "other.npz"
    numpy.savez_compressed(archive, lwc=numpy.linspace(0, 1, 8000).reshape(20, 20, 20), reff=numpy.ones((2, 2, 2)))
    cut.write_bytes(archive.read_bytes()[:-30])
    numpy.savez(other, a=numpy.ones(3), b=numpy.ones(3))
    broken = bytearray(archive.read_bytes())
    broken[200] ^= 255
    (folder / "broken.npz").write_bytes(broken)
    yield "archive without sizes", [archive], ["archive.npz", "no coordinates 'x'", "--voxel-size-m"]
    yield "archive with radii of another shape", [archive, *size], ["'reff'", "another shape"]
    yield "archive that is cut off", [cut, *size], ["cut.npz", "cut off"]
    yield "archive with a wrong byte", [folder / "broken.npz", *size], ["broken.npz", "damaged"]
    yield "archive without a cloud", [other, *size], ["other.npz", "arrays in the file: a, b", "--variable"]
    yield "archive without the array", [other, *size, "--variable", "c"], ["no array 'c'", "a, b"]
    yield "array with --variable", [array, *size, "--variable", "c"], ["array.npy", "--variable", ".npz"]
    for option, value in (("--with", les), ("--profile", columns), ("--species", "ice"), ("--model", "wrf"), ("--base-pressure", "p"), ("--potential-temperature", "t")):
        yield f"NumPy with {option}", [array, *size, option, value], [f"{option}:", "numpy", "allowed les"]
    yield "--time that is no number", [les, "--time", "last"], ["--time", "last", "or all"]
    yield "unknown species", [les, "--species", "liquid,hail"], ["--species", "hail"]
    yield "unknown model", [les, "--model", "mm5"], ["--model", "mm5", "wrf"]
    yield "two temperatures", [les, "--temperature", "t", "--potential-temperature", "th"], ["--temperature", "--potential-temperature"]
    yield "profile and density", [les, "--profile", columns, "--air-density", "1"], ["--profile", "--air-density", "leave out one"]
    yield "AT3D with --quantity", [at3d, "--quantity", "extinction"], ["--quantity:", "at3d", "les, columns, numpy"]
    yield "LES with --columns", [les, "--columns", "4", "4"], ["--columns:", "les.nc", "les", "columns, optics-csv"]
    yield "LES with --phase-functions", [les, "--phase-functions", columns], ["--phase-functions:", "les", "shdom, optics-csv"]
    yield "NumPy with --time", [array, *size, "--time", "1"], ["--time:", "array.npy", "numpy", "allowed les"]
    yield "text with --units", [columns, *size, "--units", "g/kg"], ["--units:", "columns", "allowed les"]
    yield "text called LES", [columns, *size, "--format", "shdom", "--time", "1"], ["--time:", "shdom", "allowed les"]
    yield "factor of no moments", [at3d, "--moment-factor", "included"], ["--moment-factor", "--phase-functions"]
    yield "VDB", [folder / "cloud.vdb"], ["cloud.vdb", "an OpenVDB file already", "cloud.file", "cloud info"]


class Checker:
    def __init__(self, program, folder):
        self.program = program
        self.folder = folder
        self.faults = []

    def expect_error(self, name, arguments, words, output):
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, timeout=60)
        message = done.stderr.strip()
        problems = []
        if done.returncode != 2:
            problems.append(f"exit code {done.returncode} instead of 2")
        if len(message.splitlines()) != 1:
            problems.append(f"{len(message.splitlines())} lines instead of one message")
        problems += [f"no word of '{word}'" for word in words if word.lower() not in message.lower()]
        left = [path.name for path in self.folder.iterdir() if path.name.startswith(output.stem)] if output.parent == self.folder else []
        if left:
            problems.append(f"left {', '.join(left)} behind")
        print(f"{'FAIL' if problems else 'ok':5s}{name}: {message}", flush=True)
        self.faults += [f"{name}: {problem}" for problem in problems]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    parser.add_argument("--faulty-vdb", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="cloudbow-errors-") as name:
        folder = Path(name)
        (folder / "folder").mkdir()
        cloud = folder / "cloud.vdb"
        subprocess.run([options.cloudbow, "cloud", "make", "sphere", "--cells", "6", "6", "8", "--voxel-size-m", "50", "50", "50", "-o", str(cloud)], check=True,
                       stdout=subprocess.DEVNULL)
        whole = cloud.read_bytes()
        for cut in (50, 90, 99):
            (folder / f"cut_{cut}.vdb").write_bytes(whole[:len(whole) * cut // 100])
        for fault in VDB_FAULTS:
            subprocess.run([options.faulty_vdb, fault, str(folder / f"{fault}.vdb")], check=True)

        (folder / "les.nc").write_bytes(b"CDF\x01" + bytes(100))
        with h5py.File(folder / "bright.h5", "w") as file:
            file["albedo"] = [[0.5, 1.5]]
        for light, name in (("solar", "sun.nc"), ("longwave", "long.nc")):
            write_gas_model(folder / name, light)
        write_bulk_table(folder / "bulk.nc")
        (folder / "albedo.txt").write_text("# wavelength(um) albedo\n0.8 0.1\n0.9 0.3\n")

        scene, output = folder / "scene.toml", folder / "output.h5"
        scene.write_text(SCENE)
        run = ["run", scene, "--quiet", "-o", output]
        subprocess.run([options.cloudbow, *map(str, run)], check=True, stdout=subprocess.DEVNULL)
        output.rename(folder / "gas.h5")

        checker = Checker(options.cloudbow, folder)
        for name, text, words in scenes():
            scene.write_text(text)
            checker.expect_error(name, run, words, output)
        scene.write_text(SCENE)
        checker.expect_error("missing scene", ["run", folder / "none.toml", "-o", output], ["none.toml"], output)
        checker.expect_error("a directory as scene", ["run", folder / "folder", "-o", output], ["folder", "directory"], output)
        checker.expect_error("missing output folder", ["run", scene, "--quiet", "-o", folder / "nowhere/output.h5"], ["nowhere"], output)
        checker.expect_error("a file as output folder", ["run", scene, "--quiet", "-o", cloud / "output.h5"], ["cloud.vdb"], output)
        checker.expect_error("output is a directory", ["run", scene, "--quiet", "-o", folder / "folder"], ["folder"], output)
        checker.expect_error("a cloud as scene", ["run", cloud, "-o", output], ["cloud.vdb", "OpenVDB", "[cloud]"], output)
        checker.expect_error("a result as scene", ["run", folder / "bright.h5", "-o", output], ["bright.h5", "HDF5", "cloud import"], output)
        checker.expect_error("unknown command", ["rn", scene], ["rn", "render", "did you mean run?"], output)
        checker.expect_error("unknown option", [*run, "--thread", "1"], ["--thread", "--checkpoint", "did you mean --threads?"], output)
        checker.expect_error("unknown key set", [*run, "--set", "sun.zenit_deg=3"], ["sun.zenit_deg"], output)
        checker.expect_error("value set out of range", [*run, "--set", "sun.zenith_deg=95"], ["sun.zenith_deg", "95"], output)
        broadband = ["--set", "spectrum.gas_model=sun.nc", "--set", "atmosphere.standard=us-1976", "--set", "atmosphere.h2o=1e-3", "--set", "atmosphere.o3=1e-7", "--set", "sun.irradiance_w_m2=1361"]
        for option in (["--compare"], ["--checkpoint", folder / "state.h5"], ["--resume", folder / "state.h5"], ["--target-error", "1%"], ["--budget", "10s"]):
            checker.expect_error(f"broadband with {option[0]}", [*run, *broadband, *option], ["spectrum.gas_model", option[0], "both", "one of the two"], output)
        checker.expect_error("clear sky of a cloud alone", [*run, "--clear-sky"], ["--clear-sky", "a cloud alone", "spectrum.gas_model"], output)
        checker.expect_error("azimuths of columns that have none", [*run, "--set", "solver.mode=independent-diffuse", "--set", 'output.fields=["radiance_field"]'],
                             ["solver.mode", "independent-diffuse", "radiance_field"], output)
        checker.expect_error("a cone of columns without azimuths", [*run, "--set", "solver.mode=independent-diffuse", "--set", "output.circumsolar_deg=3"],
                             ["solver.mode", "independent-diffuse", "output.circumsolar_deg"], output)
        checker.expect_error("a cone as wide as the sky", [*run, "--set", "output.circumsolar_deg=90"], ["output.circumsolar_deg", "90", "0.05 to 10"], output)
        checker.expect_error("storage that there is not", [*run, "--set", "solver.radiance_storage=float8"], ["solver.radiance_storage", "float8", "float16"], output)
        checker.expect_error("layer that is not there", [*run, "--set", "layer.0.optical_depth=2"], ["layer"], output)
        crashing = Path(__file__).resolve().parents[1] / "data" / "les_that_crashes_hdf5.nc"
        checker.expect_error("import: a file on which HDF5 crashes", ["cloud", "import", crashing, "--quiet", "-o", folder / "output.vdb"],
                             [crashing.name, "damaged"], folder / "output.vdb")
        for name, arguments, words in import_commands(folder):
            checker.expect_error(f"import: {name}", ["cloud", "import", *arguments, "--quiet", "-o", folder / "output.vdb"], words, folder / "output.vdb")
        for option, more in (("-o", []), ("--checkpoint", ["-o", output]), ("--resume", ["-o", output]), ("--set", ["-o", output])):
            checker.expect_error(f"an empty {option}", ["run", scene, "--quiet", *more, option, ""], [option, "empty"], output)
        checker.expect_error("an empty scene", ["run", "", "-o", output], ["scene: empty"], output)
        checker.expect_error("an empty --plot", ["cloud", "info", cloud, "--plot", ""], ["--plot: empty"], output)
        for size, found in (("1e-320", "1e-320"), ("1e-300", "1e-300 m3"), ("1e308", "1e+308")):
            checker.expect_error(f"cloud make: voxels of {size} m", ["cloud", "make", "slab", "--cells", "4", "4", "4", "--voxel-size-m", size, "1", "1", "-o", folder / "output.vdb"],
                                 ["voxel-size-m", found], folder / "output.vdb")
        for factor in ("1", "9", "2.5"):
            checker.expect_error(f"cloud refine: {factor} parts", ["cloud", "refine", cloud, "--factor", factor, "-o", folder / "output.vdb"],
                                 ["--factor", factor, "2 to 8"], folder / "output.vdb")
        checker.expect_error("cloud refine: another grid", ["cloud", "refine", cloud, "--grid", "water", "-o", folder / "output.vdb"], ["cloud.vdb", "water", "density"], folder / "output.vdb")
        checker.expect_error("cloud make: no cell with a cloud",
                             ["cloud", "make", "cumulus", "--cells", "16", "16", "8", "--voxel-size-m", "50", "50", "50", "--cover", "0.001", "-o", folder / "output.vdb"],
                             ["empty", "cover"], folder / "output.vdb")
        checker.expect_error("gas info: a cloud", ["gas", "info", cloud], ["cloud.vdb", "no gas model", "ecCKD"], output)
        checker.expect_error("gas info: no such file", ["gas", "info", folder / "none.nc"], ["none.nc", "no such file"], output)
        checker.expect_error("gas optics: a scene as atmosphere", ["gas", "optics", scene, "--model", cloud, "-o", output], ["scene.toml"], output)
        for name, arguments, words in sweep_commands():
            checker.expect_error(f"sweep: {name}", ["sweep", scene, "--quiet", *arguments, "-o", output], words, output)
        parts = folder / "other.h5.parts"
        parts.write_text("a file of this name")
        checker.expect_error("sweep: a file in place of the folder", ["sweep", scene, "--quiet", "--set", "sun.zenith_deg=0,30", "-o", folder / "other.h5"], [parts.name, "can't be made"], output)
        for name, arguments, words in phase_commands(folder):
            checker.expect_error(f"phase: {name}", ["phase", *arguments, "-o", output], words, output)
        checker.expect_error("phase: file in a missing folder", ["phase", "rayleigh", "-o", folder / "nowhere/output.h5"], ["nowhere"], output)
        checker.expect_error("phase: file in a file", ["phase", "rayleigh", "-o", cloud / "output.h5"], ["cloud.vdb"], output)

        even = ("[[layer]]\nbottom_m = 0\ntop_m = 100\noptical_depth = 1\nsingle_scattering_albedo = 1.0\nphase_function = 'rayleigh'\n[sun]\nzenith_deg = 0\nazimuth_deg = 0\n"
                "[solver]\naccuracy = 'draft'\n[domain]\nvertical_cells = 4\n")
        uneven = even.replace("[sun]", "[[layer]]\nbottom_m = 100\ntop_m = 900\noptical_depth = 1\nsingle_scattering_albedo = 1.0\nphase_function = 'rayleigh'\n[sun]")
        for name, text, more in (("result", SCENE, []), ("even", even, ["--set", 'output.fields=["fluxes"]']), ("layers", uneven, [])):
            scene.write_text(text)
            subprocess.run([options.cloudbow, "run", str(scene), "--quiet", "-o", str(folder / f"{name}.h5"), "--set", 'output.fields=["fluxes","actinic"]', *more], check=True)
        vdb = folder / "output.vdb"
        checker.expect_error("render: a wavelength of no spectrum", ["render", folder / "result.h5", "--wavelength-um", "0.5", "-o", folder / "output.png"],
                             ["result.h5", "--wavelength-um", "spectrum", "0.5"], folder / "output.png")
        for name, arguments, words in (
                ("a section that is none", ["--section", "z=3"], ["section", "z=3", "y=METRES"]),
                ("a section without a number", ["--section", "x=3m"], ["section", "x=3m"]),
                ("a section outside", ["--section", "y=1e6"], ["result.h5", "y = 1000000"]),
                ("a section of a map", ["--section", "y=100", "--field", "optical_depth"], ["result.h5", "optical_depth"]),
                ("a profile of nothing", ["--profile", "--field", "z"], ["result.h5", "no profile", "upwelling_flux"]),
                ("pixels and a width", ["--bare", "--size", "600"], ["bare", "size"]),
                ("a section and a level", ["--section", "y=100", "--level", "bottom"], ["section", "level"]),
                ("a profile and a level", ["--profile", "--level", "nonsense"], ["profile", "level"]),
                ("an outline without extinction", ["--section", "y=100", "--outline", "1e-3"], ["result.h5", "outline", "extinction"]),
                ("an outline of a map", ["--outline", "1e-3"], ["result.h5", "outline", "a section"]),
                ("a profile and colours", ["--profile", "--colormap", "grey"], ["profile", "colormap"]),
                ("a tiny figure", ["--size", "20"], ["--size", "20", "400"]),
                ("min above all", ["--min", "1e9"], ["min", "1e+09"])):
            checker.expect_error(f"render: {name}", ["render", folder / "result.h5", *arguments, "-o", folder / "output.png"], words, folder / "output.png")
        slab = ["cloud", "make", "slab", "--cells", "4", "4", "4", "--voxel-size-m", "9", "9", "9"]
        for name, ending, command, words in (
                ("mie", "toml", ["mie", "--wavelength-um", "0.55", "--effective-radius-um", "1", "-o"], ["the table", ".h5"]),
                ("gas optics", "png", ["gas", "optics", scene, "--model", cloud, "-o"], ["the optics", ".h5"]),
                ("cloud make", "h5", [*slab, "-o"], ["the cloud", ".vdb"]),
                ("cloud import", "nc", ["cloud", "import", folder / "at3d.csv", "-o"], ["the cloud", ".vdb"]),
                ("export", "png", ["export", folder / "result.h5", "--actinic", "--vdb"], ["the grids", ".vdb"]),
                ("run", "vdb", ["run", scene, "-o"], ["the result", ".h5"]),
                ("dry run", "csv", ["run", scene, "--dry-run", "-o"], ["the result", ".h5"]),
                ("checkpoint", "vdb", ["run", scene, "-o", folder / "r.h5", "--checkpoint"], ["the checkpoint", ".ckpt"]),
                ("output.file", "png", ["run", scene, "--set"], ["the result", ".h5"]),
                ("phase", "png", ["phase", "rayleigh", "-o"], ["the file of all figures", ".h5"]),
                ("phase plot", "h5", ["phase", "rayleigh", "--plot"], ["the plot", ".png"]),
                ("tradeoff table", "png", ["tradeoff", scene, "--csv"], ["the table", ".csv"]),
                ("tradeoff plot", "csv", ["tradeoff", scene, "--plot"], ["the plot", ".png"]),
                ("render", "h5", ["render", folder / "result.h5", "-o"], ["the picture", ".png, .svg, .pdf, .exr"])):
            file = folder / f"output.{ending}"
            checker.expect_error(f"ending of another kind: {name}", [*command, f'output.file="{file}"' if name == "output.file" else file], [file.name, f"found .{ending}", *words], file)
        for ending in ("jpg", "eps", "gif"):
            picture = folder / f"output.{ending}"
            checker.expect_error(f"render: {ending}", ["render", folder / "result.h5", "-o", picture], [picture.name, ".png", ".exr"], picture)
            checker.expect_error(f"cloud info: {ending}", ["cloud", "info", cloud, "--plot", picture], [picture.name, ".png"], picture)
        for name, arguments, words in export_commands(folder):
            checker.expect_error(f"export: {name}", ["export", *arguments, "--vdb", vdb], words, vdb)
        done = ["export", folder / "result.h5", "--actinic", "--vdb"]
        checker.expect_error("export: into a missing folder", [*done, folder / "nowhere/output.vdb"], ["nowhere"], vdb)
        checker.expect_error("export: into a file", [*done, cloud / "output.vdb"], ["cloud.vdb"], vdb)
        checker.expect_error("export: into a directory", [*done, folder / "folder"], ["folder", "directory"], vdb)
        checker.expect_error("export: over its own input", [*done, folder / "result.h5"], ["result.h5", "overwrite"], vdb)
    print("\n" + "\n".join(checker.faults or ["every wrong input is told as such"]))
    return 1 if checker.faults else 0


if __name__ == "__main__":
    sys.exit(main())
