"""Runs the Monte Carlo of tests/reference on a field of cells, as support.Cloudbow runs the program."""
import json
import math
import os
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from support import ROOT, Failure


@dataclass
class Plane:
    """A quantity over the columns, [y, x], with standard errors; means over the domain with theirs."""
    value: np.ndarray
    error: np.ndarray
    mean: float
    mean_error: float


@dataclass
class Job:
    """A scene in the terms of tests/reference/monte_carlo.hpp. Media: (albedo, scatterer text, extinction [z, y, x] or [z])."""
    z_edge: np.ndarray
    columns: tuple  # nx, ny
    column_size: tuple  # dx, dy
    media: list
    sun: tuple  # zenith, azimuth
    surface_albedo: float = 0.0
    open_sides: bool = False
    levels: list = field(default_factory=list)  # indices of z_edge
    views: list = field(default_factory=list)  # (zenith, azimuth)
    absorption: bool = False  # net absorbed power
    # Thermal emission: Planck radiances of cells [z, y, x] or [z] and of the surface. The step is that of the upper less the lower face.
    planck: np.ndarray | None = None
    planck_step: np.ndarray | None = None
    surface_planck: np.ndarray | None = None
    sky_radiance: float = 0.0
    sun_flux: float = 1.0
    circumsolar_deg: float = 0.0  # half angle of a cone about the sun, whose diffuse light is counted at `levels`

    def text(self):
        lines = [f"columns {self.columns[0]} {self.columns[1]} {self.column_size[0]!r} {self.column_size[1]!r}",
                 f"z_edges {len(self.z_edge) - 1} " + " ".join(repr(float(z)) for z in self.z_edge),
                 f"sun {self.sun[0]!r} {self.sun[1]!r}", f"surface_albedo {self.surface_albedo!r}", f"open_sides {int(self.open_sides)}",
                 f"levels {len(self.levels)} " + " ".join(map(str, self.levels))]
        lines += [f"view {zenith!r} {azimuth!r}" for zenith, azimuth in self.views]
        lines += [f"medium {albedo!r} {scatterer} {cells_text(extinction)}" for albedo, scatterer, extinction in self.media]
        lines.append(f"circumsolar {self.circumsolar_deg!r}")
        lines.append(f"absorption {int(self.absorption)}\nsun_flux {self.sun_flux!r}\nsky_radiance {self.sky_radiance!r}")
        lines += [f"emission {name} {cells_text(cells)}" for name, cells in (("planck", self.planck), ("step", self.planck_step)) if cells is not None]
        if self.surface_planck is not None:
            lines.append("emission surface " + numbers_text(np.broadcast_to(self.surface_planck, self.columns[::-1])))
        return "\n".join(lines) + "\n"


def numbers_text(values):
    return " ".join(f"{value:.9g}" for value in np.ravel(values))


def cells_text(cells):
    return f"{'profile' if np.ndim(cells) == 1 else 'cells'} {numbers_text(cells)}"


class Solution:
    """In the unit of `sun_flux`: `up`, `down`, `circumsolar` by level, `absorbed` by layer of cells (net, by area), `radiance` by view, each a Plane."""

    def __init__(self, text, columns):
        answer = json.loads(text)
        self.cpu_seconds = answer["cpu_seconds"]
        self.photons = answer["photons"]
        for name in ("up", "down", "circumsolar", "absorbed", "radiance"):
            setattr(self, name, [Plane(np.reshape(p["value"], columns[::-1]), np.reshape(p["standard_error"], columns[::-1]), p["mean"],
                                       p["mean_standard_error"]) for p in answer[name]])


class MonteCarlo:
    def __init__(self, program, threads=1):
        self.program = str(program)
        self.threads = threads

    def run(self, job, photons, seed=1, batches=50, backward=False):
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
            file.write(job.text() + f"photons {int(photons)}\nbatches {batches}\nseed {seed}\nthreads {self.threads}\nbackward {int(backward)}\n")
            file.flush()
            done = subprocess.run([self.program, file.name], capture_output=True, text=True)
        if done.returncode != 0:
            raise Failure(f"monte_carlo: exit code {done.returncode}\n{done.stderr}")
        return Solution(done.stdout, job.columns)


def cloud_cells(program, path):
    """Extinction [z, y, x], the size of a cell and the height of the lowest, of a VDB file."""
    done = subprocess.run([str(program), str(path)], capture_output=True, text=True, check=True)
    head, *rows = done.stdout.splitlines()
    head = head.split()
    nx, ny, nz = map(int, head[:3])
    return np.array([row.split() for row in rows], float).reshape(nz, ny, nx), tuple(map(float, head[3:6])), float(head[6])


def add_programs(parser):
    """Options for the programs of tests/reference: beside cloudbow's own build unless said otherwise."""
    folder = Path(os.environ.get("CLOUDBOW_TEST_PROGRAMS", ROOT / "build/release/tests/reference"))
    parser.add_argument("--monte-carlo", type=Path, default=folder / "monte_carlo", metavar="PROGRAM")
    parser.add_argument("--cloud-cells", type=Path, default=folder / "cloud_cells", metavar="PROGRAM")
    parser.add_argument("--thick-slabs", type=Path, default=folder / "thick_slabs", metavar="PROGRAM")


def henyey_greenstein(g):
    return f"henyey-greenstein {g!r}"


def table(angle_deg, value):
    return f"table {len(angle_deg)} " + " ".join(f"{a:.9g} {v:.9g}" for a, v in zip(angle_deg, value))


def chi(difference, error):
    """RMS of a difference in its own standard errors: 1 if it is noise alone."""
    return math.sqrt(np.mean((difference / error) ** 2))
