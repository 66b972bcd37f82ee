#!/usr/bin/env python3
"""A command under a limit on its addresses (`ulimit -v`) ends with its result. Else it ends with one message and exit code 2; never by a signal, never hangs.

Truth: what a user may meet under batch systems, which set such limits. A scene of a VDB cloud is solved by one and by two threads. Another has layers of air beside the cloud. Its result is drawn, and an LES output is imported. The limits grow by equal steps. Below the first of them the system cannot
load the program's libraries (exit code 127 of the loader). The scene is solved in half a second: 120 s is a hang.

usage: memory_limits.py --cloudbow PROGRAM [--from MB] [--to MB] [--step MB] [--group FOLDER]
By hand: the defaults are all steps. ctest takes those about what OpenVDB needs to load. With --group the limits are those of a control group of
version 1 or 2. It is empty, and the caller made it and may write it, such as /sys/fs/cgroup/memory/test. Libraries that others have loaded do not count
there: --from 10 --to 100 --step 5.
"""
import argparse
import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy

import sound_scene

MEGABYTE = 1_000_000
LOADER = 127  # ld.so could not map a library
HANGS = 120  # seconds

# Air beside and above the cloud, seen by a camera and in the flux of every level.
LAYERS = """\
[output]
flux_levels = "all"
[[layer]]
name = "air"
bottom_m = 0.0
top_m = 4000.0
optical_depth = 0.1
single_scattering_albedo = 1.0
phase_function = "rayleigh"
[[camera]]
name = "fisheye"
type = "fisheye"
position_m = [0.0, 0.0, 0.0]
width = 16
height = 16
"""


def limit_group(group, megabytes):
    """Limits the memory of the processes in a control group."""
    for name in ("memory.limit_in_bytes", "memory.max"):
        if (group / name).exists():
            (group / name).write_text(str(megabytes * MEGABYTE))
            return
    sys.exit(f"{group}: is no control group of memory")


def run(command, megabytes, group):
    """Exit code and lines on stderr of a command. Its addresses or the memory of its group are limited. No exit code if it hangs."""
    if group:
        limit_group(group, megabytes)

    def limit():
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if group:
            (group / "cgroup.procs").write_text(str(os.getpid()))
        else:
            resource.setrlimit(resource.RLIMIT_AS, (megabytes * MEGABYTE, megabytes * MEGABYTE))

    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=HANGS, preexec_fn=limit)
    except subprocess.TimeoutExpired:
        return None, []
    return done.returncode, [line for line in done.stderr.splitlines() if line.strip() and not line.startswith("cloudbow: note:")]


def fault(code, lines, output):
    """Fault of the end of a command, or nothing."""
    if code is None:
        return "hangs"
    if code == LOADER:
        return "" if not output.exists() else "a result in spite of the loader"
    if code == 0:
        return "" if output.exists() else "no result"
    if code != 2:
        return f"exit code {code}"
    if len(lines) != 1 or not lines[0].startswith("cloudbow: "):
        return f"{len(lines)} lines instead of one message"
    if any(word in lines[0] for word in ("damaged", "internal error", "install")):
        return "the limit is told as another fault"
    amounts = re.search(r"found (\d+) MB needed, allowed (\d+) MB", lines[0])
    if amounts and int(amounts[1]) <= int(amounts[2]):
        return "as much is allowed as is needed"
    return "a result beside the message" if output.exists() else ""


def make_les_file(path):
    """A netCDF file of liquid water, 16 x 16 x 8 cells."""
    with h5py.File(path, "w") as file:
        for axis, cells, size in (("z", 8, 25.), ("y", 16, 50.), ("x", 16, 50.)):
            file[axis] = size * (numpy.arange(cells) + .5)
            file[axis].attrs["units"] = numpy.bytes_("m")
            file[axis].make_scale(axis)
        water = numpy.zeros((8, 16, 16))
        water[2:6, 4:12] = .3
        file["LWC"] = water
        file["LWC"].attrs["units"] = numpy.bytes_("g/m3")
        for number, axis in enumerate("zyx"):
            file["LWC"].dims[number].attach_scale(file[axis])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    parser.add_argument("--from", type=int, default=100, dest="first")
    parser.add_argument("--to", type=int, default=2000)
    parser.add_argument("--step", type=int, default=50)
    parser.add_argument("--group", type=Path)
    options = parser.parse_args()
    faults = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subprocess.run([options.cloudbow, "cloud", "make", "stratocumulus", "--cells", "16", "16", "8", "--voxel-size-m", "50",
                        "50", "25", "--seed", "3", "-o", folder / "cloud.vdb"], check=True, capture_output=True)
        scene, les, result = folder / "scene.toml", folder / "les.nc", folder / "result.h5"
        scene.write_text(sound_scene.SCENE)
        with_layers = folder / "with_layers.toml"
        with_layers.write_text(sound_scene.SCENE + LAYERS)
        make_les_file(les)
        subprocess.run([options.cloudbow, "run", scene, "-o", result, "--quiet"], check=True)
        commands = {
            "run, 1 thread": (["run", scene, "--quiet", "--threads", "1"], folder / "output.h5"),
            "run, 2 threads": (["run", scene, "--quiet", "--threads", "2"], folder / "output.h5"),
            "run with layers, 2 threads": (["run", with_layers, "--quiet", "--threads", "2"], folder / "output.h5"),
            "cloud import": (["cloud", "import", les], folder / "output.vdb"),
            "render": (["render", result], folder / "output.png"),
        }
        for title, (arguments, output) in commands.items():
            print(f"{title}\n{'MB':>6s} {'exit':>5s}  message")
            ends = set()
            for megabytes in range(options.first, options.to + 1, options.step):
                output.unlink(missing_ok=True)
                code, lines = run([options.cloudbow, *map(str, arguments), "-o", str(output)], megabytes, options.group)
                wrong = fault(code, lines, output)
                faults += wrong != ""
                ends.add(code)
                print(f"{megabytes:6d} {code!s:>5s}  {'FAIL ' + wrong + ': ' if wrong else ''}{lines[0] if lines else 'the result'}", flush=True)
            if 0 not in ends:
                print("FAIL no limit was wide enough: nothing was shown")
                faults += 1
        left = [path.name for path in folder.iterdir() if path.name.startswith(".")]
        if left:
            print("FAIL left behind:", ", ".join(left))
            faults += 1
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
