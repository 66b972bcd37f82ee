#!/usr/bin/env python3
"""Writes a small cloud field as large-eddy simulations do: netCDF, cloud water per kg of dry air, stretched levels.

The field is made up (a few adiabatic cumuli over 1.2 km), the layout is that of real output: QC(time, z, y, x) in g/kg, RHO(z), NC in 1/cm3. Levels are 20 m near the ground and grow to 60 m. docs/from-les-to-fluxes.md goes on from here.

usage: make_les_file.py FILE.nc [--format NETCDF3_CLASSIC|NETCDF4] [--columns 32]
"""
import argparse

import netCDF4
import numpy as np


def levels():
    """Centres and edges [m]: 20 m up to 400 m, then each level 3 % thicker, at most 60 m, up to about 2 km."""
    thickness = [20.0] * 20
    while sum(thickness) < 2000:
        thickness.append(min(60.0, thickness[-1] * 1.03))
    edge = np.concatenate([[0.0], np.cumsum(thickness)])
    return 0.5 * (edge[1:] + edge[:-1]), edge


def cloud_water(x, y, z, seed):
    """g/kg: parcels that condense 1.3 g/kg per km above a base at 500 m, diluted towards the edges of each cloud."""
    rng = np.random.default_rng(seed)
    width = x[-1] + x[0]
    water = np.zeros((len(z), len(y), len(x)))
    for _ in range(6):
        cx, cy = rng.uniform(0, width, 2)
        radius = rng.uniform(100, 260)
        top = 500 + 2.5 * radius
        dx = (x - cx + width / 2) % width - width / 2
        dy = (y - cy + width / 2) % width - width / 2
        distance = np.hypot(dx[None, :], dy[:, None]) / radius
        height = (z - 500) / (top - 500)
        shape = np.clip(1 - (distance / (1.05 - 0.5 * np.clip(height, 0, 1)[:, None, None] ** 2)) ** 2, 0, 1)
        inside = (height > 0) & (height < 1)
        cloud = np.where(inside[:, None, None], 1.3e-3 * np.clip(z - 500, 0, None)[:, None, None] * shape, 0)
        water = np.maximum(water, cloud)
    return water


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--format", default="NETCDF4", choices=["NETCDF3_CLASSIC", "NETCDF4"])
    parser.add_argument("--columns", type=int, default=32)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()

    spacing = 40.0
    x = (np.arange(options.columns) + 0.5) * spacing
    z, _ = levels()
    with netCDF4.Dataset(options.file, "w", format=options.format) as file:
        file.title = "made-up cumulus in the layout of LES output"
        file.createDimension("time", None)
        for name, values in (("z", z), ("y", x), ("x", x)):
            file.createDimension(name, len(values))
            axis = file.createVariable(name, "f8", (name,))
            axis.units = "m"
            axis[:] = values
        time = file.createVariable("time", "f8", ("time",))
        time.units = "s"
        density = file.createVariable("RHO", "f4", ("z",))
        density.units = "kg/m3"
        density[:] = 1.18 * np.exp(-z / 8500)
        water = file.createVariable("QC", "f4", ("time", "z", "y", "x"))
        water.units = "g/kg"
        number = file.createVariable("NC", "f4", ("time", "z", "y", "x"))
        number.units = "cm-3"
        for step in range(2):
            time[step] = 600.0 * step
            field = cloud_water(x, x, z, options.seed + step)
            water[step] = field
            number[step] = np.where(field > 0, 70.0, 0.0)


if __name__ == "__main__":
    main()
