#!/usr/bin/env python3
"""A run that is killed goes on from its checkpoint. It ends with the same bits as one that was left alone.

Runs with --checkpoint and --resume are killed at random moments (SIGKILL, every fourth time SIGTERM). They are started again until they end; every variable of what they write is held
against an undisturbed run's, bit by bit. Then what else --resume takes, and what it refuses.

usage: resume.py --cloudbow PROGRAM [--kills N] [--seed S]
"""
import argparse
import random
import signal
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

import sound_scene

SCENE = sound_scene.SCENE + """\
tolerance = 1e-6
[output]
error_estimate = false
"""


def variables(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.__setitem__(name, item[()]) if isinstance(item, h5py.Dataset) else None)
    return found


def differences(path, truth):
    """Names of variables that are not the same bits."""
    here = variables(path)
    return sorted(set(here) ^ set(truth)) + [name for name in truth if name in here and np.asarray(here[name]).tobytes() != np.asarray(truth[name]).tobytes()]


def told(done):
    return "; ".join(line for line in done.stderr.splitlines() if line.startswith("cloudbow: "))


def with_spoiled_records(whole, path):
    """Checkpoints with a spoiled list of the chunks of the radiance: (name, bytes). No checksum covers this list, and HDF5 crashes on some of them.

    HDF5 1.8 lists chunks in nodes "TREE" (its file format specification, III.A.1). A record is size, filters left out, first indices and address.
    """
    with h5py.File(path) as file:
        chunks = file["radiance"].id
        stored = [chunks.get_chunk_info(n) for n in range(chunks.get_num_chunks())]
    assert len(stored) >= 6
    layout = "<IIQQQQ"
    places = []
    for chunk in stored:
        record = struct.pack(layout, chunk.size, chunk.filter_mask, *chunk.chunk_offset, 0, chunk.byte_offset)
        assert whole.count(record) == 1
        places.append(whole.index(record))
    size_at, filters_at, address_at = 0, 4, 32

    def spoiled(*changes):
        content = bytearray(whole)
        for record, at, form, value in changes:
            struct.pack_into(form, content, places[record] + at, value)
        return bytes(content)

    small, large, filters, fletcher32, address = 1, 0xb03e4d87, 0x5770, 1, 0xabae_0000_0000_2633
    yield "a chunk of one byte", spoiled((1, size_at, "<I", small))
    yield "a chunk of no bytes", spoiled((1, size_at, "<I", 0))
    yield "a chunk smaller than its checksum", spoiled((1, size_at, "<I", 3))
    yield "a chunk of 3 GB", spoiled((2, size_at, "<I", large))
    yield "a chunk of 3 GB without its filter", spoiled((2, size_at, "<I", large), (2, filters_at, "<I", filters | fletcher32))
    yield "a chunk beyond the file's end", spoiled((3, address_at, "<Q", address))
    yield "a chunk at the file's end", spoiled((3, address_at, "<Q", len(whole) - 8))
    yield "several spoiled records", spoiled((1, size_at, "<I", small), (3, address_at, "<Q", address), (4, size_at, "<I", large), (4, filters_at, "<I", filters))


