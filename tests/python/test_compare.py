"""compare(): statistics of the differences between two results.

Truth: numbers worked out by hand, and numpy.
"""
import os

import cloudbow as cb
import numpy as np
import pytest
import xarray as xr


def result(values, x=(0.0, 1.0), name="flux", units="W m-2"):
    return xr.Dataset({name: (("z", "x"), np.array(values, "float32"), {"units": units})}, {"z": [5.0, 15.0], "x": list(x)})


def test_numbers_by_hand():
    found = cb.compare(result([[1, 2], [3, 6]]), result([[1, 1], [1, 1]])).sel(variable="flux")
    assert (found.mean_a, found.mean_b, found.mean_difference, found.largest_difference) == (3, 1, 2, 5)
    assert found.rms_difference == np.sqrt(30 / 4) == found.relative_rms
    assert found.units == "W m-2"


def test_kept_dimensions():
    found = cb.compare(result([[1, 2], [3, 6]]), result([[1, 1], [1, 1]]), keep="z").sel(variable="flux")
    assert list(found.mean_difference.values) == [0.5, 3.5] and list(found.z.values) == [5, 15]
    both = cb.compare(result([[1, 2], [3, 6]]), result([[1, 1], [1, 1]]), keep=["z", "x"]).sel(variable="flux")
    np.testing.assert_array_equal(both.mean_difference.values, [[0, 1], [2, 5]])


def test_missing_values_do_not_count():
    found = cb.compare(result([[1, np.nan], [3, 6]]), result([[1, 1], [np.nan, 1]])).sel(variable="flux")
    assert (found.mean_a, found.mean_b, found.mean_difference) == (3.5, 1, 2.5)
    assert np.isnan(cb.compare(result([[1, 1], [1, 1]]), result(np.zeros((2, 2)))).relative_rms.item())


def test_what_cannot_be_compared_is_refused():
    a = result([[1, 2], [3, 6]])
    for b, words in ((result([[1, 2], [3, 6]], x=(0.0, 1.1)), "x: other coordinates"), (a.isel(x=[0]), "x: another length"), (a.rename(flux="other"), "no variable in common"),
                     (a.transpose("x", "z"), "other dimensions"), (3, "b: no result"), (result([[1, 2], [3, 6]], units="mW m-2"), "flux: other units"),
                     (result([[1, 2], [3, np.inf]]), "b: infinite values .found 1 in flux"), (a.assign_coords(x=["0", "1"]), "x: other coordinates"),
                     (a.assign_coords(x=np.array(["2020-01-01", "2020-01-02"], "datetime64[ns]")), "x: other coordinates")):
        with pytest.raises(cb.InputError, match=words):
            cb.compare(a, b)
    for keep, words in (("t", "keep.*allowed x, z"), (3, "keep: no names"), (None, "keep: no names"), ("units", "keep: a name of the statistics")):
        with pytest.raises(cb.InputError, match=words):
            cb.compare(a, a, keep=keep)
    with pytest.raises(cb.InputError, match="a: no values.*along x"):
        cb.compare(a.isel(x=[]), a.isel(x=[]))


def test_units_that_arithmetic_drops():
    a = result([[1, 2], [3, 6]])
    assert cb.compare(a, 2 * a).mean_difference.item() == -3


def test_paths_that_are_no_results(tmp_path):
    a = result([[1, 2], [3, 6]])
    os.mkfifo(tmp_path / "pipe.h5")
    (tmp_path / "empty.h5").touch()
    (tmp_path / "text.h5").write_text("no HDF5")
    for name, words in (("none.h5", "no file of this name"), (".", "a folder"), ("pipe.h5", "pipe"), ("a\0b", "no file of this name"), ("empty.h5", "can't be read"),
                        ("text.h5", "can't be read")):
        with pytest.raises(cb.InputError, match=words):
            cb.compare(a, tmp_path / name)


def test_results(layers, cloud, tmp_path):
    a = cb.run(cloud, output=tmp_path / "a.h5")
    same = cb.compare(tmp_path / "a.h5", a)
    assert float(abs(same.largest_difference).max()) == 0 and "z_bounds" not in same.variable
    b = cb.sweep(cloud, {"sun.zenith_deg": [0, 40]})
    c = cb.sweep(cloud, {"sun.zenith_deg": [0, 40]}, set={"surface.albedo": 0.5})
    found = cb.compare(c, b, keep="zenith_deg")
    expected = (c.upwelling_flux.astype(float) - b.upwelling_flux.astype(float)).mean(["z_edge", "y", "x"])
    np.testing.assert_allclose(found.mean_difference.sel(variable="upwelling_flux"), expected, rtol=1e-12)  # sums in another order
    assert found.mean_difference.dims == ("variable", "zenith_deg")
    only = cb.compare(a, a.drop_vars("absorbed_power"))
    assert only.attrs["only_in_a"] == "absorbed_power"
    assert list(same.to_dataframe().index) == list(same.variable.values)
