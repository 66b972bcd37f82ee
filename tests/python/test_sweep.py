"""sweep(): the result is the file of `cloudbow sweep`, and has the bits of run().

Truth: the program, and single runs.
"""
import warnings
from types import SimpleNamespace

import cloudbow as cb
import numpy as np
import pytest
import xarray as xr
from conftest import assert_same, assert_same_results

from cloudbow import _core, _toml


def test_result_is_the_file_of_the_program(layers, program, tmp_path):
    layers["domain"] = {"vertical_cells": 20}  # levels follow the accuracy otherwise
    path = tmp_path / "scene.toml"
    path.write_text(_toml.document(layers))
    program("sweep", path, "-o", tmp_path / "a.h5", "--quiet", "--set", "sun.zenith_deg=0,30.5", "--set", "solver.accuracy=draft,balanced", "--set", "surface.albedo=0.4")
    ds = cb.sweep(path, {"sun.zenith_deg": [0, 30.5], "solver.accuracy": ("draft", "balanced"), "surface.albedo": 0.4})
    with xr.open_dataset(tmp_path / "a.h5", engine="h5netcdf") as file:
        assert_same(ds, file)
    assert_same_results(ds, cb.open_result(tmp_path / "a.h5"))
    assert ds.upwelling_flux.dims[:2] == ("zenith_deg", "accuracy") and list(ds.accuracy.values) == ["draft", "balanced"]
    assert "cloudbow.sweep(" in ds.attrs["history"] and "albedo" not in ds.dims


def test_values_are_those_of_runs(cloud):
    zeniths, albedos = np.array([0.0, 50.0]), range(2)
    ds = cb.sweep(cloud, {"sun.zenith_deg": zeniths, "surface.albedo": albedos}, jobs=2, set={"solver.tolerance": 1e-3})
    for zenith in zeniths:
        for albedo in albedos:
            one = cb.run(cloud, set={"sun.zenith_deg": zenith, "surface.albedo": albedo, "solver.tolerance": 1e-3})
            here = ds.sel(zenith_deg=zenith, albedo=albedo)
            for name in one.data_vars:
                assert here[name].values.tobytes() == one[name].values.tobytes(), name
            assert here.solar_zenith_angle == one.solar_zenith_angle
            for group, name in (("/summary", "reflectance"), ("/error_estimate", "domain")):
                assert ds.cloudbow.groups[group][name].sel(zenith_deg=zenith, albedo=albedo) == one.cloudbow.groups[group].attrs[name]
    scene = str(ds.cloudbow.groups["/runs"].scene.values[1, 1])
    assert "array (z 5, y 6, x 8)" in scene and "zenith_deg = 50.0" in scene
    assert ds.zenith_deg.attrs["units"] == "degree" and ds.zenith_deg.attrs["key"] == "sun.zenith_deg"


def test_arrays_are_known_again(cloud, tmp_path):
    """Files of arrays are written anew in each call: kept runs count all the same."""
    def stop(progress):
        raise RuntimeError("after the first")
    out = tmp_path / "kept.h5"
    with pytest.raises(RuntimeError, match="after the first"):
        cb.sweep(cloud, {"sun.zenith_deg": [0, 20, 40]}, output=out, progress=stop)
    kept = len(list((tmp_path / "kept.h5.parts").glob("run-*.h5")))
    assert 1 <= kept <= 3 and not out.exists()
    states = []
    ds = cb.sweep(cloud, {"sun.zenith_deg": [0, 20, 40]}, output=out, progress=states.append)
    assert states == [] or states[-1] == (3 - kept, 3 - kept)
    assert_same_results(ds, cb.sweep(cloud, {"sun.zenith_deg": [0, 20, 40]}))
    assert [path.name for path in tmp_path.iterdir()] == ["kept.h5"]


def test_progress_counts_runs(layers):
    states = []
    cb.sweep(layers, {"sun.zenith_deg": [0, 10, 20, 30]}, progress=states.append)
    assert states[-1] == cb.SweepProgress(4, 4) and [s.done for s in states] == sorted({s.done for s in states})


