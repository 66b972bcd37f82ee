"""`cloudbow run` to a wanted error or time, as a user has it: the program, the scene of the step cloud, and which of the promises is checked.

usage: test_target_run.py CLOUDBOW SCENE met|refused|budget|fields
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

program, scene, what = sys.argv[1:4]


def run(folder, *options, code=(0,)):
    output = Path(folder) / "result.h5"
    done = subprocess.run([program, "run", scene, "-o", str(output), "--threads", "1", *options], capture_output=True, text=True)
    assert done.returncode in code, f"exit code {done.returncode}, not of {code}\n{done.stderr}"
    return output, done


def met(folder):
    output, done = run(folder, "--target-error", "2%", "--of", "columns")
    with h5py.File(output) as file:
        plan, estimate = dict(file["plan"].attrs), dict(file["error_estimate"].attrs)
    assert plan["met"] == 1 and plan["target_error"] == 0.02, plan
    assert estimate["columns"] <= 0.02, estimate
    assert estimate["columns"] == max(estimate["columns_up"], estimate["columns_down"])
    assert estimate["calibrated_for"] == plan["accuracy"]
    # Says on stderr what came out.
    assert f"`{plan['accuracy'].decode()}`: estimated error of columns" in done.stderr, done.stderr


def refused(folder):
    output, done = run(folder, "--target-error", "0.0001%", "--of", "columns", "--quiet", code=(2,))
    assert not output.exists(), "a result was written"
    offered = re.search(r"ask for >= ([0-9.e-]+) %", done.stderr)
    assert offered, done.stderr
    # The offer of a refusal is not refused; only the solve shows if it is reached.
    run(folder, "--target-error", f"{offered[1]}%", "--of", "columns", "--quiet", code=(0, 3))


def budget(folder):
    output, _ = run(folder, "--budget", "10m", "--quiet")
    with h5py.File(output) as file:
        plan = dict(file["plan"].attrs)
    assert plan["budget_seconds"] == 600 and plan["accuracy"] == b"reference" and plan["met"] == 1, plan
    assert plan["levels_solved"] == b"draft, reference", plan
    _, done = run(folder, "--budget", "0.0001s", "--quiet", code=(2,))
    assert "--budget: too short for `draft`" in done.stderr, done.stderr


def fields(folder):
    output, done = run(folder, "--set", 'output.fields=["fluxes", "errors"]')
    assert "flux errors, about" in done.stdout, done.stdout
    with h5py.File(output) as file:
        estimate = dict(file["error_estimate"].attrs)
        down = file["downwelling_diffuse_flux"][0] + file["direct_flux"][0]
        for name, of, error in (("columns_up", file["upwelling_flux"][-1], file["upwelling_flux_error"]), ("columns_down", down, file["downwelling_flux_error"])):
            assert error.shape == of.shape and error.attrs["units"] == b"W m-2"
            rms = np.sqrt(np.mean(error[...].astype(float) ** 2))
            # Fluxes are 32-bit floats.
            assert abs(rms / of.mean() / estimate[name] - 1) < 1e-4, (name, rms, estimate[name])
            parts = [estimate[f"{name}_{part}"] for part in ("angular", "spatial", "iteration")]
            assert abs(np.sqrt(np.sum(np.square(parts))) / estimate[name] - 1) < 1e-12
    output, done = run(folder, "--set", "output.error_estimate=false")
    assert "flux errors" not in done.stdout
    with h5py.File(output) as file:
        assert "error_estimate" not in file and "upwelling_flux_error" not in file


with tempfile.TemporaryDirectory() as directory:
    {"met": met, "refused": refused, "budget": budget, "fields": fields}[what](directory)
