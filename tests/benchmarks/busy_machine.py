#!/usr/bin/env python3
"""CPU and wall seconds of a run with one and two threads, beside busy loops of other programs.

Runs go by turns; figures are medians. Two threads must not take more than 1.2 times the CPU seconds of one, nor more wall seconds.
--spin adds runs with other values of GOMP_SPINCOUNT, how often an idle thread looks for work before it sleeps.

usage: busy_machine.py [--cloudbow PROGRAM] [--scene configs/cumulus.toml] [--loops 4] [--rounds 5] [--spin default 100 20000]
"""
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "validation"))
import support  # noqa: E402

MOST_CPU_RATIO = 1.2  # of a run whose threads wait for each other at every sweep
# What GCC's runtime takes if nothing is set.
GCC_DEFAULT = "300000"


def seconds(cloudbow, scene, folder, threads, spin):
    """CPU and wall seconds of one run."""
    environment = {name: value for name, value in os.environ.items() if name not in ("GOMP_SPINCOUNT", "OMP_WAIT_POLICY")}
    if spin:
        environment["GOMP_SPINCOUNT"] = spin
    before, start = os.times(), os.times().elapsed
    subprocess.run([str(cloudbow), "run", str(scene), "-o", str(folder / "result.h5"), "--threads", str(threads), "--quiet"], check=True,
                   env=environment, cwd=folder)
    after = os.times()
    return (after.children_user + after.children_system) - (before.children_user + before.children_system), after.elapsed - start


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--scene", type=Path, default=support.ROOT / "configs/cumulus.toml")
    parser.add_argument("--loops", type=int, default=4, help="busy loops beside the run; 0: an idle machine")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--spin", nargs="*", default=[], help="other values of GOMP_SPINCOUNT; default: what GCC's runtime takes")
    options = parser.parse_args()
    cases = [("one thread", 1, None), ("two threads", 2, None)]
    cases += [(f"two threads, spin {value}", 2, GCC_DEFAULT if value == "default" else value) for value in options.spin]
    found = {name: [] for name, *_ in cases}
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(options.loops)]
    try:
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(options.rounds):
                for name, threads, spin in cases:
                    found[name].append(seconds(options.cloudbow.resolve(), options.scene.resolve(), Path(folder), threads, spin))
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()
    medians = {name: [statistics.median(column) for column in zip(*runs)] for name, runs in found.items()}
    print(support.markdown_table(["run", "CPU s", "wall s"], [[name, f"{cpu:.2f}", f"{wall:.2f}"] for name, (cpu, wall) in medians.items()]))
    one, two = medians["one thread"], medians["two threads"]
    good = two[0] <= MOST_CPU_RATIO * one[0] and two[1] <= one[1]
    print("pass" if good else "FAIL")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