def test_what_does_not_converge_is_marked(cloud):
    with pytest.warns(cb.NotConverged, match="max_sweeps=2: not converged"):
        ds = cb.sweep(cloud, {"solver.max_sweeps": [2, 100]})
    assert list(ds.cloudbow.groups["/runs"].exit_code.values) == [3, 0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cb.sweep(cloud, {"solver.max_sweeps": [99, 100]})


@pytest.mark.parametrize("keys, words", [
    ({"sun.zenith_deg": [0, 95]}, "zenith_deg"),
    ({"sun.zenit": [0, 5]}, "zenit"),
    ({"sun.zenith_deg": []}, "^sun.zenith_deg: an empty list"),
    ({"sun.zenith_deg": [1, 1.0]}, "^sun.zenith_deg: a value twice"),
    ({"sun.zenith_deg": 5}, "^sun.zenith_deg: nothing to sweep"),
    ({}, "^keys: nothing to sweep"),
    ({"sun.zenith_deg": "0:60"}, "^sun.zenith_deg=0:60: a range has FIRST:LAST:STEP"),
    ({"sun.zenith_deg": "0:60:-20"}, "^sun.zenith_deg=0:60:-20: a range without end"),
    ({"sun.zenith_deg": "0 30"}, "^sun.zenith_deg=0 30: commas separate values"),
    ({"sun.zenith_deg": "0, 0"}, "^sun.zenith_deg: a value twice"),
    ({"sun.zenith_deg": range(200), "surface.albedo": range(200)}, "^sun.zenith_deg, surface.albedo: too many runs"),
    ({"sun.zenith_deg": np.zeros((2, 2))}, "array of 2 dimensions"),
    ({"sun.zenith_deg": [0, object()]}, "no value of a scene"),
    ({"sun.zenith_deg": b"05"}, "no value of a scene"),
    ({"sun.zenith_deg": [float("nan"), 1]}, "zenith_deg=nan"),
    ({"sun.": [0, 5]}, "dotted key"),
    ({3: [0, 5]}, "^keys: a key that is no text"),
    ([("sun.zenith_deg", [0, 5])], "no dict"),
    ({"output.file": ["a.h5", "b.h5"]}, "^output.file: has no effect in a sweep"),
    ({"title": ["\ud800", "b"]}, "^title.0: no text"),
])
def test_wrong_lists_are_refused(layers, keys, words):
    with pytest.raises(cb.InputError, match=words):
        cb.sweep(layers, keys)


def test_texts_are_lists_as_on_the_command_line(layers):
    ds = cb.sweep(layers, {"sun.zenith_deg": "0:60:20", "surface.albedo": "0.1, 0.3"})
    assert_same_results(ds, cb.sweep(layers, {"sun.zenith_deg": [0, 20, 40, 60], "surface.albedo": [0.1, 0.3]}))
    assert list(ds.zenith_deg.values) == [0, 20, 40, 60] and list(ds.albedo.values) == [0.1, 0.3]


def test_labelled_arrays_are_lists(layers):
    assert list(cb.sweep(layers, {"sun.zenith_deg": xr.DataArray([0.0, 20], dims="time")}).zenith_deg.values) == [0, 20]


def test_an_older_file_is_not_the_result_of_a_sweep_without_results(layers, tmp_path, monkeypatch):
    output = tmp_path / "out.h5"
    cb.sweep(layers, {"sun.zenith_deg": [0, 5]}, output=output)
    monkeypatch.setattr(_core, "sweep", lambda **_: SimpleNamespace(exit_code=1, written=False, sentences=["no run has a result"]))
    with pytest.raises(cb.InputError, match="no run has a result"):
        cb.sweep(layers, {"sun.zenith_deg": [0, 5]}, output=output)


def test_wrong_arguments_are_refused(layers):
    for arguments in ({"jobs": 0}, {"jobs": 1.5}, {"threads": 0}, {"progress": 1}, {"set": 3}, {"set": {3: 1}}, {"output": 3}, {"output": "a\0b.h5"}):
        with pytest.raises(cb.InputError, match=next(iter(arguments))):
            cb.sweep(layers, {"sun.zenith_deg": [0, 5]}, **arguments)
    with pytest.raises(cb.InputError, match="^sun.zenith_deg: a key twice"):
        cb.sweep(layers, {"sun.zenith_deg": [0, 5]}, set={"sun.zenith_deg": 3})


def test_files_of_a_dict_are_those_of_the_working_directory(cloud, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    array = cloud["cloud"].pop("file")
    cb.write_vdb("one.vdb", array)
    cb.write_vdb("two.vdb", array.copy(data=2 * array.values))
    ds = cb.sweep(cloud, {"cloud.file": ["one.vdb", "two.vdb"]})
    reflectance = ds.cloudbow.groups["/summary"].reflectance
    assert reflectance.dims == ("cloud_file",) and reflectance[1] > reflectance[0]
