#!/usr/bin/env python3
"""Faults from outside of a run: it is killed, its disk is full, its folder or its input goes away, another run writes the same file.

Parts:
  kills     SIGKILL at random moments, half of them spread over the whole run, half over the writing of the file; every other one over an older result,
            every fourth with an empty cache. Under the name is nothing, the older result with all its bytes, or the whole new one. Files left behind are not named as a result is; the run afterwards ends with the bits of an undisturbed one. It removes what killed runs have left and nothing else.
  disks     a file system with too little room for the result (a tmpfs in a mount namespace of its own; a limit of the size of files if the system permits no such thing): exit code 2, one message, nothing under the name but what was there; with enough room the result.
  streams   stdout or stderr on a full disk.
  folders   a folder without leave to write, a folder that vanishes while the run solves or writes.
  inputs    scene and cloud removed or cut while the run reads and solves: the result of an undisturbed run, or exit code 2 and one message.
  together  two runs write one file: it is the result of one of them.
  over      an older result is there, whole, until the new one is.

Truth: the undisturbed run, whose numbers are the same bits each time (seconds and memory are not compared), and what exit codes mean (`cloudbow --help`).

usage: faults.py --cloudbow PROGRAM [--part kills ...] [--kills 100] [--disks 20] [--seed 1]
"""
import argparse
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

import sound_scene

SCENE = sound_scene.SCENE + """\
control_points = 162
[output]
error_estimate = false
fields = ["fluxes", "absorption", "radiance_field"]
"""
CELLS = (32, 32, 12)  # half a second of solving, some megabytes of result
UNLIKE = re.compile("seconds|memory|history|scene")  # attributes that may differ between equal runs
TEMPORARY = re.compile(r"^\.[^/]+\.(\d+)-\d+\.tmp$")  # with the number of the process
NOBODY = 65534


@dataclass(frozen=True)
class Protocol:
    """How a run is started that will be killed, and how the one afterwards. That must end with the bits of an undisturbed run."""
    name: str
    first: tuple = ()
    again: tuple = ()


# A way to go on with a killed run is another line here.
PROTOCOLS = (Protocol("run again"),)


def content(path):
    """All numbers and attributes of a result that equal runs share; raises OSError if the file is not whole."""
    found = {}

    def attributes(name, node):
        for key, value in node.attrs.items():
            if UNLIKE.search(key) or key in ("DIMENSION_LIST", "REFERENCE_LIST"):
                continue
            found[f"{name}@{key}"] = np.asarray(value).tobytes()

    def visit(name, node):
        attributes(name, node)
        if isinstance(node, h5py.Dataset):
            found[name] = np.asarray(node[...]).tobytes()
    with h5py.File(path, "r") as file:
        attributes("/", file)
        file.visititems(visit)
    return found


class Bench:
    """A folder with a scene, the undisturbed result, and what went wrong so far."""

    def __init__(self, program, folder, seed):
        self.program = str(Path(program).resolve())
        self.folder = folder
        self.random = random.Random(seed)
        self.faults = []
        self.environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
        self.scene, self.cloud = folder / "scene.toml", folder / "cloud.vdb"
        subprocess.run([self.program, "cloud", "make", "stratocumulus", "--cells", *map(str, CELLS), "--voxel-size-m", "50", "50", "25", "--seed", "3",
                        "-o", str(self.cloud)], check=True, stdout=subprocess.DEVNULL)
        self.scene.write_text(SCENE)
        self.undisturbed = folder / "undisturbed.h5"
        for _ in range(2):  # the second with its tables made
            start = time.monotonic()
            subprocess.run(self.command(self.undisturbed), check=True, env=self.environment)
            self.seconds = time.monotonic() - start
        self.truth = content(self.undisturbed)
        self.size = self.undisturbed.stat().st_size
        # An older result is one of another sun.
        self.older = folder / "older.h5"
        subprocess.run(self.command(self.older, "--set", "sun.zenith_deg=30", "--set", 'output.fields=["fluxes"]'), check=True, env=self.environment)
        print(f"an undisturbed run takes {self.seconds:.2f} s and makes {self.size / 1e6:.1f} MB", flush=True)

    def command(self, output, *options, quiet=True):
        return [self.program, "run", str(self.scene), "-o", str(output), *(["--quiet"] if quiet else []), *map(str, options)]

    def check(self, good, what):
        if not good:
            print(f"FAIL  {what}", flush=True)
            self.faults.append(what)
        return good

    def fresh(self, name):
        folder = self.folder / name
        if folder.exists():
            shutil.rmtree(folder)
        folder.mkdir()
        return folder

    def state(self, path, older):
        """Content of the name of a result."""
        if not path.exists():
            return "nothing"
        if older and path.read_bytes() == self.older.read_bytes():
            return "the older one"
        try:
            return "the new one" if content(path) == self.truth else "another result"
        except OSError as error:
            return f"a broken file ({error})"

    def check_refusal(self, what, code, text):
        """Exit code 2 and one message; progress may stand before it."""
        messages = [line for line in text.splitlines() if line.startswith("cloudbow: ")]
        self.check(code == 2, f"{what}: exit code {code} instead of 2: {text.strip()[-300:]}")
        self.check(len(messages) == 1 and "internal error" not in messages[0], f"{what}: not one message: {text.strip()[-300:]}")
        return messages[0] if messages else ""


