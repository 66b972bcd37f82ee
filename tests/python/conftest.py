"""Scenes that take milliseconds, and the program to compare with.

The package is that of PYTHONPATH, the program that of CLOUDBOW:
  PYTHONPATH=build/dev/python CLOUDBOW=build/dev/src/cloudbow /usr/bin/python3 -m pytest tests/python
"""
import copy
import os
import subprocess

import numpy as np
import pytest
import xarray as xr

# No cloud: columns, without iteration.
LAYERS = {
    "title": "layers",
    "layer": [
        {"bottom_m": 0.0, "top_m": 1000.0, "optical_depth": 0.1, "single_scattering_albedo": 1.0, "phase_function": "rayleigh"},
        {"bottom_m": 1000.0, "top_m": 1500.0, "optical_depth": 7.25, "single_scattering_albedo": 0.99, "phase_function": "droplets"},
    ],
    "phase_function": {"droplets": {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}},
    "sun": {"zenith_deg": 30.0, "azimuth_deg": 10.0, "irradiance_w_m2": 1000.0},
    "surface": {"albedo": 0.2},
}
CLOUD = {
    "title": "a small cloud",
    "cloud": {"quantity": "extinction", "single_scattering_albedo": 0.999, "phase_function": "droplets"},
    "phase_function": {"droplets": {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}},
    "sun": {"zenith_deg": 30.0, "azimuth_deg": 10.0, "irradiance_w_m2": 1000.0},
    "surface": {"albedo": 0.2},
    "solver": {"accuracy": "draft"},
    "output": {"fields": ["fluxes", "absorption"]},
}


def extinction():
    """A cloud of 5 x 6 x 8 voxels (z, y, x) with clear air around it; numbers that float32 does not hold exactly."""
    values = np.random.default_rng(1).uniform(0.005, 0.02, (5, 6, 8))
    values[0] = values[:, 0] = values[:, :, 0] = 0
    return xr.DataArray(values, dims=("z", "y", "x"), name="density", attrs={"units": "1/m"}, coords={
        "z": ("z", 500 + 50 * (np.arange(5) + 0.5), {"units": "m"}), "y": ("y", 100 * (np.arange(6) + 0.5), {"units": "m"}),
        "x": ("x", 100 * (np.arange(8) + 0.5), {"units": "m"})})


@pytest.fixture
def layers():
    return copy.deepcopy(LAYERS)


@pytest.fixture
def cloud():
    """A scene whose cloud is an array."""
    scene = copy.deepcopy(CLOUD)
    scene["cloud"]["file"] = extinction()
    return scene


@pytest.fixture
def program():
    """Runs the program; its exit code must be 0."""
    def call(*words, code=0):
        done = subprocess.run([os.environ["CLOUDBOW"], *map(str, words)], capture_output=True, text=True)
        assert done.returncode == code, done.stderr
        return done
    return call


# Attributes that say when and how.
APART = {"history", "scene"}


def is_measured(name):
    """Time and memory differ from run to run."""
    return "seconds" in name or name == "peak_memory_bytes"


def assert_same(a, b, apart=APART):
    """The same variables, bits and attributes, but for what is measured."""
    assert list(a.variables) == list(b.variables)
    for name in a.variables:
        if is_measured(name):
            continue
        assert a[name].dims == b[name].dims and a[name].dtype == b[name].dtype, name
        assert a[name].values.tobytes() == b[name].values.tobytes() or a[name].dtype == object and (a[name].values == b[name].values).all(), name
        assert_same_attributes(a[name].attrs, b[name].attrs)
    assert_same_attributes(a.attrs, b.attrs, apart)


def assert_same_attributes(a, b, apart=frozenset()):
    def kept(name):
        return name not in apart and not is_measured(name)
    assert [name for name in a if kept(name)] == [name for name in b if kept(name)]
    for name in filter(kept, a):
        np.testing.assert_array_equal(a[name], b[name], err_msg=name)
        assert type(a[name]) is type(b[name]), name


def assert_same_results(a, b, apart=APART):
    assert_same(a, b, apart)
    assert list(a.cloudbow.groups) == list(b.cloudbow.groups)
    for name, group in a.cloudbow.groups.items():
        assert_same(group, b.cloudbow.groups[name])
