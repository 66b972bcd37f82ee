#!/usr/bin/env python3
"""Fluxes of a sweep over the sun's zenith angle, in three dimensions and as independent columns.

usage: plot_sweep.py SWEEP.h5 PICTURE

The sweep must be over sun.zenith_deg, with --compare.
"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import xarray as xr


def main():
    file, picture = sys.argv[1:]
    ledger = xr.open_dataset(file, group="ledger")
    three = xr.open_dataset(file, group="profile")  # means over the domain (zenith_deg, z_edge)
    columns = xr.open_dataset(file, group="independent_columns")

    def reflected(fluxes):
        return fluxes.upwelling_flux.isel(z_edge=-1) / ledger.incident

    def transmitted(fluxes):
        return (fluxes.downwelling_diffuse_flux + fluxes.direct_flux).isel(z_edge=0) / ledger.incident

    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for flux, name, colour in ((reflected, "reflected at the top", "tab:blue"), (transmitted, "arriving at the ground", "tab:orange")):
        flux(three).plot(ax=left, color=colour, marker="o", label=name)
        flux(columns).plot(ax=left, color=colour, linestyle="--")
        (100 * (flux(three) - flux(columns))).plot(ax=right, color=colour, marker="o")
    left.plot([], [], color="grey", linestyle="--", label="independent columns")
    left.set(title="", ylabel="fraction of the incident light", xlabel="solar zenith angle (degrees)")
    right.set(title="", ylabel="3D minus columns (% of the incident light)", xlabel="solar zenith angle (degrees)")
    right.axhline(0, color="grey", linewidth=0.8)
    left.legend()
    figure.savefig(picture, dpi=120)


if __name__ == "__main__":
    main()
