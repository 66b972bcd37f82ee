"""Result files as Datasets.

Truth: xarray.open_dataset of the same file and group.
"""
import pickle

import cloudbow as cb
import numpy as np
import pytest
import xarray as xr
from conftest import assert_same

from cloudbow import _results

FIELDS = ["fluxes", "absorption", "actinic", "errors", "optical_depth"]
NADIR = [{"name": "nadir", "zenith_deg": 0.0}]


def assert_as_by_xarray(path):
    """All groups, read directly, and none left to xarray."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(xr, "open_dataset", None)
        mine = _results.read_groups(path)
    theirs = _results.read_groups(path, by_xarray=True)
    assert list(mine) == list(theirs)
    for name, dataset in mine.items():
        assert_same(dataset, theirs[name], apart=set())
        xr.testing.assert_identical(dataset, theirs[name])
        assert list(dataset.coords) == list(theirs[name].coords) and set(dataset.indexes) == set(theirs[name].indexes)


@pytest.mark.parametrize("change", [
    {}, {"output.fields": FIELDS}, {"radiance": NADIR}, {"output.fields": ["fluxes", "radiance_field"]},
    {"spectrum": {"wavelengths_um": [0.5, 0.6]}}])
def test_results_are_as_by_xarray(cloud, tmp_path, change):
    cb.run(cloud, set=change, compare=True, output=tmp_path / "a.h5")
    assert_as_by_xarray(tmp_path / "a.h5")


def test_other_tables_are_as_by_xarray(layers, tmp_path):
    cb.mie([0.6, 0.7], "2:3:1", variance=0.2, output=tmp_path / "mie.h5")
    cb.phase("rayleigh", control_points=42, output=tmp_path / "phase.h5")
    cb.run(layers, set={"atmosphere.standard": "us-1976", "output.fields": ["fluxes", "absorption", "heating_rate"]}, output=tmp_path / "layers.h5")
    for name in ("mie", "phase", "layers"):
        assert_as_by_xarray(tmp_path / f"{name}.h5")


def test_other_files_are_read_by_xarray(tmp_path):
    """Packed numbers, missing values, times and text are decoded."""
    given = xr.Dataset({"packed": ("x", [0.5, np.nan]), "text": ("x", ["a", "b"]), "plain": ("x", np.array([1.0, 2.0]))}, attrs={"list": ["a", "b"]})
    given.to_netcdf(tmp_path / "a.nc", engine="h5netcdf", encoding={"packed": {"dtype": "i2", "scale_factor": 0.5, "_FillValue": -1}})
    xr.testing.assert_identical(cb.open_result(tmp_path / "a.nc"), xr.load_dataset(tmp_path / "a.nc", engine="h5netcdf"))


def test_a_result_can_be_written_again(layers, tmp_path):
    ds = cb.run(layers)
    ds.to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    xr.testing.assert_identical(ds, xr.load_dataset(tmp_path / "a.nc", engine="h5netcdf"))


def test_a_result_can_be_pickled(layers):
    """As processes of a pool do."""
    ds = cb.run(layers)
    copy = pickle.loads(pickle.dumps(ds))
    xr.testing.assert_identical(copy, ds)
    assert list(copy.cloudbow.groups) == list(ds.cloudbow.groups)
    assert ds.isel(x=0).cloudbow.groups == {}


def test_groups_are_found_without_a_slash_and_listed(layers):
    ds = cb.run(layers)
    groups = ds.cloudbow.groups
    assert groups["summary"] is groups["/summary"] and "summary" in groups and groups.get("nothing") is None
    with pytest.raises(KeyError, match="found 'nowhere', allowed .*/summary.*/solver|found 'nowhere', allowed .*/solver.*/summary"):
        groups["nowhere"]
    with pytest.raises(KeyError, match="belong to the Dataset that `run`"):
        ds.isel(x=0).cloudbow.groups["/summary"]


def test_no_result(tmp_path):
    with pytest.raises(cb.InputError, match="not_there"):
        cb.open_result(tmp_path / "not_there.h5")
    (tmp_path / "text.h5").write_text("text")
    with pytest.raises(cb.InputError, match="text.h5"):
        cb.open_result(tmp_path / "text.h5")
