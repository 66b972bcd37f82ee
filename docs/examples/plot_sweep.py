#!/usr/bin/env python3
"""Fluxes of a sweep over the sun's zenith angle, in three dimensions and, if they are there, as independent columns.

usage: plot_sweep.py SWEEP.h5 PICTURE

The sweep must be over sun.zenith_deg. With --compare the fluxes of independent columns are drawn too.
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
    try:
        columns = xr.open_dataset(file, group="independent_columns")
    except OSError:  # a sweep without --compare
        columns = None

    def reflected(fluxes):
        return fluxes.upwelling_flux.isel(z_edge=-1) / ledger.incident

    def transmitted(fluxes):
        return (fluxes.downwelling_diffuse_flux + fluxes.direct_flux).isel(z_edge=0) / ledger.incident

    panels = 1 if columns is None else 2
    figure, axes = plt.subplots(1, panels, figsize=(4.5 * panels, 3.6), layout="constrained", squeeze=False)
    left, right = axes[0, 0], axes[0, -1]
    for flux, name, colour in ((reflected, "reflected at the top", "tab:blue"), (transmitted, "arriving at the ground", "tab:orange")):
        flux(three).plot(ax=left, color=colour, marker="o", label=name)
        if columns is not None:
            flux(columns).plot(ax=left, color=colour, linestyle="--")
            (100 * (flux(three) - flux(columns))).plot(ax=right, color=colour, marker="o")
    if columns is not None:
        left.plot([], [], color="grey", linestyle="--", label="independent columns")
        right.set(title="", ylabel="3D minus columns (% of the incident light)", xlabel="solar zenith angle (degrees)")
        right.axhline(0, color="grey", linewidth=0.8)
    left.set(title="", ylabel="fraction of the incident light", xlabel="solar zenith angle (degrees)")
    left.legend()
    figure.savefig(picture, dpi=120)


if __name__ == "__main__":
    main()
