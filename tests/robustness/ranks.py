#!/usr/bin/env python3
"""A run by several processes has the bits of one process: solves in parts that are merged, and ranks of mpirun.

Truth: `cloudbow run` in one process. All values and attributes have the same bits, apart from times, memory and history. Errors are one message. A job of
which a rank is killed ends, and leaves no result.

usage: ranks.py --cloudbow PROGRAM [--mpirun MPIRUN] [--ranks 1 2 3 4] [--kills N] [--seed S] [--scenes FILE.toml[+key=value...] ...]
"""
import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import made_gas_files
import sound_scene
from sweeps import contents, differences

SPECTRUM = sound_scene.SCENE.replace("scale = 1.0", "scale = [1.0, 1.3, 0.8, 2.0, 0.5]") + """\
[spectrum]
wavelengths_um = [0.5, 0.6, 0.7, 0.9, 1.1]
[output]
fields = ["fluxes", "absorption"]
error_estimate = true
"""
BROADBAND = sound_scene.SCENE.replace("zenith_deg = 60.0", "zenith_deg = 60.0\nirradiance_w_m2 = 1361.0") + """\
[atmosphere]
standard = "us-1976"
h2o = 1e-3
o3 = 1e-7
[spectrum]
gas_model = "sun.nc"
method = "all"
"""
SECONDS_TO_END = 5  # of a job of which a rank was killed
MOST_HANGS = 3


class Checker:
    def __init__(self, options, folder):
        self.program, self.mpirun, self.folder = str(Path(options.cloudbow).resolve()), options.mpirun, folder
        self.faults = []

    def expect(self, name, good, found=""):
        print(f"{'ok' if good else 'FAIL':5s}{name}{': ' if found else ''}{found}", flush=True)
        if not good:
            self.faults.append(name)

    def command(self, ranks, *words):
        launcher = [self.mpirun, "-n", str(ranks), "--oversubscribe", "--allow-run-as-root", "--quiet"] if ranks > 0 else []
        return [*launcher, self.program, *map(str, words)]

    def call(self, *words, ranks=0):
        return subprocess.run(self.command(ranks, *words), capture_output=True, text=True, timeout=300, cwd=self.folder)

    def succeed(self, *words, ranks=0):
        done = self.call(*words, ranks=ranks)
        if done.returncode not in (0, 3):
            self.expect(" ".join(map(str, words)), False, f"exit code {done.returncode}: {done.stderr.strip()}")
        return done

    def expect_same(self, name, output, truth):
        if not Path(output).exists():
            return self.expect(name, False, "no result")
        wrong = differences(contents(output), truth)
        self.expect(name, not wrong, ", ".join(wrong[:5]))

    def expect_refused(self, name, words, sentence, ranks=0):
        done = self.call(*words, ranks=ranks)
        lines = [line for line in done.stderr.splitlines() if line.startswith("cloudbow:")]
        self.expect(name, done.returncode == 2 and len(lines) == 1 and sentence in lines[0], done.stderr.strip())

    def truth_of(self, *words):
        output = self.folder / "truth.h5"
        self.succeed(*words, "--quiet", "--threads", 1, "-o", output)
        return contents(output)


