"""Sweeps: a scene for lists of values of its keys."""
import os
import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Union

from . import _core, _toml
from ._errors import InputError, NotConverged, RunFailed, refuse
from ._run import Scene, call_text, options_of
from ._scene import FILE_KEYS, check_keys, explain, explained, notes, path_of, prepare, workspace

if TYPE_CHECKING:
    import xarray as xr

NOT_CONVERGED = 3
MOST_JOBS = 4096
_RANGE = re.compile(r"[-+.\deE]+([:,\s]+[-+.\deE]+)+")  # as the command line has it


class SweepProgress(NamedTuple):
    """State of a sweep after a run."""
    done: int  #: runs that have ended
    runs: int  #: runs that this call solves: those whose results were kept do not count


def _list_of(key: str, values: Any, absolute: bool) -> tuple:
    """(key, values as --set takes them, whether they are a dimension)."""
    if isinstance(values, (bytes, bytearray)):
        raise refuse(key, "no value of a scene", type(values).__name__, "a value, a list, or an array of one dimension")
    is_list = isinstance(values, Sequence) and not isinstance(values, str) or hasattr(values, "ndim") and values.ndim == 1
    if isinstance(values, str) and _RANGE.fullmatch(values):
        return (key, *_core.swept_values(key, values))
    if hasattr(values, "ndim") and values.ndim > 1:
        raise refuse(key, "no list", f"an array of {values.ndim} dimensions", "a value, a list, or an array of one dimension")
    plain = _toml.plain(list(values) if isinstance(values, Sequence) and is_list else values, key)
    items = plain if is_list else [plain]
    if absolute and key.rpartition(".")[2] in FILE_KEYS:
        items = [os.path.join(os.getcwd(), item) if isinstance(item, str) else item for item in items]
    return key, [_toml.value_of(item) for item in items], is_list


def _check_jobs(jobs: Any) -> int:
    if not hasattr(jobs, "__index__") or isinstance(jobs, bool) or not 1 <= jobs <= MOST_JOBS:
        raise refuse("jobs", "not a number of runs", repr(jobs), f"1 to {MOST_JOBS}")
    return int(jobs)


def sweep(scene: Scene, keys: Mapping[str, Any], *, set: Optional[Mapping[str, Any]] = None, jobs: int = 1, threads: Optional[int] = None,
          progress: Optional[Callable[[SweepProgress], Any]] = None, output: Union[str, os.PathLike, None] = None, compare: bool = False,
          clear_sky: bool = False) -> "xr.Dataset":
    """Solves a scene for the product of lists of values, as `cloudbow sweep` does.

    Parameters
    ----------
    scene
        As for `run`: a path or a dict, in which arrays may stand.
    keys
        Lists by dotted key: ``{"sun.zenith_deg": [0, 30, 60], "surface.albedo": np.linspace(0, 1, 5)}``. A list, tuple, range or array of one dimension
        is a dimension of the result. So is a text as on the command line: ``"0:60:20"`` (first, last, step) or ``"0,30,60"``. A single value holds in
        all runs.
    set
        Values by dotted key that hold in all runs, as for `run`.
    jobs
        Runs at a time. They share the threads.
    threads
        Number of threads in all; None: one per processor.
    progress
        Is called with a `SweepProgress` after each run. An exception that it raises ends the sweep.
    output
        File to which the result is written too (HDF5). Finished runs are kept beside it, in OUTPUT.parts, until the sweep is complete. The same call
        goes on after an interrupt. None: nothing is kept.
    compare, clear_sky
        As for `run`, in each run.

    Returns
    -------
    xarray.Dataset
        The file of `cloudbow sweep`. Each list is a dimension and coordinate, which has the name of the last part of the key: ``zenith_deg``.
        Its attributes are ``key`` and ``units``. Variables have these dimensions first: ``upwelling_flux`` (zenith_deg, z_edge, y, x) [W m-2]. Numbers of the groups
        are variables too: ``ds.cloudbow.groups["/summary"].reflectance`` (zenith_deg). ``ds.cloudbow.groups["/runs"]`` has the scene, the exit code
        and the message of each run. Values are those of `run`, bit by bit.

    Raises
    ------
    InputError
        If anything about one of the scenes is wrong, before the first is solved. Also if no run has a result.
    KeyboardInterrupt
        After Ctrl-C, at the end of a sweep of the solver.

    Warns
    -----
    NotConverged
        If a solve did not reach its tolerance. Its values are there.
    RunFailed
        If a run has no result. Its values are NaN.
    Note
        If a value was guessed or corrected.
    """
    from ._results import load
    if progress is not None and not callable(progress):
        raise refuse("progress", "not a function", type(progress).__name__, "None or a function of a SweepProgress")
    if not isinstance(keys, Mapping):
        raise refuse("keys", "no dict", type(keys).__name__, "a dict of lists by dotted key")
    check_keys(keys, "keys")

    def report(phase: str, done: int, _error: float, _residual: float, fraction: float) -> None:
        if phase == "run" and progress is not None:
            progress(SweepProgress(done, round(done / fraction)))

    with workspace() as folder, explained(folder):
        file = prepare(scene, set, folder)
        for key in keys:
            if set is not None and key in set:
                raise refuse(key, "a key twice", "it in keys and in set", "one of the two")
        lists = [_list_of(key, values, isinstance(scene, Mapping)) for key, values in keys.items()]
        if not any(is_list for _, _, is_list in lists):
            raise refuse(", ".join(keys) or "keys", "nothing to sweep", "no key with a list", 'a list for one key or more, as in {"sun.zenith_deg": [0, 30]}; `run` solves one scene')
        target = folder / "result.h5" if output is None else path_of(output, "output")
        options = options_of(file, threads, output=target, compare=bool(compare), clear_sky=bool(clear_sky), command=call_text("sweep", scene, keys))
        outcome = _core.sweep(options=options, lists=lists, jobs=_check_jobs(jobs), shown=file.shown, message=notes(folder),
                              progress=None if progress is None else report)
        sentences = [explain(sentence, folder) for sentence in outcome.sentences]
        if not outcome.written:  # the file may be there from an older sweep
            raise InputError("; ".join(sentences))
        result = load(target)
    for sentence in sentences:
        warnings.warn(sentence, NotConverged if outcome.exit_code == NOT_CONVERGED else RunFailed, stacklevel=2)
    return result
