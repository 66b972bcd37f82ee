"""Shared by the validation drivers: running cloudbow on a scene, reading the result, reporting."""
import argparse
import concurrent.futures
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SKIPPED = 77  # what ctest takes for "skipped"


class Failure(Exception):
    """A run that did not end as it should."""


class Result:
    """A result file, read whole: variables by name, /summary and /solver attributes, and what the process used."""

    def __init__(self, path, exit_code, cpu_seconds, peak_memory_bytes):
        self.exit_code = exit_code
        with h5py.File(path, "r") as file:
            self.fields = {name: node[...] for name, node in file.items() if isinstance(node, h5py.Dataset)}
            self.profile = {name: node[...] for name, node in file["profile"].items()} if "profile" in file else {}
            self.summary = {name: plain(value) for name, value in file["summary"].attrs.items()}
            self.solver = {name: plain(value) for name, value in file["solver"].attrs.items()}
            self.error_estimate = {name: plain(value) for name, value in file["error_estimate"].attrs.items()} if "error_estimate" in file else {}
        # Of a spectrum there is one number a wavelength.
        self.cpu_seconds = float(np.sum(self.solver.get("cpu_seconds", cpu_seconds)))
        self.wall_seconds = float(np.sum(self.solver["seconds_total"]))
        self.peak_memory_bytes = float(np.max(self.solver.get("peak_memory_bytes", peak_memory_bytes)))

    def __getitem__(self, name):
        return self.fields[name].astype(float)

    @property
    def z_edge(self):
        return self.fields["z_edge"]

    def upward_at_top(self):
        return self["upwelling_flux"][-1]

    def downward_at_bottom(self):
        return self["downwelling_diffuse_flux"][0] + self["direct_flux"][0]


def plain(value):
    """An attribute as a Python number or string."""
    if isinstance(value, bytes):
        return value.decode()
    value = np.asarray(value)
    return value.item() if value.size == 1 else value


class Cloudbow:
    def __init__(self, program, threads=None):
        self.program = str(program)
        self.threads = threads

    def call(self, *arguments, check=True, cwd=None):
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, cwd=cwd)
        if check and done.returncode != 0:
            raise Failure(f"cloudbow {' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stderr}")
        return done

    def run(self, scene, output, *options, accept=(0,), error_estimate=False):
        """Solves the scene file and reads the result; without its companions unless error_estimate. A child's own resource use is measured, not that of the whole test."""
        command = [self.program, "run", str(scene), "-o", str(output), "--quiet", *map(str, options)]
        if not error_estimate:
            command += ["--set", "output.error_estimate=false"]
        if self.threads:
            command += ["--threads", str(self.threads)]
        with tempfile.TemporaryFile() as messages:
            child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=messages)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            messages.seek(0)
            text = messages.read().decode(errors="replace")
        if child.returncode not in accept:
            raise Failure(f"{scene}: exit code {child.returncode}\n{text}")
        return Result(output, child.returncode, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)


def zenith_deg(mu0):
    return math.degrees(math.acos(mu0))


def toml_text(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_text(v) for v in value) + "]"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    return repr(float(value))


def scene_text(tables):
    """TOML from (header, {key: value}) pairs; the header "" is the root, "[layer]" makes an array of tables."""
    lines = []
    for header, keys in tables:
        if header:
            lines += ["", f"[{header}]"]
        lines += [f"{key} = {toml_text(value)}" for key, value in keys.items()]
    return "\n".join(lines) + "\n"


def in_parallel(jobs, function, items):
    """function(item) for all items, in order; each starts a process, so threads of Python are enough."""
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(function, items))


def rms_percent(value, reference, standard_error=None):
    """RMS difference over the columns, as a percentage of the reference's mean, with the reference's own noise taken out."""
    square = np.mean((value - reference) ** 2)
    if standard_error is not None:
        square = max(0.0, square - np.mean(standard_error**2))
    return 100 * math.sqrt(square) / np.mean(reference)


def markdown_table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "| " + " | ".join("---" for _ in header) + " |"]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def write_between_markers(path, name, text):
    """Replaces what stands between <!-- begin NAME --> and <!-- end NAME --> in a document."""
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    document = Path(path).read_text()
    if begin not in document or end not in document:
        raise SystemExit(f"{path}: has no lines '{begin}' and '{end}' to write between")
    before, rest = document.split(begin, 1)
    after = rest.split(end, 1)[1]
    Path(path).write_text(f"{before}{begin}\n{text.strip()}\n{end}{after}")


def reference_folder():
    """The folder of reference data, or None without CLOUDBOW_REFERENCE_DIR."""
    folder = os.environ.get("CLOUDBOW_REFERENCE_DIR")
    return Path(folder) if folder else None


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def argument_parser(description):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--cloudbow", type=Path, default=os.environ.get("CLOUDBOW", ROOT / "build/release/src/cloudbow"),
                        help="the program (default: $CLOUDBOW, else build/release/src/cloudbow)")
    parser.add_argument("--threads", type=int, help="threads of each run (default: cloudbow's own choice)")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="leave scenes and results in this folder")
    return parser


class Workspace:
    """A folder for scenes and results: the one asked for, or a temporary one."""

    def __init__(self, keep):
        self.keep = keep

    def __enter__(self):
        if self.keep:
            self.keep.mkdir(parents=True, exist_ok=True)
            return self.keep
        self.temporary = tempfile.TemporaryDirectory(prefix="cloudbow-validation-")
        return Path(self.temporary.name)

    def __exit__(self, *exception):
        if not self.keep:
            self.temporary.cleanup()


def median(values):
    return statistics.median(values)


def now():
    return time.monotonic()
