"""Opens the sample results as users do. Usage: read_samples.py netcdf4|h5netcdf|h5py|ncdump|h5dump FOLDER. Exit code 77: reader not there."""

import importlib
import pathlib
import shutil
import subprocess
import sys


def skip(what):
    print(f"skipped: {what} is not installed")
    sys.exit(77)


def require(*modules):
    for module in modules:
        try:
            importlib.import_module(module)
        except ImportError:
            skip(f"the Python module {module}")


def field_value(variable, k, j, i):
    return 1000 * variable + 100 * k + 10 * j + i / 16


def z_edge(nz):
    return [500 + 5 * (k + 1) * (k + 2) for k in range(nz + 1)]


FLUXES = {
    "upwelling_flux": "upwelling_shortwave_flux_in_air",
    "downwelling_diffuse_flux": "diffuse_downwelling_shortwave_flux_in_air",
    "direct_flux": "direct_downwelling_shortwave_flux_in_air",
}


def check_coordinates(dataset, nx, ny, nz):
    import numpy as np

    edge = np.array(z_edge(nz))
    np.testing.assert_array_equal(dataset.x, 112.5 + 25 * np.arange(nx))
    np.testing.assert_array_equal(dataset.y, -25.0 + 50 * np.arange(ny))
    np.testing.assert_array_equal(dataset.z, (edge[1:] + edge[:-1]) / 2)
    np.testing.assert_array_equal(dataset.z_edge, edge)
    for name in ("x", "y", "z", "z_edge"):
        assert dataset[name].dtype == "float64", name
        assert dataset[name].attrs["units"] == "m", name
        assert dataset[name].attrs["long_name"], name
        assert "_FillValue" not in dataset[name].encoding, name


def check_xarray(folder, engine):
    require("xarray", {"netcdf4": "netCDF4"}.get(engine, engine))
    import numpy as np
    import xarray

    with xarray.open_dataset(folder / "full.h5", engine=engine) as full:
        print(full)
        check_coordinates(full, 64, 48, 8)
        assert full.attrs["Conventions"] == "CF-1.10"
        assert full.attrs["title"] == "Wolken über Köln"
        assert full.attrs["scene"] == "[sun]\nzenith_deg = 60.0\n"
        assert set(full.data_vars) == set(FLUXES) | {"absorbed_power", "actinic_flux", "z_bounds"}
        for variable, (name, standard_name) in enumerate(FLUXES.items(), start=1):
            flux = full[name]
            assert flux.dims == ("z_edge", "y", "x") and flux.shape == (9, 48, 64) and flux.dtype == "float32"
            assert flux.attrs["units"] == "W m-2" and flux.attrs["standard_name"] == standard_name and flux.attrs["long_name"]
            assert np.isnan(flux.encoding["_FillValue"])
            assert flux[7, 45, 61] == field_value(variable, 7, 45, 61)
            assert flux.sel(z_edge=530, y=75, x=162.5) == field_value(variable, 1, 2, 2)
        assert full.absorbed_power.dims == ("z", "y", "x") and full.absorbed_power.attrs["units"] == "W m-3"
        assert full.actinic_flux.dims == ("z", "y", "x") and full.actinic_flux.attrs["units"] == "W m-2"
        assert int(full.actinic_flux.isnull().sum()) == 1 and np.isnan(full.actinic_flux[0, 0, 0])

    with xarray.open_dataset(folder / "full.h5", engine=engine, group="profile") as profile:
        print(profile)
        np.testing.assert_array_equal(profile.z_edge, z_edge(8))
        assert profile.z_edge.attrs["units"] == "m"
        for variable, (name, standard_name) in enumerate(FLUXES.items(), start=1):
            assert profile[name].dims == ("z_edge",) and profile[name].attrs["standard_name"] == standard_name
            assert profile[name].attrs["units"] == "W m-2" and profile[name].dtype == "float64"
            np.testing.assert_array_equal(profile[name], variable + 0.125 * np.arange(9))

    with xarray.open_dataset(folder / "full.h5", engine=engine, group="summary") as summary:
        assert summary.attrs["reflectance"] == 0.5 and summary.attrs["energy_residual"] == 1e-7
    with xarray.open_dataset(folder / "full.h5", engine=engine, group="solver") as solver:
        print(solver)
        assert solver.attrs["converged"] == 1 and solver.attrs["sweeps"] == 17 and solver.attrs["mode"] == "3d"
        assert solver.attrs["active_voxels"] == 5_000_000_000 and solver.attrs["peak_memory_bytes"] == 6_000_000_000

    with xarray.open_dataset(folder / "full.h5", engine=engine, group="radiance_field") as field:
        print(field)
        assert field.radiance.dims == ("active_voxel", "control_point") and field.radiance.attrs["units"] == "W m-2 sr-1"
        np.testing.assert_array_equal(field.radiance, [[0, 1, 2], [10, 11, 12]])
        np.testing.assert_array_equal(field.triangle, [[0, 1, 2]])
        np.testing.assert_array_equal(field.voxel, [[1, 2, 3], [4, 5, 6]])
        np.testing.assert_array_equal(field.direction, [[0, 0, -1], [1, 0, 0], [0, 0.6, 0.8]])
        assert not field.coords

    with xarray.open_dataset(folder / "boundaries.h5", engine=engine) as boundaries:
        print(boundaries)
        assert set(boundaries.data_vars) == set(FLUXES) | {"z_bounds"}
        assert boundaries.upwelling_flux.dims == ("z_flux", "y", "x")
        np.testing.assert_array_equal(boundaries.z_flux, [z_edge(3)[0], z_edge(3)[3]])
        assert boundaries.z_flux.attrs["units"] == "m"
        assert boundaries.direct_flux[1, 3, 4] == field_value(3, 3, 3, 4)
        check_coordinates(boundaries, 5, 4, 3)
        assert boundaries.attrs["title"] == "" and boundaries.attrs["scene"] == "#" * 100_000
    with xarray.open_dataset(folder / "boundaries.h5", engine=engine, group="radiance_field") as field:
        assert field.radiance.shape == (0, 3)
    with xarray.open_dataset(folder / "column.h5", engine=engine) as column:
        check_coordinates(column, 1, 1, 3)
        assert column.upwelling_flux.shape == (4, 1, 1)
        assert column.circumsolar_flux.attrs["units"] == "W m-2" and column.circumsolar_flux.attrs["half_angle_deg"] == 2.5
        np.testing.assert_array_equal(column.circumsolar_flux[:, 0, 0], [field_value(6, k, 0, 0) for k in range(4)])
        assert column.direct_normal_flux.dims == ("z_edge", "y", "x") and column.direct_normal_flux.attrs["long_name"]
        np.testing.assert_allclose(column.direct_normal_flux, column.direct_flux / 0.8, rtol=1e-7)
    with xarray.open_dataset(folder / "spectrum.h5", engine=engine) as spectrum:
        check_coordinates(spectrum, 4, 3, 2)
        assert spectrum.upwelling_flux.dims == ("wavelength", "z_edge", "y", "x")
        assert spectrum.absorbed_power.sel(wavelength=0.55, y=75, x=162.5)[1] == field_value(4, 1, 2, 2)
        assert spectrum.wavelength.attrs["units"] == "um"
    with xarray.open_dataset(folder / "spectrum.h5", engine=engine, group="profile") as profile:
        assert profile.direct_flux.sel(wavelength=0.67, method="nearest").shape == (3,)
    with xarray.open_dataset(folder / "spectrum.h5", engine=engine, group="summary") as summary:
        np.testing.assert_array_equal(summary.attrs["reflectance"], [0.5, 0.5])


