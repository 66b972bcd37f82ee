#!/usr/bin/env python3
"""Seconds and memory of `cloudbow cloud import` on a field of an LES, made here: by default 512 x 512 x 200 cells, 5 % of them cloudy.

Layouts: `profile`, water with a density by height; `fields`, water with pressure and potential temperature in all cells (as CM1 writes them), and
with ice; `terrain`, the same with heights that differ from column to column. Goal: 20 s and 2 GB.

usage: les_import.py --cloudbow PROGRAM [--cells NX NY NZ] [--layout NAME] [--compress] [--keep FOLDER]
"""
import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import netCDF4
import numpy as np

COVER = 0.05
LAYOUTS = ("profile", "fields", "terrain")


def cloudy(random, nx, ny, z):
    """One level of water [kg/kg]: smooth noise above a threshold that leaves the wanted share of cells."""
    if not 400 < z < 3000:
        return np.zeros((ny, nx), "f4")
    share = COVER * 4000 / 2600
    noise = np.kron(random.random((ny // 8 + 1, nx // 8 + 1)), np.ones((8, 8)))[:ny, :nx] + 0.2 * random.random((ny, nx))
    threshold = np.quantile(noise, 1 - share)
    return (1e-3 * np.clip(noise - threshold, 0, None)).astype("f4")


def make(path, layout, cells, compress):
    nx, ny, nz = cells
    random = np.random.default_rng(1)
    edges = 4000 / nz * np.arange(nz + 1)
    centres = 0.5 * (edges[1:] + edges[:-1])
    pressure = 101325 * (1 - 0.0065 * centres / 288.15) ** 5.2559
    temperature = 288.15 - 0.0065 * centres
    with netCDF4.Dataset(path, "w") as file:
        for name, length in (("time", 1), ("z", nz), ("y", ny), ("x", nx), ("zi", nz + 1)):
            file.createDimension(name, length)

        def add(name, dimensions, units):
            variable = file.createVariable(name, "f4", dimensions, compression="zlib" if compress else None, complevel=1)
            variable.units = units
            return variable

        whole = ("time", "z", "y", "x")
        add("x", ("x",), "m")[:] = 50 * (np.arange(nx) + 0.5)
        add("y", ("y",), "m")[:] = 50 * (np.arange(ny) + 0.5)
        if layout != "terrain":
            add("z", ("z",), "m")[:] = centres
        # At once: the library packs a chunk again for each part that is written.
        water = np.stack([cloudy(random, nx, ny, z) for z in centres])
        add("qc", whole, "kg/kg")[0] = water
        if layout == "profile":
            add("rho", ("z",), "kg/m3")[:] = pressure / (287.05 * temperature)
            return
        noise = random.random((ny, nx)).astype("f4")
        add("prs", whole, "Pa")[0] = pressure.astype("f4")[:, None, None] + noise
        add("th", whole, "K")[0] = (temperature * (1e5 / pressure) ** (2 / 7)).astype("f4")[:, None, None] + noise
        add("qi", whole, "kg/kg")[0] = 0.1 * np.where(centres[:, None, None] > 2000, water, 0)
        if layout == "terrain":
            heights = add("z_ifc", ("zi", "y", "x"), "m")
            hill = 200 * np.sin(np.pi * np.arange(nx) / nx)[None] * np.sin(np.pi * np.arange(ny) / ny)[:, None]
            for k in range(nz + 1):
                heights[k] = edges[k] + hill * (1 - edges[k] / edges[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True, type=Path)
    parser.add_argument("--cells", nargs=3, type=int, default=(512, 512, 200), metavar="N")
    parser.add_argument("--layout", choices=LAYOUTS, help="default: all")
    parser.add_argument("--compress", action="store_true", help="deflate the variables")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="leave the files here, and use those that are there")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        for layout in [options.layout] if options.layout else LAYOUTS:
            path = folder / f"{layout}{'_deflated' if options.compress else ''}.nc"
            if not path.exists():
                make(path, layout, options.cells, options.compress)
            extra = [] if layout == "profile" else ["--species", "liquid,ice"]
            before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
            done = subprocess.run(["/usr/bin/time", "-f", "%M", options.cloudbow, "cloud", "import", path, *extra, "-o", folder / "cloud.vdb"],
                                  capture_output=True, text=True)
            seconds = time.monotonic() - begin
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            if done.returncode:
                print(f"{layout}: {done.stderr}")
                return 1
            cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            voxels = next(line for line in done.stdout.splitlines() if "active voxels" in line).split()[2]
            print(f"{layout:8} {path.stat().st_size / 1e6:7.0f} MB read  {seconds:6.1f} s  {cpu:6.1f} CPU s  "
                  f"{int(done.stderr.split()[-1]) / 1e6:5.2f} GB  {voxels} voxels", flush=True)
            if not options.keep:
                path.unlink()
    return 0


if __name__ == "__main__":
    sys.exit(main())
