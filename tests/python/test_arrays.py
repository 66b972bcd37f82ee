"""Arrays in place of grids and maps: the same bits as files with the same values, and errors that name the key.

Truth: VDB and netCDF files with these values, run by path.
"""
import copy

import cloudbow as cb
import numpy as np
import pytest
import xarray as xr
from conftest import assert_same_results, extinction


@pytest.fixture
def vdb(cloud, tmp_path):
    """The result of the same scene with a file."""
    cb.write_vdb(tmp_path / "cloud.vdb", cloud["cloud"]["file"])
    scene = copy.deepcopy(cloud)
    scene["cloud"]["file"] = str(tmp_path / "cloud.vdb")
    return cb.run(scene)


def kilometres(array):
    return array.assign_coords({axis: (axis, array[axis].values / 1000, {"units": "km"}) for axis in "xyz"})


@pytest.mark.parametrize("change", [
    lambda a: a, lambda a: a.transpose("x", "y", "z"), lambda a: a.isel(z=slice(None, None, -1), x=slice(None, None, -1)), kilometres,
    lambda a: a.astype(np.float32), lambda a: a.rename("extinction"), lambda a: a.to_dataset(name="density"),
    lambda a: a.assign_coords(x=("x", a.x.values.astype(np.float32), {"units": "m"}))])
def test_array_is_the_file(cloud, vdb, change):
    cloud["cloud"]["file"] = change(cloud["cloud"]["file"])
    assert_same_results(cb.run(cloud), vdb)


def test_units_are_obeyed(cloud, vdb):
    """Powers of 2 times 1000 would round; 1/km of numbers that are exact in both."""
    array = cloud["cloud"]["file"].copy(data=np.round(cloud["cloud"]["file"].values * 1024) / 1024)
    one = cb.run(dict(cloud, cloud=dict(cloud["cloud"], file=array)))
    per_km = (array * 1000).assign_attrs(units="km-1")
    two = cb.run(dict(cloud, cloud=dict(cloud["cloud"], file=per_km)))
    np.testing.assert_allclose(one.upwelling_flux, two.upwelling_flux, rtol=1e-6)
    del cloud["cloud"]["quantity"]
    assert_same_results(cb.run(cloud), vdb)


def test_numpy_fills_the_domain(cloud, vdb):
    cloud["cloud"]["file"] = cloud["cloud"]["file"].values
    cloud["domain"] = {"min_m": [0.0, 0.0, 500.0], "max_m": [800.0, 600.0, 750.0]}
    assert_same_results(cb.run(cloud), vdb)


def test_numpy_with_a_voxel_size(cloud, tmp_path):
    array = cloud["cloud"]["file"]
    cloud["cloud"].update(file=array.values, voxel_size_m=[100.0, 100.0, 50.0])
    one = cb.run(cloud)
    shifted = array.assign_coords(z=("z", array.z.values - 500, {"units": "m"}))
    del cloud["cloud"]["voxel_size_m"]
    cloud["cloud"]["file"] = shifted
    assert_same_results(one, cb.run(cloud))


def test_effective_radius_and_water(cloud, tmp_path):
    water = (cloud["cloud"]["file"] * 20).assign_attrs(units="g m-3", quantity="liquid_water_content")
    radius = water.copy(data=np.where(water > 0, 5 + 100 * water.values, np.nan)).assign_attrs(units="um", quantity="effective_radius")
    cloud["cloud"].update(file=water, quantity="liquid_water_content", effective_radius_grid=radius)
    arrays = cb.run(cloud)
    cloud["cloud"]["effective_radius_grid"] = radius.values
    assert_same_results(cb.run(cloud), arrays)
    cb.write_vdb(tmp_path / "a.vdb", xr.Dataset({"density": water, "reff": radius}))
    cloud["cloud"].update(file=str(tmp_path / "a.vdb"), effective_radius_grid="reff")
    assert_same_results(cb.run(cloud), arrays)
    cloud["cloud"].update(file=xr.Dataset({"density": water, "reff": radius}))
    assert_same_results(cb.run(cloud), arrays)


@pytest.mark.parametrize("order", [("z", "y", "x"), ("x", "z", "y")])
def test_arrays_beside_have_the_order_of_the_cloud(cloud, order):
    """Droplets grow with height; the cloud descends, and arrays without coordinates follow it."""
    water = (cloud["cloud"]["file"] * 20).assign_attrs(units="g m-3").isel(z=slice(None, None, -1)).transpose(*order)
    radius = (water * 0 + 5 + water.z / 100).transpose(*order).assign_attrs(units="um")
    cloud["cloud"].update(file=water, quantity="liquid_water_content", effective_radius_grid=radius)
    labelled = cb.run(cloud)
    for beside in (radius.values, radius.drop_vars(["x", "y", "z"])):
        cloud["cloud"]["effective_radius_grid"] = beside
        assert_same_results(cb.run(cloud), labelled)
    cloud["cloud"]["effective_radius_grid"] = radius.isel(z=slice(None, None, -1)).values
    assert not np.array_equal(cb.run(cloud).upwelling_flux, labelled.upwelling_flux)