class Checker:
    def __init__(self, program, folder):
        self.program = program
        self.folder = folder
        self.output = folder / "output.h5"
        self.checkpoint = folder / "state.h5"
        self.faults = []

    def command(self, *more):
        return [self.program, "run", str(self.folder / "scene.toml"), "-o", str(self.output), *map(str, more)]

    def run(self, *more):
        return subprocess.run(self.command(*more), capture_output=True, text=True, timeout=120)

    def expect(self, name, good, found=""):
        print(f"{'ok' if good else 'FAIL':5s}{name}: {found}", flush=True)
        if not good:
            self.faults.append(f"{name}: {found}")

    def chain(self, draw, seconds, kills_left, truth):
        """One run, killed until it ends or `kills_left` kills are done. Returns the kills."""
        self.output.unlink(missing_ok=True)
        self.checkpoint.unlink(missing_ok=True)
        kept = ["--checkpoint", self.checkpoint, "--checkpoint-every", 0, "--resume", self.checkpoint]
        kills = 0
        while True:
            process = subprocess.Popen(self.command(*kept), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            if kills < kills_left:
                time.sleep(draw.uniform(0, 1.2 * seconds))
                gentle = draw.random() < 0.25
                process.send_signal(signal.SIGTERM if gentle else signal.SIGKILL)
            message = process.communicate(timeout=120)[1]
            if process.returncode == 0:
                break
            kills += 1
            allowed = {-signal.SIGKILL, -signal.SIGTERM, 128 + signal.SIGTERM}  # a second before its guard stands, SIGTERM ends it at once
            if process.returncode not in allowed:
                self.expect("killed run", False, f"exit code {process.returncode}: {message.strip()}")
                return kills
            if self.output.exists():
                wrong = differences(self.output, truth)
                if wrong:
                    self.expect("output of a killed run", False, ", ".join(wrong))
        wrong = differences(self.output, truth)
        self.expect(f"ends after {kills} kills", not wrong, "the same bits" if not wrong else ", ".join(wrong))
        return kills


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    draw = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="cloudbow-resume-") as name:
        folder = Path(name)
        make = [options.cloudbow, "cloud", "make", "cumulus", "--cells", "40", "40", "24", "--voxel-size-m", "50", "50", "50", "--cover", "0.3", "--seed", "1", "-o"]
        subprocess.run([*make, str(folder / "cloud.vdb")], check=True, stdout=subprocess.DEVNULL)
        (folder / "scene.toml").write_text(SCENE)
        checker = Checker(options.cloudbow, folder)
        checker.run()  # tables from nothing
        start = time.monotonic()
        done = checker.run()
        seconds = time.monotonic() - start
        checker.expect("undisturbed run", done.returncode == 0, f"{seconds:.2f} s")
        truth = variables(checker.output)

        kills = 0
        while kills < options.kills:
            kills += max(1, checker.chain(draw, seconds, min(options.kills - kills, 8), truth))
        left = sorted(path.name for path in folder.iterdir())
        print(f"{kills} kills; in the folder: {', '.join(left)}")

        # The last chain left the state of a finished iteration.
        done = checker.run("--resume", checker.checkpoint, "--threads", 1)
        checker.expect("from the end of the iteration", done.returncode == 0 and "goes on after sweep" in done.stderr and not differences(checker.output, truth), told(done))
        checker.output.unlink()
        done = checker.run("--resume", checker.checkpoint, "--set", "sun.zenith_deg=59")
        checker.expect("with another sun", done.returncode == 0 and "begins with the light" in done.stderr, told(done))
        checker.output.unlink()
        # The same voxels, so the same layout; the second constituent is part of the problem.
        optics = 'file = "cloud.vdb", single_scattering_albedo = 0.99, phase_function = "droplets"'
        both = "cloud=[" + ", ".join(f'{{name = "{name}", scale = {scale}, {optics}}}' for name, scale in (("liquid", "1.0"), ("ice", "0.125"))) + "]"
        done = checker.run("--resume", checker.checkpoint, "--set", both)
        checker.expect("with a second constituent", done.returncode == 0 and "begins with the light" in done.stderr, told(done))
        done = checker.run("--checkpoint", folder / "both.h5", "--set", both)
        done = checker.run("--resume", folder / "both.h5", "--set", both)
        checker.expect("with the same two constituents", done.returncode == 0 and "goes on after sweep" in done.stderr, told(done))
        done = checker.run("--resume", folder / "both.h5", "--set", both, "--set", "cloud.1.single_scattering_albedo=0.98")
        checker.expect("with another albedo of the second", done.returncode == 0 and "begins with the light" in done.stderr, told(done))
        checker.output.unlink()

        whole = checker.checkpoint.read_bytes()
        damaged = folder / "damaged.h5"
        at = len(whole) // 2
        damaged.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:])
        cut = folder / "cut.h5"
        cut.write_bytes(whole[:at])
        refused = [("a checkpoint that is not there", ["--resume", folder / "none.h5"], ["none.h5", "no such file"]),
                   ("a damaged checkpoint", ["--resume", damaged], ["damaged.h5", "checkpoint"]),
                   ("half a checkpoint", ["--resume", cut], ["cut.h5", "checkpoint"]),
                   ("a result as checkpoint", ["--resume", folder / "result.h5"], ["result.h5", "checkpoint"]),
                   ("a checkpoint of another level", ["--resume", checker.checkpoint, "--set", "solver.accuracy=balanced"], ["state.h5", "solver.accuracy"]),
                   ("a checkpoint of another domain", ["--resume", checker.checkpoint, "--set", "domain.boundary=open"], ["state.h5", "domain"]),
                   ("a checkpoint under the result's name", ["--checkpoint", checker.output], ["output.h5", "result"]),
                   ("a checkpoint in no folder", ["--checkpoint", folder / "nowhere" / "state.h5"], ["nowhere"]),
                   ("a checkpoint over the scene", ["--checkpoint", folder / "scene.toml"], ["scene.toml"]),
                   ("a time without checkpoint", ["--checkpoint-every", 1], ["--checkpoint"]),
                   ("a negative time", ["--checkpoint", checker.checkpoint, "--checkpoint-every", -1], ["--checkpoint-every", ">= 0"]),
                   ("checkpoints of a wanted error", ["--checkpoint", checker.checkpoint, "--target-error", "1%"], ["--checkpoint", "--target-error"])]
        for number, (name, content) in enumerate(with_spoiled_records(whole, checker.checkpoint)):
            spoiled = folder / f"spoiled_{number}.h5"
            spoiled.write_bytes(content)
            refused.append((f"a checkpoint with {name}", ["--resume", spoiled], [spoiled.name]))
        checker.run()
        checker.output.rename(folder / "result.h5")
        for name, more, words in refused:
            done = checker.run("--quiet", *more)
            message = done.stderr.strip()
            good = done.returncode == 2 and len(message.splitlines()) == 1 and all(word in message for word in words) and not checker.output.exists()
            checker.expect(name, good, f"exit code {done.returncode}, {message}")
        checker.expect("the scene is untouched", (folder / "scene.toml").read_text() == SCENE)
    print("\n" + "\n".join(checker.faults or ["killed runs end with the bits of runs that were left alone"]))
    return 1 if checker.faults else 0


if __name__ == "__main__":
    sys.exit(main())