def writing(folder, process):
    """Whether a temporary file of the process is being filled."""
    try:
        return any((name := TEMPORARY.match(entry.name)) and int(name[1]) == process.pid and entry.stat().st_size > 0 for entry in os.scandir(folder))
    except FileNotFoundError:
        return False


def wait_until(process, condition):
    while process.poll() is None and not condition():
        time.sleep(0.0005)


def write_seconds(bench):
    """How long the result is being written, of an undisturbed run."""
    folder = bench.fresh("measure")
    process = subprocess.Popen(bench.command(folder / "result.h5"), env=bench.environment)
    wait_until(process, lambda: writing(folder, process))
    start = time.monotonic()
    process.wait()
    return time.monotonic() - start


def kills(bench, count):
    seconds_of_writing = write_seconds(bench)
    print(f"of which {seconds_of_writing:.2f} s are spent writing", flush=True)
    for protocol in PROTOCOLS:
        folder = bench.fresh("kills")
        output = folder / "result.h5"
        (folder / "of_others.h5.tmp").write_bytes(b"of others")
        seen, ended, while_writing = Counter(), 0, 0
        for number in range(count):
            older, during_write, cold = number % 2 == 1, number % 4 >= 2, number % 8 >= 6
            output.unlink(missing_ok=True)
            if older:
                shutil.copyfile(bench.older, output)
            if cold:
                shutil.rmtree(folder.parent / "cache", ignore_errors=True)
            process = subprocess.Popen(bench.command(output, *protocol.first), env=bench.environment, stderr=subprocess.DEVNULL)
            if during_write:
                wait_until(process, lambda: writing(folder, process))
                delay = bench.random.uniform(0, 1.05 * seconds_of_writing)
            else:
                delay = bench.random.uniform(0, 1.05 * bench.seconds)
            deadline = time.monotonic() + delay
            wait_until(process, lambda: time.monotonic() >= deadline)
            in_write = writing(folder, process) and process.poll() is None
            process.kill()
            killed = process.wait() == -signal.SIGKILL
            state = bench.state(output, older)
            seen[state] += 1
            ended += not killed
            while_writing += in_write and killed
            allowed = {"the older one" if older else "nothing", "the new one"} if killed else {"the new one"}
            bench.check(state in allowed, f"kill {number} after {delay:.3f} s{' of writing' if during_write else ''}: under the name is {state}")
            for entry in folder.iterdir():
                known = entry.name in ("result.h5", "of_others.h5.tmp") or TEMPORARY.match(entry.name)
                bench.check(known, f"kill {number}: leaves {entry.name}")
        left = {entry.name: entry.read_bytes() for entry in folder.iterdir() if entry.name != "result.h5"}
        print(f"kills, {protocol.name}: {count} runs, {count - ended} killed before their end, {while_writing} of them while writing; under the name: "
              + ", ".join(f"{state} {n} times" for state, n in seen.most_common())
              + f"; left behind: {len(left) - 1} temporary files, {sum(map(len, left.values())) / 1e6:.1f} MB", flush=True)
        done = subprocess.run(bench.command(output, *protocol.again), env=bench.environment, capture_output=True, text=True)
        bench.check(done.returncode == 0 and bench.state(output, False) == "the new one", f"kills: the run afterwards: exit code {done.returncode}, {done.stderr}")
        kept = {entry.name: entry.read_bytes() for entry in folder.iterdir() if entry.name != "result.h5"}
        own = {name: data for name, data in left.items() if not TEMPORARY.match(name)}
        bench.check(kept == own, f"kills: beside the result the run afterwards leaves {', '.join(sorted(kept)) or 'nothing'}")


