#!/usr/bin/env python3
"""Optical depths of the air by g-point, as `cloudbow gas optics` writes them.

Truth: ecCKD's equations (Hogan and Matricardi 2022; docs/theory.md) on the same model files, by this driver's own reader. The air is the AFGL
mid-latitude summer profile. Layers lie between its own heights, and between others. Planck radiances and shares of sunlight are compared too.
Both sides are in double, so they differ by rounding. The limit is 1e-6 of each number, beside 1e-12 of the largest of its g-point.

The models are files of others. CLOUDBOW_REFERENCE_DIR names a folder with gas/*ckd-definition.nc and atmospheres/afglms.txt; skipped without.

usage: CLOUDBOW_REFERENCE_DIR=... gas_models.py --cloudbow PROGRAM
"""
import sys

import netCDF4
import numpy as np

import support

LIMIT = 1e-6
GRAVITY, MOLAR_MASS = 9.80665, 28.970e-3
WELL_MIXED = {"co2": 420e-6, "ch4": 1.9e-6, "n2o": 3.3e-7, "cfc11": 2.2e-10, "cfc12": 5e-10}
HEIGHTS_M = (0, 50, 130, 900, 1000, 2500, 7000, 11500, 12000, 40000, 70500)


class Model:
    """Tables of a definition file, as they are stored."""

    def __init__(self, path):
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            self.names = file.constituent_id.split()
            self.table = {name: np.asarray(variable[...], float) for name, variable in file.variables.items()}

    def of(self, gas, name):
        return self.table[f"{gas}_{name}"]

    def absorption(self, pressure, temperature, fraction):
        """Optical depths [g-point, layer] between pressures [Pa], from either end; fraction: gas to mole fractions by layer."""
        axis = np.log(self.table["pressure"])
        first_kelvin, kelvin_step = self.table["temperature"][0], self.table["temperature"][1, 0] - self.table["temperature"][0, 0]
        rows = []
        for n, kelvin in enumerate(temperature):
            moles = abs(pressure[n + 1] - pressure[n]) / GRAVITY / MOLAR_MASS
            p, of_p = self.index((np.log((pressure[n] + pressure[n + 1]) / 2) - axis[0]) * (len(axis) - 1) / (axis[-1] - axis[0]), len(axis))
            start = first_kelvin[p] + of_p * (first_kelvin[p + 1] - first_kelvin[p])
            t, of_t = self.index((kelvin - start) / kelvin_step, len(self.table["temperature"]))
            depth = 0.0
            for gas in self.names:
                k = self.of(gas, "molar_absorption_coeff")
                corners = k[..., t:t + 2, p:p + 2, :]
                k = np.einsum("t,p,...tpg->...g", [1 - of_t, of_t], [1 - of_p, of_p], corners)
                code = int(self.of(gas, "conc_dependence_code"))
                if code == 0:
                    depth = depth + moles * k
                elif code == 1:
                    depth = depth + moles * fraction[gas][n] * k
                elif code == 3:
                    depth = depth + moles * (fraction[gas][n] - self.of(gas, "reference_mole_fraction")) * k
                else:
                    known = np.log(self.of(gas, "mole_fraction"))
                    place = (np.log(max(fraction[gas][n], 1e-300)) - known[0]) * (len(known) - 1) / (known[-1] - known[0])
                    c, of_c = self.index(place, len(known))
                    depth = depth + moles * fraction[gas][n] * ((1 - of_c) * k[c] + of_c * k[c + 1])
            rows.append(np.maximum(depth, 0))
        return np.array(rows).T

    @staticmethod
    def index(place, count):
        place = min(max(place, 0.0), count - 1.0001)
        return int(place), place - int(place)

    def planck(self, temperature):
        """Radiance [g-point, temperature], within the table."""
        known = self.table["temperature_planck"]
        return np.array([np.interp(temperature, known, column) for column in self.table["planck_function"].T]) / np.pi


