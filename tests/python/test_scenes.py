"""Scenes as dicts: exact TOML, relative files, the text in the result.

Truth: tomllib of Python reads back what was written.
"""
import math
import os
import tomllib
from pathlib import Path

import cloudbow as cb
import numpy as np
import pytest
from conftest import assert_same_results

from cloudbow import _scene, _toml


@pytest.mark.parametrize("table", [
    {}, {"a": 1}, {"a": {"b": {"c": 1.5}}}, {"list": [1, 2.5]}, {"a": [{"b": 1, "c": {"d": 2}}, {"b": 3, "e": [{"f": 1}, {}]}], "z": 1},
    {"text": 'quote " back \\ line \n tab \t \x00 \x7f \u00e9 \U0001f324'}, {"a.b": {"c d": 1, "": 2, "\u00e9": 3}}, {"mixed": [1, {"a": 2}, [3]]},
    {"numbers": [0.1, 1e-300, 5e-324, 1.7976931348623157e308, -0.0, 1e22, 123456789012345678]}, {"truth": [True, False]}, {"empty": [], "table": {}},
    {"inf": [float("inf"), -float("inf")]}, {"a": {"b": 1}, "c": 2}])
def test_a_dict_comes_back(table):
    assert tomllib.loads(_toml.document(table)) == table


def test_bits_of_numbers_come_back():
    values = np.random.default_rng(2).integers(0, 2**63, 2000).view(np.float64)
    values = values[np.isfinite(values)].tolist()
    assert tomllib.loads(_toml.document({"a": values}))["a"] == values
    assert math.isnan(tomllib.loads(_toml.document({"a": float("nan")}))["a"])


def test_other_types_become_plain():
    given = {"a": np.float32(0.5), "b": np.int64(3), "c": np.bool_(True), "d": np.array([1.5, 2]), "e": (1, 2), "f": Path("x/y"), "g": np.str_("t")}
    assert _toml.plain(given, "") == {"a": 0.5, "b": 3, "c": True, "d": [1.5, 2.0], "e": [1, 2], "f": "x/y", "g": "t"}


def test_dict_and_toml_are_the_same_scene(layers, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(_toml.document(layers))
    a, b = cb.run(layers), cb.run(path)
    assert_same_results(a, b)
    assert tomllib.loads(a.attrs["scene"]) == tomllib.loads(b.attrs["scene"]) == layers


def test_the_dict_is_left_as_it_was(layers, cloud):
    before = repr(layers), repr(cloud)
    cb.run(layers, set={"sun.zenith_deg": 10.0})
    cb.check(cloud, set={"sun.zenith_deg": 10.0})
    assert (repr(layers), repr(cloud)) == before


def test_files_of_a_dict_are_relative_to_the_working_directory(cloud, tmp_path, monkeypatch):
    array = cloud["cloud"]["file"]
    cb.write_vdb(tmp_path / "cloud.vdb", array)
    cloud["cloud"]["file"] = "cloud.vdb"
    monkeypatch.chdir(tmp_path)
    ds = cb.run(cloud)
    assert tomllib.loads(ds.attrs["scene"])["cloud"]["file"] == "cloud.vdb"
    monkeypatch.chdir(tmp_path.parent)
    with pytest.raises(cb.InputError, match="cloud.file"):
        cb.run(cloud)


def test_every_key_of_a_file_is_known():
    """Keys that the reference describes as files are those that become absolute."""
    reference = (Path(__file__).parents[2] / "docs/scene-reference.md").read_text()
    keys = set()
    for line in reference.splitlines():
        parts = [part.strip() for part in line.split("|")]
        is_key = len(parts) > 4 and parts[1].startswith("`") and "name" not in parts[3]
        if is_key and any(word in parts[3] for word in ("file", "PNG", "netCDF", "a table of")):
            keys |= {key.strip().strip("`") for key in parts[1].split(",")}
    assert {"file", "albedo_map"} <= keys
    assert keys <= _scene.FILE_KEYS, keys - _scene.FILE_KEYS


@pytest.mark.parametrize("key, value, problem", [("a.0", 1, "a.0"), ("b.c.d", 1, "b.c.d"), ("a.x", 1, "a.x")])
def test_settings_without_a_place(key, value, problem):
    with pytest.raises(cb.InputError, match=problem):
        _scene.set_key({"a": [], "b": {"c": 1}}, key, value)


def test_tables_without_end_are_refused(layers):
    table, array = {}, []
    table["a"], array[:] = table, [array]
    for wrong in (dict(layers, title=table), dict(layers, title=array), table):
        with pytest.raises(cb.InputError, match="nested too deeply"):
            cb.check(wrong)
    with pytest.raises(cb.InputError, match="^title: nested too deeply"):
        cb.check(layers, set={"title": table})


def test_characters_of_no_file_are_refused(layers):
    half = "\ud800"
    for wrong, key in ((dict(layers, title=half), "^title"), ({**layers, half: 1}, "^scene"), (half, "^scene: no path")):
        with pytest.raises(cb.InputError, match=key):
            cb.check(wrong)
    with pytest.raises(cb.InputError, match="^set: no text"):
        cb.check(layers, set={half: 1})
    with pytest.raises(cb.InputError, match="^output: no path"):
        cb.run(layers, output=half + ".h5")
