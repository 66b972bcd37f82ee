"""Small gas models in the layout of ecCKD, and a table of bulk optics in that of ecRad, all made up."""
import netCDF4
import numpy as np

PRESSURES, TEMPERATURES, POINTS = 3, 3, 2
GASES = {"composite": 0, "h2o": 1, "o3": 1}  # name and how optical depth depends on the mole fraction


def write_gas_model(path, light):
    """@param light "solar" or "longwave": two g-points of 600 to 900 cm-1, or of 10000 to 14000."""
    with netCDF4.Dataset(path, "w") as file:
        for name, length in (("pressure", PRESSURES), ("temperature", TEMPERATURES), ("g_point", POINTS), ("wavenumber", 2), ("temperature_planck", 3)):
            file.createDimension(name, length)

        def variable(name, dimensions, values):
            file.createVariable(name, "f8", dimensions)[...] = values

        file.constituent_id = " ".join(GASES)
        variable("pressure", ("pressure",), [1e3, 1e4, 1e5])
        kelvin = 200.0 + 20 * np.arange(TEMPERATURES)[:, None] + 10 * np.arange(PRESSURES)[None, :]
        variable("temperature", ("temperature", "pressure"), kelvin)
        for name, code in GASES.items():
            variable(f"{name}_conc_dependence_code", (), code)
            scale = {"composite": 1e-7, "h2o": 1e-4, "o3": 1e-2}[name]
            variable(f"{name}_molar_absorption_coeff", ("temperature", "pressure", "g_point"), scale * np.ones((TEMPERATURES, PRESSURES, 1)) * [1.0, 2.0])
        edges = [600.0, 700.0, 900.0] if light == "longwave" else [10000.0, 12000.0, 14000.0]
        variable("wavenumber1", ("wavenumber",), edges[:2])
        variable("wavenumber2", ("wavenumber",), edges[1:])
        variable("gpoint_fraction", ("g_point", "wavenumber"), [[0.25, 0.75], [0.5, 0.5]])
        if light == "solar":
            variable("solar_irradiance", ("g_point",), [30.0, 10.0])
            variable("solar_spectral_irradiance", ("wavenumber",), [15.0, 25.0])
            variable("rayleigh_molar_scattering_coeff", ("g_point",), [1e-7, 2e-7])
        else:
            variable("temperature_planck", ("temperature_planck",), [200.0, 250.0, 300.0])
            variable("planck_function", ("temperature_planck", "g_point"), [[8, 13], [18, 32], [34, 62]])


def write_bulk_table(path):
    """Droplets of 4 to 20 um, from 1 to 30000 cm-1."""
    with netCDF4.Dataset(path, "w") as file:
        wavenumber, radius = [1.0, 1000.0, 5000.0, 30000.0], [4.0, 10.0, 20.0]
        for name, values, units in (("wavenumber", wavenumber, "cm-1"), ("effective_radius", radius, "m")):
            file.createDimension(name, len(values))
            file.createVariable(name, "f8", (name,))[:] = np.array(values) * (1e-6 if units == "m" else 1)
            file[name].units = units
        extinction = 1500 / np.array(radius)[:, None] * np.ones(len(wavenumber))
        for name, values, units in (("mass_extinction_coefficient", extinction, "m2 kg-1"), ("single_scattering_albedo", 0.9, "1"), ("asymmetry_factor", 0.85, "1")):
            file.createVariable(name, "f8", ("effective_radius", "wavenumber"))[:] = values
            file[name].units = units