@pytest.mark.parametrize("named", [True, False])
def test_albedo_map(cloud, tmp_path, named):
    values = np.linspace(0, 1, 48).reshape(6, 8)
    array = xr.DataArray(values, dims=("y", "x"), name="albedo")
    array.to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    cloud["surface"] = {"albedo_map": str(tmp_path / "map.nc")}
    file = cb.run(cloud)
    cloud["surface"] = {"albedo_map": array if named else values}
    assert_same_results(cb.run(cloud), file)
    cloud["surface"] = {"albedo": 0.2}
    assert not np.array_equal(cb.run(cloud).upwelling_flux, file.upwelling_flux)


def test_temperatures(cloud, tmp_path):
    """Of voxels and of the ground, in a scene that emits."""
    array = cloud["cloud"]["file"]
    warm = (array * 0 + 290 - array.z / 150).assign_attrs(units="K", quantity="temperature")
    ground = np.linspace(285, 295, 48).reshape(6, 8)
    del cloud["sun"], cloud["surface"]["albedo"]
    cloud.update(thermal={"wavelength_um": 10.8}, atmosphere={"standard": "us-1976"})
    cloud["cloud"]["temperature_grid"], cloud["surface"]["temperature_map"] = warm, ground
    arrays = cb.run(cloud)
    cb.write_vdb(tmp_path / "a.vdb", xr.Dataset({"density": array, "warm": warm}))
    xr.DataArray(ground, dims=("y", "x"), name="temperature", attrs={"units": "K"}).to_netcdf(tmp_path / "ground.nc", engine="h5netcdf")
    cloud["cloud"].update(file=str(tmp_path / "a.vdb"), temperature_grid="warm")
    cloud["surface"]["temperature_map"] = str(tmp_path / "ground.nc")
    files = cb.run(cloud)
    for ds in (arrays, files):  # names of files and grids
        for name in ("surface_temperature_map", "cloud_temperature_grid"):
            ds.cloudbow.groups["/thermal"].attrs.pop(name)
    assert_same_results(arrays, files)


def test_numbers_of_phase_functions(cloud, tmp_path):
    """The second function alone is another scene than the first alone."""
    (tmp_path / "set.txt").write_text("0, 1, 1\n1, 0.1, 0.3\n")
    cloud["phase_function"]["droplets"] = {"type": "set", "file": str(tmp_path / "set.txt"), "index_grid": np.full((5, 6, 8), 2)}
    array = cloud["cloud"]["file"]
    two = cb.run(cloud)
    cb.write_vdb(tmp_path / "a.vdb", xr.Dataset({"density": array, "n": (array * 0 + 2).assign_attrs(units="1", quantity="phase_index")}))
    cloud["cloud"]["file"] = str(tmp_path / "a.vdb")
    cloud["phase_function"]["droplets"]["index_grid"] = "n"
    assert_same_results(cb.run(cloud), two)
    cloud["cloud"]["file"] = array
    cloud["phase_function"]["droplets"]["index_grid"] = np.ones((5, 6, 8))
    assert not np.array_equal(cb.run(cloud).upwelling_flux, two.upwelling_flux)


def test_array_as_a_setting_of_a_file(cloud, vdb, tmp_path):
    from cloudbow import _toml
    array = cloud["cloud"].pop("file")
    (tmp_path / "scene.toml").write_text(_toml.document(cloud))
    ds = cb.run(tmp_path / "scene.toml", set={"cloud.file": array})
    assert_same_results(ds, vdb)
    assert "array (z 5, y 6, x 8)" in ds.attrs["scene"] and "cloudbow-" not in ds.attrs["scene"]


def test_the_scene_in_the_result_describes_the_array(cloud):
    assert 'file = "array (z 5, y 6, x 8)"' in cb.run(cloud).attrs["scene"]


def changed(value, at=(2, 2, 2)):
    array = extinction()
    array.values[at] = value
    return array


def no_units(array, axis="x"):
    array[axis].attrs.clear()
    return array


def one_cell_along_x(size):
    array = extinction().isel(x=[3])
    array["x"].attrs["cell_size_m"] = size
    return array