def check_h5py(folder):
    require("h5py")
    import h5py

    with h5py.File(folder / "full.h5") as full:
        flux = full["upwelling_flux"]
        assert [dimension[0].name for dimension in flux.dims] == ["/z_edge", "/y", "/x"]
        assert flux.compression == "gzip" and flux.compression_opts == 1 and flux.shuffle
        assert flux[7, 45, 61] == field_value(1, 7, 45, 61)
        assert full["summary"].attrs["reflectance"] == 0.5
        assert full.attrs["title"].decode() == "Wolken über Köln"
    with h5py.File(folder / "column.h5") as column:
        assert column["upwelling_flux"].compression is None
    check_queries(folder)


def check_queries(folder):
    """The example that users copy against the library's own interpolation; both work in double on the same float32 radiances."""
    sys.path.insert(0, str(pathlib.Path(__file__).parents[3] / "docs/examples"))
    import h5py
    import numpy as np
    import query_radiance

    queries = np.loadtxt(folder / "sphere_queries.txt")
    with h5py.File(folder / "sphere.h5") as result:
        for query in queries:
            radiance = query_radiance.query(result["radiance_field"], 3 * query[:3])
            np.testing.assert_allclose(radiance, query[3:], rtol=1e-12)
        direction = result["radiance_field/direction"][...]
        for point, travel in enumerate(direction):  # a corner of five or six triangles: whichever is taken has its value
            np.testing.assert_allclose(query_radiance.query(result["radiance_field"], travel), result["radiance_field/radiance"][:, point], rtol=1e-7)
    print(f"{len(queries)} directions and {len(direction)} control points agree")


def check_command(folder, *command):
    if shutil.which(command[0]) is None:
        skip(command[0])
    for file in sorted(folder.glob("*.h5")):
        done = subprocess.run([*command, str(file)], capture_output=True, text=True)
        print(done.stdout)
        assert done.returncode == 0 and not done.stderr, f"{file}: {done.stderr}"
        assert "upwelling_flux" in done.stdout
        if command[0] == "ncdump":
            assert 'units = "W m-2"' in done.stdout and "z_edge = " in done.stdout


def main():
    reader, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    if reader == "h5py":
        check_h5py(folder)
    elif reader == "ncdump":
        check_command(folder, "ncdump", "-h")
    elif reader == "h5dump":
        check_command(folder, "h5dump", "-H")
    else:
        check_xarray(folder, reader)


main()
