"""Light in cloudy air, solved deterministically: the functions of the program `cloudbow`, with arrays and xarray.

>>> import cloudbow as cb
>>> ds = cb.run("configs/cumulus.toml", set={"sun.zenith_deg": 30})
>>> ds.upwelling_flux.isel(z_edge=-1).plot()

`run` solves a scene and returns an xarray.Dataset. `check` predicts its cost. `sweep` solves a scene for lists of values. `compare` holds two results
against each other. `open_result` reads a file of `cloudbow run` or `cloudbow sweep`.
`read_vdb` and `write_vdb` are for clouds in OpenVDB files, `mie` and `phase` for optics. `verify` checks this machine.
xarray is imported when it is first needed.
"""
from ._clouds import read_vdb, write_vdb
from ._compare import compare
from ._core import version as __version__
from ._errors import InputError, NotConverged, Note, RunFailed
from ._optics import mie, phase
from ._results import open_result
from ._run import Check, Progress, check, run
from ._sweep import SweepProgress, sweep
from ._verify import CheckOutcome, verify

__all__ = ["Check", "CheckOutcome", "InputError", "NotConverged", "Note", "Progress", "RunFailed", "SweepProgress", "check", "compare", "mie",
           "open_result", "phase", "read_vdb", "run", "sweep", "verify", "write_vdb"]
