"""read_vdb, write_vdb, mie, phase, verify.

Truth: what was written comes back; files of the program are read.
"""
import cloudbow as cb
import numpy as np
import pytest
import xarray as xr
from conftest import assert_same_results, extinction


def test_a_cloud_comes_back(tmp_path):
    array = extinction().astype(np.float32)
    radius = array.copy(data=np.where(array > 0, 10, np.nan).astype(np.float32)).assign_attrs(quantity="effective_radius", units="um")
    cb.write_vdb(tmp_path / "a.vdb", xr.Dataset({"density": array, "reff": radius}))
    ds = cb.read_vdb(tmp_path / "a.vdb")
    np.testing.assert_array_equal(ds.density, array)
    np.testing.assert_array_equal(ds.reff, radius)
    for axis in "xyz":
        np.testing.assert_allclose(ds[axis], array[axis], rtol=1e-12)
        assert ds[axis].attrs["units"] == "m"
    assert ds.density.attrs == {"quantity": "extinction", "units": "1/m"}
    assert ds.reff.attrs == {"quantity": "effective_radius", "units": "um"}
    cb.write_vdb(tmp_path / "b.vdb", ds)
    assert (tmp_path / "a.vdb").stat().st_size == (tmp_path / "b.vdb").stat().st_size
    xr.testing.assert_identical(ds, cb.read_vdb(tmp_path / "b.vdb"))
    assert list(cb.read_vdb(tmp_path / "b.vdb", grid="density")) == ["density"]


def test_a_cloud_of_the_program(tmp_path, program):
    program("cloud", "make", "step", "--cells", "8", "2", "3", "--voxel-size-m", "50", "50", "20", "-o", tmp_path / "step.vdb")
    ds = cb.read_vdb(tmp_path / "step.vdb")
    assert ds.density.shape == (3, 2, 8)
    # Mean optical depth 10 of the step cloud: .2 and 1.8 times that of its parts (I3RC).
    np.testing.assert_allclose((ds.density * 20).sum("z").isel(y=0), [2] * 4 + [18] * 4, rtol=1e-6)


def test_wrong_clouds(tmp_path):
    with pytest.raises(cb.InputError, match="not_there"):
        cb.read_vdb(tmp_path / "not_there.vdb")
    (tmp_path / "text.vdb").write_text("no cloud")
    with pytest.raises(cb.InputError, match="text.vdb"):
        cb.read_vdb(tmp_path / "text.vdb")
    cb.write_vdb(tmp_path / "a.vdb", extinction())
    with pytest.raises(cb.InputError, match="water"):
        cb.read_vdb(tmp_path / "a.vdb", grid="water")
    for wrong, problem in ((extinction().assign_attrs(units="K"), "quantity"), (extinction().values, "DataArray"), (xr.Dataset(), "no variables"),
                           (extinction() * np.nan, "quantity|finite")):
        with pytest.raises(cb.InputError, match=problem):
            cb.write_vdb(tmp_path / "b.vdb", wrong)
    with pytest.raises(cb.InputError, match="no_folder"):
        cb.write_vdb(tmp_path / "no_folder" / "b.vdb", extinction())


def test_mie_is_the_table_of_the_program(tmp_path, program):
    program("mie", "--wavelength-um", "0.67", "--effective-radius-um", "2:4:1", "--variance", "0.2", "-o", tmp_path / "a.h5", "--quiet")
    table = cb.mie(0.67, "2:4:1", variance=0.2, output=tmp_path / "b.h5")
    assert_same_results(table, cb.open_result(tmp_path / "a.h5"))
    assert_same_results(table, cb.open_result(tmp_path / "b.h5"), apart=set())
    for wrong in ({"wavelength_um": -1}, {"variance": 0}, {"substance": "snow"}, {"distribution": "flat"}, {"effective_radius_um": "x"}):
        with pytest.raises(cb.InputError, match=next(iter(wrong)).replace("_", ".")):
            cb.mie(**{"wavelength_um": 0.67, "effective_radius_um": 2, **wrong})


def test_phase_is_the_file_of_the_program(tmp_path, program):
    program("phase", "henyey-greenstein", "--asymmetry-parameter", "0.85", "--control-points", "42", "-o", tmp_path / "a.h5")
    ds = cb.phase("henyey-greenstein", asymmetry_parameter=0.85, control_points=42)
    assert_same_results(ds, cb.open_result(tmp_path / "a.h5"))
    with pytest.raises(cb.InputError, match="unknown type"):
        cb.phase("snow")
    with pytest.raises(cb.InputError, match="asymmetry-parameter"):
        cb.phase("henyey-greenstein")


def test_verify():
    names = [outcome.name for outcome in cb.verify(["energy-closure"])] if "energy-closure" in cb._core.check_names() else None
    first = cb._core.check_names()[0]
    (outcome,) = cb.verify([first])
    assert outcome.name == first and outcome.passed and 0 <= outcome.found <= outcome.tolerance and not outcome.error
    assert names in (None, ["energy-closure"])
    with pytest.raises(cb.InputError, match="only"):
        cb.verify(["no-such-check"])
