"""The installed package: it finds the module that reads OpenVDB, with nothing of the build tree.

Truth: `cmake --install` into an empty prefix. The build folder is that of BUILD_FOLDER.
"""
import os
import shutil
import subprocess
import sys

from conftest import extinction

import cloudbow as cb

CODE = """
import sys, cloudbow as cb
assert cb.__file__.startswith(sys.argv[1]), cb.__file__
ds = cb.read_vdb(sys.argv[2])
print(float(ds.density.max()), cb.__version__)
"""


def runs_from(folder, prefix, vdb):
    """A process that has the package from this folder alone."""
    environment = {name: value for name, value in os.environ.items() if name != "LD_LIBRARY_PATH"} | {"PYTHONPATH": str(folder)}
    done = subprocess.run([sys.executable, "-c", CODE, str(prefix), str(vdb)], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[1] == cb.__version__


def test_installed_package(tmp_path):
    cb.write_vdb(tmp_path / "cloud.vdb", extinction())
    prefix = tmp_path / "prefix"
    for component in ("python", "Unspecified"):
        subprocess.run(["cmake", "--install", os.environ["BUILD_FOLDER"], "--prefix", str(prefix), "--component", component], check=True,
                       stdout=subprocess.DEVNULL)
    (folder,) = prefix.glob("lib/python3*/site-packages")
    assert (folder / "cloudbow" / "py.typed").is_file()
    moved = tmp_path / "moved"
    shutil.move(prefix, moved)
    runs_from(moved / folder.relative_to(prefix), moved, tmp_path / "cloud.vdb")
