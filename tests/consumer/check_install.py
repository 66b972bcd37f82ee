#!/usr/bin/env python3
"""The installed program and package work after they were moved: the program finds its OpenVDB module, another project finds the package by find_package and solves by the public headers; it finds the module too. The project is the one that docs/cpp-api.md shows.

usage: check_install.py --build FOLDER --compiler C++ [--flags FLAGS] --libdir lib
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def run(*words, **more):
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}\nexit code {done.returncode}\n{done.stdout}")
    return done.stdout


def write_project(folder):
    """CMakeLists.txt and main.cpp of the page, each its only block of that kind; and a shared object that holds the libraries, as a module of
    another language does."""
    page = (Path(__file__).resolve().parents[2] / "docs/cpp-api.md").read_text()
    folder.mkdir()
    for kind, name in (("cmake", "CMakeLists.txt"), ("cpp", "main.cpp")):
        (block,) = re.findall(rf"^```{kind}\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
        (folder / name).write_text(block)
    with open(folder / "CMakeLists.txt", "a") as lists:
        lists.write("add_library(plugin MODULE main.cpp)\ntarget_link_libraries(plugin PRIVATE cloudbow::transport)\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", required=True, type=Path)
    parser.add_argument("--compiler", required=True)
    parser.add_argument("--flags", default="")
    parser.add_argument("--libdir", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run("cmake", "--install", options.build, "--prefix", folder / "first")
        prefix = (folder / "first").rename(folder / "moved")
        module, drawing = (prefix / options.libdir / "cloudbow" / f"cloudbow_{name}.so" for name in ("vdb", "drawing"))
        assert module.is_file() and drawing.is_file(), (module, drawing)

        cloud = folder / "cloud.vdb"
        clean = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
        made = run(prefix / "bin/cloudbow", "cloud", "make", "slab", "--cells", 4, 4, 2, "--voxel-size-m", 50, 50, 50, "-o", cloud, env=clean)
        assert "density" in made, made

        project, build = folder / "project", folder / "mine"
        write_project(project)
        run("cmake", "-S", project, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}", f"-DCMAKE_CXX_COMPILER={options.compiler}",
            f"-DCMAKE_CXX_FLAGS={options.flags}")
        run("cmake", "--build", build)
        said = run(build / "mine", cloud, env=clean)
        print(said)
        assert "voxels 32" in said, said

        figure = folder / "cloud.svg"
        plot = ("cloud", "info", cloud, "--plot", figure)
        run(prefix / "bin/cloudbow", *plot, env=clean)
        assert figure.read_text().startswith("<?xml"), figure

        # With the module gone the program says so: that it was found above is no accident of this build's folder.
        figure.unlink()
        drawing.unlink()
        without = subprocess.run([str(prefix / "bin/cloudbow"), *map(str, plot)], capture_output=True, text=True, env=clean)
        assert without.returncode == 2 and "cloudbow_drawing.so" in without.stderr and not figure.exists(), without
        module.unlink()
        without = subprocess.run([str(prefix / "bin/cloudbow"), "cloud", "info", str(cloud)], capture_output=True, text=True, env=clean)
        assert without.returncode == 2 and "cloudbow_vdb.so" in without.stderr, without
    return 0


if __name__ == "__main__":
    sys.exit(main())
