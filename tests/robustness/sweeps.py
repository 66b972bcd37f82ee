#!/usr/bin/env python3
"""A sweep has the bits of its single runs. Killed and started again, it ends with the same file.

Sweeps are killed (SIGKILL, every fourth time SIGTERM) at random moments and started again until they end. Then come results of other scenes and damaged
ones, a run that fails, and runs that do not converge.

Truth: `cloudbow run` of each scene, and an undisturbed sweep. All values and attributes have the same bits, apart from times and memory.

usage: sweeps.py --cloudbow PROGRAM [--kills N] [--seed S]
"""
import argparse
import itertools
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

import sound_scene

SCENE = sound_scene.SCENE + """\
[output]
fields = ["fluxes", "absorption"]
"""
ZENITHS, ALBEDOS = (0, 40, 70), (0.0, 0.3)
LISTS = ["--set", "sun.zenith_deg=0,40,70", "--set", "surface.albedo=0.0:0.3:0.3"]


def is_measured(name):
    return "seconds" in name or name.endswith(("peak_memory_bytes", "history", "threads"))


def contents(path):
    """All values and attributes of a file by name, but for what is measured."""
    found = {}

    def add(name, item):
        if isinstance(item, h5py.Dataset) and not is_measured(name):
            value = item[()]
            found[name] = [v.decode() for v in value.ravel()] if value.dtype == object else value
        for key, value in item.attrs.items():
            if key not in ("DIMENSION_LIST", "REFERENCE_LIST") and not is_measured(key):
                found[f"{name}@{key}"] = value
    with h5py.File(path) as file:
        add("", file)
        file.visititems(add)
    return found


def bits(value):
    return np.asarray(value).tobytes() if not isinstance(value, (list, str)) else str(value).encode()


def differences(here, truth):
    return sorted(set(here) ^ set(truth)) + [name for name in truth if name in here and bits(here[name]) != bits(truth[name])]