class Profile:
    """The AFGL profile by columns z [km], p [mb], T [K], air, o3, o2, h2o, co2, no2 [cm-3]; heights ascend here."""

    def __init__(self, path):
        rows = np.loadtxt(path)[::-1]
        self.height, self.pressure, self.temperature = 1000 * rows[:, 0], 100 * rows[:, 1], rows[:, 2]
        self.fraction = {"o3": rows[:, 4] / rows[:, 3], "h2o": rows[:, 6] / rows[:, 3]}

    def layers(self, edges):
        """Pressure at the edges, temperature of the layers, mole fractions of the layers."""
        pressure = np.exp(np.interp(edges, self.height, np.log(self.pressure)))
        at_edge = np.interp(edges, self.height, self.temperature)
        temperature = (at_edge[1:] * pressure[1:] + at_edge[:-1] * pressure[:-1]) / (pressure[1:] + pressure[:-1])
        middle = np.interp(-np.log((pressure[1:] + pressure[:-1]) / 2), -np.log(self.pressure), self.height)
        fraction = {gas: np.interp(middle, self.height, column) for gas, column in self.fraction.items()}
        fraction.update({gas: np.full(len(middle), value) for gas, value in WELL_MIXED.items()})
        return pressure, at_edge, temperature, fraction


def largest_difference(found, expected):
    scale = np.maximum(np.abs(expected), 1e-6 * np.abs(expected).max(axis=-1, keepdims=True))
    return float(np.max(np.abs(found - expected) / np.where(scale > 0, scale, 1)))


def compare(cloudbow, model_file, profile_file, heights, output):
    gases = [word for gas, value in WELL_MIXED.items() for word in ("--mole-fraction", f"{gas}={value!r}")]
    levels = ["--heights-m", *heights] if heights else []
    cloudbow.call("gas", "optics", profile_file, "--model", model_file, *gases, *levels, "-o", output, "--quiet")
    with netCDF4.Dataset(output) as file:
        file.set_auto_mask(False)
        found = {name: np.asarray(variable[...], float) for name, variable in file.variables.items()}
    model, profile = Model(model_file), Profile(profile_file)
    edges = np.array(heights, float) if heights else profile.height
    pressure, at_edge, temperature, fraction = profile.layers(edges)
    differences = {"absorption": largest_difference(found["absorption_optical_depth"], model.absorption(pressure, temperature, fraction))}
    if "solar_irradiance" in model.table:
        moles = np.abs(np.diff(pressure)) / GRAVITY / MOLAR_MASS
        differences["Rayleigh"] = largest_difference(found["rayleigh_optical_depth"], np.outer(model.table["rayleigh_molar_scattering_coeff"], moles))
        differences["share"] = largest_difference(found["solar_share"], model.table["solar_irradiance"] / model.table["solar_irradiance"].sum())
    else:
        within = (at_edge >= model.table["temperature_planck"][0]) & (at_edge <= model.table["temperature_planck"][-1])
        differences["Planck"] = largest_difference(found["planck_radiance"][:, within], model.planck(at_edge[within]))
    return len(temperature), differences


def main():
    options = support.argument_parser(__doc__.splitlines()[0]).parse_args()
    folder = support.reference_folder()
    if folder is None:
        support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with gas/ and atmospheres/")
    models = sorted((folder / "gas").glob("*ckd-definition.nc"))
    profile = folder / "atmospheres" / "afglms.txt"
    if not models or not profile.exists():
        support.skip(f"{folder} has no gas/*ckd-definition.nc, or no atmospheres/afglms.txt")
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    rows, bad = [], []
    with support.Workspace(options.keep) as work:
        for model in models:
            for heights in ((), HEIGHTS_M):
                layers, differences = compare(cloudbow, model, profile, heights, work / "optics.h5")
                rows += [[model.name, layers, name, f"{value:.1e}"] for name, value in differences.items()]
                bad += [f"{model.name}, {layers} layers: {name} off by {value:.1e}" for name, value in differences.items() if not value <= LIMIT]
    print(support.markdown_table(["model", "layers", "quantity", "largest difference, relative"], rows))
    print("\n".join(bad))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
