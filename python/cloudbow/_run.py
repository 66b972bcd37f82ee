"""Runs of scenes."""
import os
import warnings
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Union

from . import _core
from ._errors import NotConverged, refuse
from ._scene import SceneFile, explained, notes, path_of, prepare, workspace

if TYPE_CHECKING:
    import xarray as xr

Scene = Union[str, os.PathLike, Mapping[str, Any]]
MOST_THREADS = 4096


class Progress(NamedTuple):
    """State of a solve after a sweep or a phase."""
    phase: str  #: "tables", "beam", "sweep", "gather"
    sweep: int  #: number of the sweep, from 1; 0 outside sweeps
    estimated_error: float  #: of the fluxes, relative, after this sweep
    energy_residual: float  #: of the energy ledger, relative to the incident power
    fraction: float  #: of this phase, 0 to 1


class Check(NamedTuple):
    """Answer of `check`; as text it is what `cloudbow run --dry-run` prints."""
    columns: tuple  #: along x and y
    levels: int
    active_cells: int  #: cells that hold matter
    memory_bytes: int  #: peak, predicted
    available_bytes: int  #: memory of this machine
    seconds: float  #: predicted
    text: str

    def __str__(self) -> str:
        return self.text


def threads_of(threads: Optional[int]) -> int:
    if threads is None:
        return 0
    if not hasattr(threads, "__index__") or isinstance(threads, bool) or not 1 <= threads <= MOST_THREADS:
        raise refuse("threads", "not a number of threads", repr(threads), f"None, or 1 to {MOST_THREADS}")
    return int(threads)


def call_text(function: str, scene: Any, settings: Optional[Mapping] = None) -> str:
    """A call as the history of a file shows it."""
    what = repr(os.fspath(scene)) if isinstance(scene, (str, os.PathLike)) else "a dict"
    keys = ", ".join(settings or {})
    return f"cloudbow.{function}({what}{f', set: {keys}' if keys else ''})"


def options_of(file: SceneFile, threads: Optional[int], **others: Any) -> Any:
    options = _core.RunOptions()
    options.scene, options.overrides, options.threads = file.path, file.overrides, threads_of(threads)
    for name, value in others.items():
        setattr(options, name, value)
    return options


def run(scene: Scene, *, set: Optional[Mapping[str, Any]] = None, threads: Optional[int] = None,
        progress: Optional[Callable[[Progress], Any]] = None, output: Union[str, os.PathLike, None] = None, compare: bool = False,
        clear_sky: bool = False) -> "xr.Dataset":
    """Solves a scene, as `cloudbow run` does, and returns its result.

    Parameters
    ----------
    scene
        Path of a scene file (TOML), or a dict with the keys of one. Tables are dicts, `[[layer]]` and the like are lists of dicts. Names of files
        in a dict are relative to the working directory. Those in a scene file are relative to its folder. Arrays may stand for files and grids:

        - ``cloud.file``: a DataArray with dimensions z, y, x in any order. Coordinates are centres of cells, evenly spaced, with ``units`` m or km.
          Values are in 1/m or km-1 (extinction), or in g/m3 or kg m-3 (liquid water content). Or a Dataset as of `read_vdb`. Or a numpy array
          [z][y][x], whose cells fill ``domain.min_m`` to ``domain.max_m``. Given ``cloud.voxel_size_m`` they have that size, from (0, 0, 0) on.
        - ``cloud.effective_radius_grid`` [um], ``cloud.temperature_grid`` [K], ``cloud.single_scattering_albedo_grid``,
          ``phase_function.NAME.index_grid``: arrays of the cells of ``cloud.file``. Only voxels with cloud count.
        - ``surface.albedo_map`` (0 to 1), ``surface.temperature_map`` [K]: arrays [y][x], or DataArrays with y, x.
    set
        Values by dotted key that replace those of the scene: ``{"sun.zenith_deg": 30, "layer.0.optical_depth": 2}``.
    threads
        Number of threads; None: one per processor.
    progress
        Is called with a `Progress` after each sweep and phase. An exception that it raises ends the run.
    output
        File to which the result is written too (HDF5). A file of that name is replaced. None: no file is kept, whatever the scene says.
    compare
        Solve as independent columns too; variables of the differences are added.
    clear_sky
        Solve the scene without its clouds too; the group ``/clear_sky`` is added.

    Returns
    -------
    xarray.Dataset
        Variables, coordinates and attributes of the result file (docs/result-reference.md), in memory. Its groups are Datasets too:
        ``ds.cloudbow.groups["/solver"]``.

    Raises
    ------
    InputError
        If anything about the scene is wrong. The message names the key.
    KeyboardInterrupt
        After Ctrl-C, at the end of a sweep.

    Warns
    -----
    NotConverged
        If a solve did not reach its tolerance.
    Note
        If a value was guessed or corrected.

    The interpreter's lock is released during the solve: threads of Python may run scenes at the same time.
    """
    from ._results import load
    if progress is not None and not callable(progress):
        raise refuse("progress", "not a function", type(progress).__name__, "None or a function of a Progress")
    report = None if progress is None else lambda *state: progress(Progress(*state))
    with workspace() as folder, explained(folder):
        file = prepare(scene, set, folder)
        target = folder / "result.h5" if output is None else path_of(output, "output")
        options = options_of(file, threads, output=target, compare=bool(compare), clear_sky=bool(clear_sky), command=call_text("run", scene, set))
        misses = _core.run(options=options, scene_text=file.text, shown=file.shown, message=notes(folder), progress=report)
        result = load(target)
    for sentence in misses:
        warnings.warn(sentence, NotConverged, stacklevel=2)
    return result


def check(scene: Scene, *, set: Optional[Mapping[str, Any]] = None, threads: Optional[int] = None, compare: bool = False) -> Check:
    """Validates a scene and predicts memory and time, as `cloudbow run --dry-run` does. Nothing is solved.

    Parameters are those of `run`. The text of the answer shows domain, optical depth and water path, in which a wrong unit is seen.

    Raises
    ------
    InputError
        If anything about the scene is wrong, or it needs more memory than there is.
    """
    with workspace() as folder, explained(folder):
        file = prepare(scene, set, folder)
        found = _core.check(options=options_of(file, threads, output=folder / "result.h5", compare=bool(compare), dry_run=True), message=notes(folder))
    nx, ny, nz = found.cells
    return Check((nx, ny), nz, found.active_cells, found.memory_bytes, found.available_bytes, found.seconds, found.text)