@pytest.mark.parametrize("array, problem", [
    (changed(np.nan), "not finite at z, y, x = 2, 2, 2"), (changed(-1), "negative"), (changed(np.inf), "not finite"), (extinction() * 0, "no cloud"),
    (extinction().isel(z=0), "2 dimensions"), (extinction().rename(z="lev"), "lev"), (no_units(extinction()), "coordinate x"),
    (extinction().assign_coords(z=("z", [0, 1, 2, 3, 9.0], {"units": "m"})), "not evenly spaced"), (extinction().assign_attrs(units="g"), "units of extinction"),
    (extinction().values, "without coordinates"), (extinction().drop_vars(["x", "y"]), "coordinates"), (extinction().isel(x=[3]), "one cell along x"),
    (extinction().assign_coords(z=("z", list("abcde")[:extinction().z.size], {"units": "m"})), "coordinate z: not numbers"),
    (extinction().assign_coords(z=("z", extinction().z.values + 1j, {"units": "m"})), "coordinate z: not numbers"),
    (one_cell_along_x("wide"), "cell_size_m.*not numbers"), (one_cell_along_x(float("nan")), "cell_size_m.*no size"), (one_cell_along_x([1, 2]), "cell_size_m.*no size"),
    (np.ma.masked_equal(extinction().values, 0), "masked"), (extinction().astype(str), "not numbers"), (np.zeros((0, 2, 2)), "empty")])
def test_wrong_arrays_name_the_key(cloud, array, problem):
    cloud["cloud"]["file"] = array
    with pytest.raises(cb.InputError, match="^cloud.file.*" + problem):
        cb.run(cloud)


def test_other_wrong_arrays_name_the_key(cloud):
    def refused(match, **keys):
        with pytest.raises(cb.InputError, match=match):
            cb.run(dict(cloud, cloud=dict(cloud["cloud"], **keys)))
    radius = extinction().assign_attrs(units="um")
    refused("cloud.effective_radius_grid.*shape", effective_radius_grid=radius.values[:2])
    refused("cloud.effective_radius_grid.*other cells", effective_radius_grid=radius.assign_coords(x=("x", radius.x.values + 50, {"units": "m"})))
    refused("cloud.effective_radius_grid.*beside a file", file="x.vdb", effective_radius_grid=radius)
    refused("cloud.up_axis", up_axis="y")
    refused("cloud.quantity", quantity="extinctoin")
    refused("cloud.file.*quantity", quantity=None, file=extinction().assign_attrs(units=""))
    refused("cloud.file.*allowed cloud.quantity = 'extinction' or 'liquid_water_content'", quantity=None, file=extinction().values)
    refused("cloud.voxel_size_m: contradicts the coordinates of cloud.file .found 100 x 100 x 25 m, allowed 100 x 100 x 50 m", voxel_size_m=[100, 100, 25])
    refused("cloud.voxel_size_m: no size", voxel_size_m=[100, 100])
    refused("cloud.voxel_size_m: no size", voxel_size_m="wide")
    cb.check(dict(cloud, cloud=dict(cloud["cloud"], voxel_size_m=[100, 100, 50])))
    refused("cloud.grid", file=extinction().to_dataset(name="density"), grid="water")
    for wrong, problem in ((np.ones(3), "1 dimension"), (np.full((6, 8), np.nan), "not finite"), (np.full((6, 8), 2.0), "surface.albedo_map")):
        with pytest.raises(cb.InputError, match="surface.albedo_map") as error:
            cb.run(dict(cloud, surface={"albedo_map": wrong}))
        assert problem in str(error.value)


def test_constituents_are_arrays(cloud, tmp_path):
    """[[cloud]]: each of the list is an array of its own quantity, on voxels that overlap."""
    liquid = cloud["cloud"]["file"]
    ice = (liquid.isel(z=slice(2, 5)) * 4).assign_attrs(units="g m-3", quantity="ice_water_content").rename("ice")
    first = dict(cloud["cloud"], name="liquid")
    second = {"name": "ice", "file": ice, "effective_radius_um": 30.0, "single_scattering_albedo": 1.0, "phase_function": "crystals"}
    cloud["cloud"] = [first, second]
    cloud["phase_function"]["crystals"] = {"type": "henyey-greenstein", "asymmetry_parameter": 0.75}
    arrays = cb.run(cloud)
    cb.write_vdb(tmp_path / "liquid.vdb", liquid)
    cb.write_vdb(tmp_path / "ice.vdb", ice)
    cloud["cloud"] = [dict(first, file=str(tmp_path / "liquid.vdb")), dict(second, file=str(tmp_path / "ice.vdb"), grid="ice")]
    assert_same_results(arrays, cb.run(cloud))
    cloud["cloud"][1] = dict(second, file=-ice)
    with pytest.raises(cb.InputError, match=r"cloud\.1\.file"):
        cb.run(cloud)
    cloud["cloud"][1] = dict(second, quantity="hail")
    with pytest.raises(cb.InputError, match=r"cloud\.1\.quantity"):
        cb.run(cloud)