def can_mount():
    """Whether this user may mount a tmpfs in a namespace of its own."""
    try:
        return subprocess.run(["unshare", "-rm", "mount", "-t", "tmpfs", "tmpfs", "/mnt"], capture_output=True).returncode == 0
    except FileNotFoundError:
        return False


# Files on the small disk are taken in the end out of its namespace.
ON_SMALL_DISK = """\
disk=$1 bytes=$2 older=$3 out=$4; shift 4
mount -t tmpfs -o size=$bytes tmpfs "$disk" || exit 99
if [ -n "$older" ]; then cp "$older" "$disk/result.h5" || exit 99; fi
"$@"; code=$?
cp -a "$disk/." "$out/"
exit $code
"""


def run_on_small_disk(bench, size, older, options=()):
    """Exit code, messages, and the folder with what is there in the end."""
    disk, out = bench.fresh("disk"), bench.fresh("disk_after")
    done = subprocess.run(["unshare", "-rm", "sh", "-c", ON_SMALL_DISK, "sh", str(disk), str(size), str(bench.older) if older else "", str(out),
                           *bench.command(disk / "result.h5", *options)], env=bench.environment, capture_output=True, text=True)
    if done.returncode == 99:
        raise SystemExit(f"no small disk: {done.stderr}")
    return done.returncode, done.stderr, out