def check_parts(checker, scene, truth):
    """Parts of a run, and what is refused of them."""
    folder, output = checker.folder, checker.folder / "joined.h5"
    for number in (2, 3, 1):
        checker.succeed("run", scene, "--quiet", "--part", f"{number}/3", "-o", output)
        checker.expect(f"part {number} alone makes no result", not output.exists())
    parts = [folder / f"joined.h5.part-{number}-of-3" for number in (1, 2, 3)]
    checker.succeed("merge", "--quiet", *parts)
    checker.expect_same("parts have the bits of one run", output, truth)
    checker.expect_refused("a missing part", ["merge", parts[0], parts[2], "-o", "other.h5"], "part 2 of 3 is missing")
    checker.expect_refused("a part twice", ["merge", *parts, parts[1], "-o", "other.h5"], "found it twice")
    whole = parts[1].read_bytes()
    for name, spoiled in (("shorter", whole[:-9]), ("other bytes", whole[:len(whole) // 2] + b"x" + whole[len(whole) // 2 + 1:]), ("empty", b"")):
        parts[1].write_bytes(spoiled)
        checker.expect_refused(f"a damaged part, {name}", ["merge", *parts, "-o", "other.h5"], "can't be read as a part")
    parts[1].write_bytes(whole)
    text = (folder / scene).read_text()
    (folder / scene).write_text(text.replace("zenith_deg = 60.0", "zenith_deg = 61.0"))
    checker.expect_refused("another scene", ["merge", *parts, "-o", "other.h5"], "has changed since")
    (folder / scene).write_text(text)
    checker.expect("nothing is written by refused merges", not (folder / "other.h5").exists())
    checker.expect_refused("one solve", ["run", "scene.toml", "--part", "1/2"], "nothing to share out")
    checker.expect_refused("no share", ["run", scene, "--part", "3/2"], "--part: found '3/2'")
    checker.expect_refused("a target beside a part", ["run", scene, "--part", "1/2", "--target-error", "1%"], "excludes --target-error")


def check_ranks(checker, ranks, name, words, truth):
    for number in ranks:
        output = checker.folder / f"ranks-{number}.h5"
        output.unlink(missing_ok=True)
        checker.succeed(*words, "--quiet", "-o", output, ranks=number)
        checker.expect_same(f"{name}: {number} ranks have the bits of one process", output, truth)


def check_messages(checker):
    checker.expect_refused("a scene that is wrong for all ranks", ["run", "scene.toml", "--set", "sun.zenith_deg=100"], "sun.zenith_deg", ranks=2)
    checker.expect_refused("a command of one process", ["verify"], "is a command of one process", ranks=2)
    checker.expect_refused("a target", ["run", "scene.toml", "--target-error", "1%"], "excludes --target-error", ranks=2)
    checker.expect_refused("a part", ["run", "spectrum.toml", "--part", "1/2"], "excludes mpirun", ranks=2)
    checker.expect_refused("a share of a sweep", ["sweep", "scene.toml", "--set", "sun.zenith_deg=0,40", "-o", "s.h5", "--share", "1/2"], "excludes mpirun", ranks=2)
    # As mpiexec of another MPI starts them: each is alone.
    for scene in ("scene.toml", "spectrum.toml"):
        done = subprocess.run([checker.program, "run", scene, "-o", "alone.h5"], env={**os.environ, "PMI_SIZE": "3"}, capture_output=True, text=True, timeout=60,
                              cwd=checker.folder)
        checker.expect(f"processes that do not find each other, {scene}", done.returncode == 2 and "found 1 of 3" in done.stderr and
                       len(done.stderr.splitlines()) == 1 and not (checker.folder / "alone.h5").exists(), done.stderr.strip())
    # The scene is sound, and its second wavelength fails while it is solved.
    failing = ["run", "spectrum.toml", "--set", "solver.max_sweeps=1", "-o", "failing.h5"]
    done = checker.call(*failing, "--quiet", ranks=2)
    lines = [line for line in done.stderr.splitlines() if line.startswith("cloudbow:")]
    alone = checker.call(*failing, "--quiet")
    same = [line for line in alone.stderr.splitlines() if line.startswith("cloudbow:")]
    checker.expect("an error of a solve ends as it does in one process", done.returncode == alone.returncode and lines == same, f"{done.returncode} {lines}")


def children_of(process):
    found = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True).stdout.split()
    return [int(pid) for pid in found]


def is_running(processes):
    """Those that are neither gone nor dead and waited for by nobody."""
    def state(pid):
        try:
            return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
        except OSError:
            return "gone"
    return [pid for pid in processes if state(pid) not in ("gone", "Z")]


def check_kills(checker, kills, draw, words):
    """A rank is killed at a random moment: the job ends soon, with an exit code and without a result.

    If a rank is killed within MPI_Init, mpiexec of Open MPI 4.1.4 sometimes does not end, though no rank is left. Another moment is drawn then, at most
    MOST_HANGS times.
    """
    output = checker.folder / "killed.h5"
    start = time.monotonic()
    checker.succeed(*words, "--quiet", "-o", output, ranks=3)
    seconds = time.monotonic() - start
    hangs = 0
    kill = 0
    while kill < kills:
        output.unlink(missing_ok=True)
        process = subprocess.Popen(checker.command(3, *words, "--quiet", "-o", output), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=checker.folder)
        time.sleep(draw.uniform(0.1, 0.8) * seconds)
        ranks = children_of(process)
        rank = draw.choice(ranks) if ranks else None
        killed = time.monotonic()
        if rank is not None:
            try:
                os.kill(rank, signal.SIGKILL)
            except ProcessLookupError:
                rank = None
        try:
            code = process.wait(timeout=120 if rank is None else 2 * SECONDS_TO_END)
        except subprocess.TimeoutExpired:
            if is_running(ranks) or output.exists() or hangs == MOST_HANGS:
                raise
            process.kill()
            process.wait()
            hangs += 1
            print("     mpiexec did not end: another moment")
            continue
        kill += 1
        needed = time.monotonic() - killed
        if rank is None or code == 0:
            print(f"     kill {kill}: came too late")
            continue
        while is_running(ranks) and time.monotonic() - killed < SECONDS_TO_END:
            time.sleep(0.05)
        left = is_running(ranks)
        checker.expect(f"kill {kill}", not output.exists() and needed < SECONDS_TO_END and not left, f"exit code {code}, {needed:.1f} s, result {output.exists()}, left {left}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    parser.add_argument("--mpirun", help="without it, parts of runs alone are checked")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 3, 4])
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", nargs="+", default=[], help="other scenes whose solves ranks share, each with values that follow a +")
    options = parser.parse_args()
    draw = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="cloudbow-ranks-") as name:
        folder = Path(name)
        checker = Checker(options, folder)
        checker.succeed("cloud", "make", "cumulus", "--cells", 16, 16, 10, "--voxel-size-m", 50, 50, 50, "--cover", 0.3, "--seed", 1, "-o", folder / "cloud.vdb")
        (folder / "scene.toml").write_text(sound_scene.SCENE)
        (folder / "spectrum.toml").write_text(SPECTRUM)
        spectrum = ["run", "spectrum.toml", "--compare"]
        truth = checker.truth_of("run", "spectrum.toml")
        check_parts(checker, "spectrum.toml", truth)
        if options.mpirun:
            check_ranks(checker, options.ranks, "spectrum", spectrum, checker.truth_of(*spectrum))
            single = ["run", "scene.toml"]
            check_ranks(checker, options.ranks, "one solve", single, checker.truth_of(*single))
            made_gas_files.write_gas_model(folder / "sun.nc", "solar")
            (folder / "broadband.toml").write_text(BROADBAND)
            broadband = ["run", "broadband.toml", "--clear-sky"]
            check_ranks(checker, options.ranks, "g-points", broadband, checker.truth_of(*broadband))
            sweep = ["sweep", "scene.toml", "--set", "sun.zenith_deg=0:80:20"]
            check_ranks(checker, options.ranks, "sweep", sweep, checker.truth_of(*sweep))
            for words in options.scenes:
                scene, *changes = words.split("+")
                command = ["run", Path(scene).resolve(), *(word for change in changes for word in ("--set", change))]
                check_ranks(checker, options.ranks, words, command, checker.truth_of(*command))
            check_messages(checker)
            for words in (spectrum, single + ["--set", "solver.accuracy=balanced"]):
                check_kills(checker, options.kills, draw, words)
    if checker.faults:
        sys.exit(f"{len(checker.faults)} faults")


if __name__ == "__main__":
    main()
