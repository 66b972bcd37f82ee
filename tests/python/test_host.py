"""The package in a process of its own: time of the import, Ctrl-C, no words on stdout and stderr.

Truth: the limits of the design; a KeyboardInterrupt as of Python itself.
"""
import os
import signal
import subprocess
import sys
import time

import pytest
from conftest import extinction


def python(code, **options):
    return subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)


def test_import_is_fast():
    """Limit of the design: .2 s. Processor time, because other programs run too."""
    code = "import time; t = time.process_time(); import cloudbow; print(time.process_time() - t)"
    python("import cloudbow").communicate()  # compiles it once
    seconds = [float(python(code).communicate()[0]) for _ in range(5)]
    assert min(seconds) < 0.2, seconds


def test_import_brings_no_heavy_packages():
    code = "import sys, cloudbow; print([name for name in ('numpy', 'xarray', 'pandas', 'h5py') if name in sys.modules])"
    assert python(code).communicate()[0].strip() == "[]"


CTRL_C = """
import sys
sys.path.insert(0, {folder!r})
import cloudbow as cb
from conftest import CLOUD, extinction
scene = dict(CLOUD, cloud=dict(CLOUD["cloud"], file=extinction(), single_scattering_albedo=1.0), solver=dict(accuracy="draft", tolerance=1e-8, max_sweeps=100000))
def show(state):
    if state.phase == "sweep" and state.sweep == 2:
        print("sweep", flush=True)
try:
    cb.run(scene, threads=1, progress={progress})
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_ctrl_c_is_a_keyboard_interrupt():
    process = python(CTRL_C.format(folder=os.path.dirname(__file__), progress="show"))
    assert process.stdout.readline() == "sweep\n"
    process.send_signal(signal.SIGINT)
    begin = time.monotonic()
    out, err = process.communicate(timeout=60)
    assert out == "interrupted\n", err
    assert process.returncode == 0 and time.monotonic() - begin < 5


def test_quiet():
    """Nothing is printed by a run."""
    code = f"import sys; sys.path.insert(0, {os.path.dirname(__file__)!r}); import cloudbow as cb; from conftest import LAYERS; cb.run(LAYERS); cb.check(LAYERS)"
    out, err = python(code).communicate()
    assert (out, err) == ("", "")
