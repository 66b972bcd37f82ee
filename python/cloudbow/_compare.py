"""Differences between two results."""
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Union

from ._errors import InputError, refuse

if TYPE_CHECKING:
    import xarray as xr

Result = Union["xr.Dataset", str, os.PathLike]
# A coordinate that was computed in two ways may differ by rounding.
LARGEST_SHIFT = 1e-9
STATISTICS = ("mean_a", "mean_b", "mean_difference", "rms_difference", "largest_difference", "relative_rms")


def _loaded(result: Any, name: str) -> "xr.Dataset":
    from ._arrays import is_dataset
    from ._results import load
    if isinstance(result, (str, os.PathLike)):
        return load(result)
    if not is_dataset(result):
        raise refuse(name, "no result", type(result).__name__, "a Dataset, or the path of a result file")
    return result


def _check_coordinates(a: "xr.Dataset", b: "xr.Dataset", dims: Iterable) -> None:
    import numpy as np
    for dim in dims:
        if a.sizes[dim] != b.sizes.get(dim):
            raise InputError(f"{dim}: another length (found {a.sizes[dim]} and {b.sizes.get(dim, 'none')}, allowed results on the same cells)")
        if dim not in a.coords or dim not in b.coords:
            continue
        one, other = a[dim].values, b[dim].values
        if one.dtype.kind == "f" and other.dtype.kind == "f":
            scale = max(np.abs(one).max(initial=0), np.abs(other).max(initial=0))
            same = bool((np.abs(one - other) <= LARGEST_SHIFT * scale).all())
        else:  # numbers, texts or times: another kind is not equal
            same = one.tolist() == other.tolist()
        if not same:
            raise InputError(f"{dim}: other coordinates (found {one[:2]}... and {other[:2]}..., allowed results on the same cells)")


def _check_values(name: str, a: "xr.DataArray", b: "xr.DataArray") -> None:
    import numpy as np
    if a.dims != b.dims:
        raise InputError(f"{name}: other dimensions (found {a.dims} and {b.dims}, allowed the same)")
    # Arithmetic of xarray leaves the units out.
    units = [array.attrs.get("units") for array in (a, b)]
    if None not in units and str(units[0]) != str(units[1]):
        raise InputError(f"{name}: other units (found {units[0]} and {units[1]}, allowed the same)")
    for of, array in (("a", a), ("b", b)):
        if array.size == 0:
            raise InputError(f"{of}: no values (found {name} of length 0 along {', '.join(str(d) for d in array.dims if array.sizes[d] == 0)}, allowed one value or more)")
        infinite = int(np.isinf(array.values).sum())
        if infinite:
            raise InputError(f"{of}: infinite values (found {infinite} in {name}, allowed finite numbers, and NaN for missing ones)")


def _kept(keep: Any) -> list:
    if not isinstance(keep, Iterable):
        raise refuse("keep", "no names of dimensions", repr(keep), "a name or a list of them")
    kept = [keep] if isinstance(keep, str) else list(keep)
    for dim in kept:
        if dim in ("variable", "units", *STATISTICS):
            raise refuse("keep", "a name of the statistics", repr(dim), "other names; `.rename` gives one")
    return kept


def compare(a: Result, b: Result, *, keep: Union[str, Iterable[str]] = ()) -> "xr.Dataset":
    """How far a result is from another one: statistics of the differences of all variables that both have.

    Parameters
    ----------
    a, b
        Datasets as of `run`, `sweep` or `open_result`, or paths of their files, on the same cells. b is the one to compare with.
    keep
        Dimensions along which the statistics stay apart, such as "z_edge" or "zenith_deg". Over all others they are taken.

    Returns
    -------
    xarray.Dataset
        Variables (variable, and those of `keep`), in the units of each variable, which are the coordinate ``units``:

        - ``mean_a``, ``mean_b``: means over the values, each value with the same weight
        - ``mean_difference``: of a - b
        - ``rms_difference``: root of the mean square of a - b
        - ``largest_difference``: largest magnitude of a - b
        - ``relative_rms``: ``rms_difference`` over the magnitude of ``mean_b``, dimensionless; NaN if that is 0

        Values that are missing (NaN) in one of the two do not count. A variable without a dimension of `keep` has the same numbers all along it. The
        attributes ``only_in_a`` and ``only_in_b`` list variables that the other lacks. ``.to_dataframe()`` is a table.

    Raises
    ------
    InputError
        If the results are on different cells or in different units. Also if they have infinite values or no variable in common, or lack a dimension of `keep`.
    """
    import numpy as np
    import xarray as xr
    a, b = _loaded(a, "a"), _loaded(b, "b")
    kept = _kept(keep)

    def fields(dataset: "xr.Dataset") -> list:
        bounds = {array.attrs.get("bounds") for array in dataset.coords.values()}
        return [name for name, array in dataset.data_vars.items() if array.dtype.kind == "f" and name not in bounds]

    common = [name for name in fields(a) if name in fields(b)]
    if not common:
        raise InputError("a, b: no variable in common (found none, allowed results of the same kind)")
    for dim in kept:
        if not any(dim in a[name].dims for name in common):
            raise refuse("keep", "no such dimension", repr(dim), ", ".join(sorted({str(d) for name in common for d in a[name].dims})))
    rows = []
    for name in common:
        _check_values(name, a[name], b[name])
        _check_coordinates(a, b, a[name].dims)
        one, other = a[name].variable.astype("float64"), b[name].variable.astype("float64")
        there = np.isfinite(one.values) & np.isfinite(other.values)
        one, other = one.where(there), other.where(there)
        over = [dim for dim in one.dims if dim not in kept]
        difference = one - other
        mean_b, rms = other.mean(over), np.sqrt((difference**2).mean(over))
        magnitude = abs(mean_b)
        found = (one.mean(over), mean_b, difference.mean(over), rms, abs(difference).max(over), rms / magnitude.where(magnitude > 0, np.nan))
        rows.append(xr.Dataset(dict(zip(STATISTICS, found))))
    result = xr.concat(rows, dim=xr.Variable("variable", common), coords="minimal", compat="override")
    result = result.assign_coords({dim: a[dim] for dim in kept if dim in a.coords})
    result = result.assign_coords(units=("variable", [str(a[name].attrs.get("units", "")) for name in common]))
    result.attrs = {"only_in_a": ", ".join(n for n in fields(a) if n not in fields(b)), "only_in_b": ", ".join(n for n in fields(b) if n not in fields(a))}
    return result
