#!/usr/bin/env python3
"""A run under a limit on its addresses (`ulimit -v`) ends with its result, or with one message and exit code 2; never by a signal.

Truth: what a user may meet under batch systems, which set such limits. A scene of a cloud in a plane is solved under limits that grow by equal
steps; below the first of them the system cannot even load the program's libraries (exit code 127 of the loader), which is not the program's to say.

usage: memory_limits.py --cloudbow PROGRAM [--from MB] [--to MB] [--step MB]
By hand: the defaults are all steps; ctest takes a few.
"""
import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import sound_scene

MEGABYTE = 1_000_000
LOADER = 127  # ld.so could not map a library


def run(command, megabytes):
    """Exit code and lines on stderr of a run that may take so many addresses."""
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (megabytes * MEGABYTE, megabytes * MEGABYTE))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, preexec_fn=limit)
    return done.returncode, [line for line in done.stderr.splitlines() if line.strip()]


def fault(code, lines, output):
    """What is wrong with the end of a run, or nothing."""
    if code == LOADER:
        return "" if not output.exists() else "a result in spite of the loader"
    if code == 0:
        return "" if output.exists() else "no result"
    if code != 2:
        return f"exit code {code}"
    if len(lines) != 1 or not lines[0].startswith("cloudbow: "):
        return f"{len(lines)} lines instead of one message"
    if "damaged" in lines[0] or "internal error" in lines[0]:
        return "the limit is told as another fault"
    return "a result beside the message" if output.exists() else ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    parser.add_argument("--from", type=int, default=100, dest="first")
    parser.add_argument("--to", type=int, default=2000)
    parser.add_argument("--step", type=int, default=50)
    options = parser.parse_args()
    faults, ends = 0, set()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subprocess.run([options.cloudbow, "cloud", "make", "stratocumulus", "--cells", "48", "48", "16", "--voxel-size-m", "50",
                        "50", "25", "--seed", "3", "-o", folder / "cloud.vdb"], check=True, capture_output=True)
        (folder / "scene.toml").write_text(sound_scene.SCENE)
        output = folder / "output.h5"
        print(f"{'MB':>6s} {'exit':>5s}  message")
        for megabytes in range(options.first, options.to + 1, options.step):
            output.unlink(missing_ok=True)
            code, lines = run([options.cloudbow, "run", str(folder / "scene.toml"), "-o", str(output), "--quiet"], megabytes)
            wrong = fault(code, lines, output)
            faults += wrong != ""
            ends.add(code)
            print(f"{megabytes:6d} {code:5d}  {'FAIL ' + wrong + ': ' if wrong else ''}{lines[0] if lines else 'the result'}", flush=True)
        left = [path.name for path in folder.iterdir() if path.name.startswith(".")]
        if left:
            print("FAIL left behind:", ", ".join(left))
            faults += 1
    if 0 not in ends:
        print("FAIL no limit was wide enough for the scene: nothing was shown")
        faults += 1
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