def run_with_small_files(bench, size, older, options=()):
    out = bench.fresh("disk_after")
    if older:
        shutil.copyfile(bench.older, out / "result.h5")
    done = subprocess.run(bench.command(out / "result.h5", *options), env=bench.environment, capture_output=True, text=True,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
    return done.returncode, done.stderr, out


def disks(bench, count):
    ways = {"limits of the size of files": run_with_small_files}
    if can_mount():
        ways = {"full tmpfs": run_on_small_disk, **ways}
    else:
        print("disks: no mount namespaces here, so no file system is filled; files are limited in size instead", flush=True)
    for way, run in ways.items():
        seen = Counter()
        for number in range(count):
            older = number % 2 == 1
            # From a page to a little more than is needed.
            size = int(4096 + (1.1 * bench.size - 4096) * number / max(1, count - 1)) // 4096 * 4096
            if older and run is run_on_small_disk:
                size += bench.older.stat().st_size // 4096 * 4096 + 4096
            code, text, out = run(bench, size, older)
            state = bench.state(out / "result.h5", older)
            what = f"{way}, {size} bytes"
            if code == 0:
                bench.check(state == "the new one", f"{what}: exit code 0, and under the name is {state}")
                seen["done"] += 1
            else:
                message = bench.check_refusal(what, code, text)
                bench.check(state == ("the older one" if older else "nothing"), f"{what}: under the name is {state}")
                seen[message.rpartition("(")[2].rstrip(")\n")] += 1
            extra = [entry.name for entry in out.iterdir() if entry.name != "result.h5"]
            bench.check(not extra, f"{what}: leaves {', '.join(extra)}")
        bench.check(seen["done"] < count, f"{way}: no disk was too small")
        print(f"disks: {count} runs, {way}: " + ", ".join(f"{n} {state}" for state, n in seen.most_common()), flush=True)
    # A cache that cannot be kept is done without.
    environment = bench.environment
    cache = bench.fresh("no_room")
    bench.environment = {**environment, "XDG_CACHE_HOME": "/dev/full"}
    code, text, out = run_with_small_files(bench, resource.RLIM_INFINITY, False)
    bench.environment = environment
    bench.check(code == 0 and bench.state(out / "result.h5", False) == "the new one", f"no room for a cache: exit code {code}: {text}")
    shutil.rmtree(cache)


def streams(bench, _):
    """A log that cannot be written is no reason to lose the result; numbers on stdout that cannot, are reported."""
    output = bench.fresh("streams") / "result.h5"
    for name, quiet in (("stderr", False), ("stderr", True)):
        output.unlink(missing_ok=True)
        with open("/dev/full", "w") as full:
            done = subprocess.run(bench.command(output, quiet=quiet), env=bench.environment, stderr=full, stdout=subprocess.DEVNULL)
        bench.check(done.returncode == 0 and bench.state(output, False) == "the new one", f"{name} is full: exit code {done.returncode}")
    output.unlink()
    with open("/dev/full", "w") as full:
        done = subprocess.run(bench.command(output, quiet=False), env=bench.environment, stdout=full, stderr=subprocess.PIPE, text=True)
    bench.check_refusal("stdout is full", done.returncode, done.stderr)
    bench.check(bench.state(output, False) == "the new one", "stdout is full: the result is there all the same")
    with open("/dev/full", "w") as full:
        done = subprocess.run(bench.command(bench.folder / "nowhere/result.h5"), env=bench.environment, stderr=full)
    bench.check(done.returncode == 2, f"stderr is full and the input wrong: exit code {done.returncode}")
    print("streams: 4 runs", flush=True)


def started(bench, output, *options):
    """A run whose solving has begun."""
    process = subprocess.Popen(bench.command(output, *options, quiet=False), env=bench.environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    first = process.stderr.readline()
    return process, first


def folders(bench, count):
    # Without leave to write. To the superuser everything is given leave: there the run is somebody else's.
    folder = bench.fresh("locked")
    folder.chmod(0o555)
    as_nobody = {"user": NOBODY, "group": NOBODY, "extra_groups": []} if os.getuid() == 0 else {}
    if as_nobody:
        bench.folder.chmod(0o755)
    try:
        done = subprocess.run(bench.command(folder / "result.h5"), env=bench.environment, capture_output=True, text=True, **as_nobody)
        bench.check_refusal("a locked folder", done.returncode, done.stderr)
        bench.check(not any(folder.iterdir()), "a locked folder: holds something")
        kind = "locked"
    except PermissionError as error:
        kind = f"not locked ({error})"
    folder.chmod(0o755)

    for number in range(max(2, count)):
        folder = bench.fresh("vanishing")
        during_write = number % 2 == 1
        process, text = started(bench, folder / "result.h5")
        if during_write:
            lines = []
            drain = threading.Thread(target=lambda: lines.extend(process.stderr))  # so that it does not wait for its reader
            drain.start()
            wait_until(process, lambda: writing(folder, process))
            shutil.rmtree(folder, ignore_errors=True)
            process.wait()
            drain.join()
            text = "".join(lines)
        else:
            shutil.rmtree(folder)
            text += process.communicate()[1]
        if process.returncode == 0:  # it was quicker
            bench.check(during_write, "a folder that vanishes before the result is written: exit code 0")
        else:
            bench.check_refusal(f"a folder that vanishes while the run {'writes' if during_write else 'solves'}", process.returncode, text)
        bench.check(not folder.exists() or not any(folder.iterdir()), "a folder that vanished comes back")
    print(f"folders: 1 {kind}, {max(2, count)} vanished", flush=True)


def inputs(bench, count):
    output = bench.fresh("inputs") / "result.h5"
    scene, cloud = bench.scene.read_bytes(), bench.cloud.read_bytes()
    seen = Counter()
    disturbances = {
        "cloud removed": bench.cloud.unlink,
        "cloud cut": lambda: os.truncate(bench.cloud, bench.random.randrange(len(cloud))),
        "scene removed": bench.scene.unlink,
        "scene cut": lambda: os.truncate(bench.scene, bench.random.randrange(len(scene))),
    }
    for number in range(4 * count):
        name = list(disturbances)[number % 4]
        output.unlink(missing_ok=True)
        # Half of them while files are read, half of them later.
        delay = bench.random.uniform(0, 0.1 if number % 8 < 4 else bench.seconds)
        process = subprocess.Popen(bench.command(output), env=bench.environment, stderr=subprocess.PIPE, text=True)
        time.sleep(delay)
        disturbances[name]()
        text = process.communicate()[1]
        if process.returncode == 0:
            state = bench.state(output, False)
            # A scene that is cut between two lines is a scene.
            bench.check(state == "the new one" or name == "scene cut", f"{name} after {delay:.3f} s: exit code 0, and under the name is {state}")
        else:
            bench.check_refusal(f"{name} after {delay:.3f} s", process.returncode, text)
            bench.check(not output.exists(), f"{name}: a result in spite of exit code 2")
        seen[f"{name}: {'done' if process.returncode == 0 else 'told'}"] += 1
        bench.scene.write_bytes(scene)
        bench.cloud.write_bytes(cloud)
    # A run that chooses its level reads the scene for each.
    for name in disturbances:
        output.unlink(missing_ok=True)
        process, text = started(bench, output, "--target-error", "2%")
        disturbances[name]()
        text += process.communicate()[1]
        if process.returncode not in (0, 3):
            bench.check_refusal(f"{name} of a run to a wanted error", process.returncode, text)
        else:
            content(output)
        seen[f"{name}, wanted error: exit code {process.returncode}"] += 1
        bench.scene.write_bytes(scene)
        bench.cloud.write_bytes(cloud)
    print("inputs: " + ", ".join(f"{what} {n}" for what, n in sorted(seen.items())), flush=True)


def together(bench, count):
    seen = Counter()
    for _ in range(count):
        folder = bench.fresh("together")
        output = folder / "result.h5"
        albedos = bench.random.sample(("0.05", "0.06"), 2)
        runs = [subprocess.Popen(bench.command(output, "--threads", 1, "--set", f"surface.albedo={albedo}"), env=bench.environment) for albedo in albedos]
        codes = tuple(run.wait() for run in runs)
        bench.check(codes == (0, 0), f"two runs at once: exit codes {codes}")
        with h5py.File(output) as file:
            seen[next(albedo for albedo in albedos if f"albedo = {albedo}" in file.attrs["scene"].decode())] += 1
            whole = file["radiance_field/radiance"][...]
        bench.check(np.all(np.isfinite(whole)), "two runs at once: the file is not whole")
        bench.check([entry.name for entry in folder.iterdir()] == ["result.h5"], "two runs at once: something is left")
    print("together: " + ", ".join(f"the file is that with surface albedo {which} {n} times" for which, n in seen.items()), flush=True)


def over(bench, _):
    output = bench.fresh("over") / "result.h5"
    shutil.copyfile(bench.older, output)
    older = bench.older.read_bytes()
    process = subprocess.Popen(bench.command(output), env=bench.environment)
    looks = 0
    while process.poll() is None:
        found = output.read_bytes()
        if found != older:
            break
        looks += 1
        time.sleep(0.002)
    # Whatever is seen first in its place is whole, also while the run goes on.
    bench.check(bench.state(output, True) == "the new one", "over: what takes the place of the older result is not whole")
    bench.check(process.wait() == 0, "over: the run fails")
    print(f"over: the older result was there {looks} times, then the new one", flush=True)


PARTS = {"kills": kills, "disks": disks, "streams": streams, "folders": folders, "inputs": inputs, "together": together, "over": over}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    parser.add_argument("--part", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--disks", type=int, default=20, help="sizes of disks")
    parser.add_argument("--moments", type=int, default=10, help="of each disturbance of folders and inputs, and runs two at once")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    counts = {"kills": options.kills, "disks": options.disks}
    with tempfile.TemporaryDirectory(prefix="cloudbow-faults-") as name:
        bench = Bench(options.cloudbow, Path(name), options.seed)
        for part in options.part:
            PARTS[part](bench, counts.get(part, options.moments))
    print("\n" + "\n".join(bench.faults or ["no disturbance breaks a promise"]))
    return 1 if bench.faults else 0


if __name__ == "__main__":
    sys.exit(main())