class Checker:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.output, self.parts = folder / "output.h5", folder / "output.h5.parts"
        self.faults = []

    def command(self, *more, lists=LISTS, scene="scene.toml"):
        return [self.program, "sweep", str(self.folder / scene), "-o", str(self.output), *lists, *map(str, more)]

    def sweep(self, *more, **others):
        return subprocess.run(self.command(*more, **others), capture_output=True, text=True, timeout=300)

    def expect(self, name, good, found=""):
        print(f"{'ok' if good else 'FAIL':5s}{name}: {found}", flush=True)
        if not good:
            self.faults.append(f"{name}: {found}")

    def single_runs(self):
        """Values of the sweep against those of each run."""
        sweep, wrong = h5py.File(self.output), []
        for (i, zenith), (j, albedo) in itertools.product(enumerate(ZENITHS), enumerate(ALBEDOS)):
            single = self.folder / "single.h5"
            subprocess.run([self.program, "run", str(self.folder / "scene.toml"), "--quiet", "-o", str(single), "--set", f"sun.zenith_deg={zenith}", "--set", f"surface.albedo={albedo}"], check=True)
            with h5py.File(single) as run:
                def look(name, item):
                    if isinstance(item, h5py.Group):
                        for key, value in item.attrs.items():
                            other = sweep[name].attrs[key] if key in sweep[name].attrs else sweep[name][key][i, j]
                            if not is_measured(key) and bits(other) != bits(value):
                                wrong.append(f"{zenith} {albedo} {name}@{key}")
                        return
                    other = sweep[name][()]
                    if name == "solar_zenith_angle":
                        other = other[i]
                    elif other.ndim == item.ndim + 2:
                        other = other[i, j]
                    if other.tobytes() != item[()].tobytes():
                        wrong.append(f"{zenith} {albedo} {name}")
                run.visititems(look)
        sweep.close()
        self.expect("bits of the single runs", not wrong, ", ".join(wrong[:5]))

    def chain(self, draw, seconds, kills_left):
        """One sweep, killed until it ends or `kills_left` kills are done. Returns the kills."""
        self.output.unlink(missing_ok=True)
        shutil.rmtree(self.parts, ignore_errors=True)
        kills = most = 0
        while True:
            process = subprocess.Popen(self.command("--jobs", draw.choice((1, 2))), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            if kills < kills_left:
                time.sleep(draw.uniform(0, 0.7 * seconds))
                process.send_signal(signal.SIGTERM if draw.random() < 0.25 else signal.SIGKILL)
            message = process.communicate(timeout=300)[1]
            if process.returncode == 0:
                break
            kills += 1
            most = max(most, len(list(self.parts.glob("run-*.h5"))))
            if self.output.exists():  # killed between its last two steps, the file and the removal of the parts
                break
            if process.returncode not in {-signal.SIGKILL, -signal.SIGTERM, 128 + signal.SIGTERM}:
                self.expect("killed sweep", False, f"exit code {process.returncode}: {message.strip()}")
                return kills
        wrong = differences(contents(self.output), self.truth)
        self.expect(f"after {kills} kills, up to {most} runs kept", not wrong and (process.returncode != 0 or not self.parts.exists()), ", ".join(wrong[:5]))
        shutil.rmtree(self.parts, ignore_errors=True)
        return kills

    def interrupted(self, least=1, **others):
        """A sweep that is ended after so many runs."""
        process = subprocess.Popen(self.command(**others), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None and len(list(self.parts.glob("run-*.h5"))) < least:
            time.sleep(0.002)
        process.kill()
        process.wait()
        return sorted(self.parts.glob("run-*.h5"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    draw = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="cloudbow-sweeps-") as name:
        folder = Path(name)
        make = [options.cloudbow, "cloud", "make", "cumulus", "--cells", "24", "24", "12", "--voxel-size-m", "50", "50", "50", "--cover", "0.3", "--seed", "1", "-o"]
        subprocess.run([*make, str(folder / "cloud.vdb")], check=True, stdout=subprocess.DEVNULL)
        (folder / "scene.toml").write_text(SCENE)
        checker = Checker(options.cloudbow, folder)
        checker.sweep()  # tables from nothing
        start = time.monotonic()
        done = checker.sweep()
        seconds = time.monotonic() - start
        checker.expect("undisturbed sweep", done.returncode == 0 and not checker.parts.exists(), f"{seconds:.2f} s {done.stderr if done.returncode else ''}")
        checker.truth = contents(checker.output)
        checker.single_runs()
        for more in (["--jobs", 3], ["--threads", 1]):
            checker.sweep(*more)
            checker.expect(f"the same with {more[0]} {more[1]}", not differences(contents(checker.output), checker.truth))
        kills = 0
        while kills < options.kills:
            kills += max(1, checker.chain(draw, seconds, min(options.kills - kills, 6)))
        checker.output.unlink()

        # Results of another scene are not taken for those of this one, and they stay.
        (folder / "other.toml").write_text(SCENE.replace("0.99", "0.9"))
        others = checker.interrupted(2, scene="other.toml")
        done = checker.sweep()
        checker.expect("parts of another scene", done.returncode == 0 and "runs were done" not in done.stderr and not differences(contents(checker.output), checker.truth), done.stderr.splitlines()[0])
        checker.expect("they stay", others == sorted(checker.parts.glob("run-*.h5")) and f"{len(others)} finished runs of other sweeps stay" in done.stderr)
        shutil.rmtree(checker.parts)
        checker.output.unlink()
        # Those of the same one that are damaged are not taken either.
        kept = checker.interrupted(2)
        kept[0].write_bytes(kept[0].read_bytes()[:-100])
        done = checker.sweep()
        checker.expect("a damaged part", done.returncode == 0 and f"{len(kept) - 1} of 6 runs were done" in done.stderr and not differences(contents(checker.output), checker.truth),
                       done.stderr.splitlines()[0])
        checker.output.unlink()
        # A sweep with more values takes over what it has in common with the one before.
        kept = checker.interrupted(2)
        done = checker.sweep(lists=["--set", "sun.zenith_deg=0,20,40,70", *LISTS[2:]])
        checker.expect("more values", done.returncode == 0 and f"{len(kept)} of 8 runs were done" in done.stderr, done.stderr.splitlines()[0])
        with h5py.File(checker.output) as more:
            checker.expect("the same values in it", more["upwelling_flux"][[0, 2, 3]].tobytes() == checker.truth["upwelling_flux"].tobytes())
        checker.output.unlink()

        # A run whose result can't be written fails; the others stand.
        kept = checker.interrupted()
        kept[0].unlink()
        kept[0].mkdir()
        (kept[0] / "in the way").touch()
        done = checker.sweep()
        with h5py.File(checker.output) as file:
            codes, flux = file["runs/exit_code"][()], file["upwelling_flux"][()]
            message = [text.decode() for text in file["runs/message"][()].ravel()]
        failed = codes == 2
        checker.expect("a run that fails", done.returncode == 2 and failed.sum() == 1 and (codes[~failed] == 0).all() and np.isnan(flux[failed]).all() and not np.isnan(flux[~failed]).any()
                       and kept[0].name in "".join(message), done.stderr.splitlines()[-1])
        shutil.rmtree(kept[0])
        done = checker.sweep()
        checker.expect("after it was mended", done.returncode == 0 and "5 of 6 runs were done" in done.stderr and not differences(contents(checker.output), checker.truth), done.stderr.splitlines()[0])
        checker.output.unlink()
        done = checker.sweep("--set", "solver.max_sweeps=3,100")
        with h5py.File(checker.output) as file:
            codes, converged = file["runs/exit_code"][()], file["solver/converged"][()]
        checker.expect("runs that do not converge", done.returncode == 3 and (codes[..., 0] == 3).all() and (codes[..., 1] == 0).all() and (converged == (codes == 0)).all()
                       and "max_sweeps=3: not converged" in done.stderr, done.stderr.splitlines()[-1])
        checker.output.unlink()

        for name, more, words in [("a value out of range, the last of all", ["--set", "sun.irradiance_w_m2=1,-1"], ["irradiance_w_m2"]),
                                  ("keys that change the grid", ["--set", "domain.max_m=[1200.0,1200.0,600.0],[1800.0,1200.0,600.0]"], ["another x"]),
                                  ("another output", ["--set", 'output.fields=["fluxes"],["fluxes","radiance_field"]'], ["other outputs"]),
                                  ("a cloud that is not there", ["--set", "cloud.file=cloud.vdb,none.vdb"], ["none.vdb"])]:
            done = checker.sweep("--quiet", *more)
            good = done.returncode == 2 and len(done.stderr.splitlines()) == 1 and all(word in done.stderr for word in words) and not checker.output.exists() and not checker.parts.exists()
            checker.expect(name, good, f"exit code {done.returncode}, {done.stderr.strip()}")
        cloud = (folder / "cloud.vdb").read_bytes()
        done = subprocess.run([options.cloudbow, "sweep", str(folder / "scene.toml"), *LISTS, "-o", str(folder / "cloud.vdb")], capture_output=True, text=True)
        checker.expect("an output over the cloud", done.returncode == 2 and (folder / "cloud.vdb").read_bytes() == cloud, done.stderr.strip())
        checker.expect("nothing is left", sorted(path.name for path in folder.iterdir()) == ["cloud.vdb", "other.toml", "scene.toml", "single.h5"], sorted(path.name for path in folder.iterdir()))
    print("\n" + "\n".join(checker.faults or ["sweeps have the bits of single runs, killed or not"]))
    return 1 if checker.faults else 0


if __name__ == "__main__":
    sys.exit(main())
