"""Clouds in OpenVDB files."""
import os
from pathlib import Path
from typing import TYPE_CHECKING, Optional, Union

from . import _arrays, _core
from ._errors import InputError, refuse, warn_note

if TYPE_CHECKING:
    import xarray as xr


def read_vdb(path: Union[str, os.PathLike], *, grid: Optional[str] = None, up_axis: str = "z") -> "xr.Dataset":
    """The float grids of an OpenVDB file.

    Parameters
    ----------
    path
        The file.
    grid
        Name of the only grid to read; None: all float grids.
    up_axis
        The axis of the file that points up: "x", "y" or "z".

    Returns
    -------
    xarray.Dataset
        A variable (z, y, x) of float32 per grid. It has the attributes ``quantity`` and ``units`` of the file. Coordinates are centres of cells in m.
        Voxels without a value are 0 in extinction and liquid water content, and NaN in other grids.

    Raises
    ------
    InputError
        If the file is missing or damaged, or has no such grid. Also if its grids have different cells: then name one.
    """
    import numpy as np
    import xarray as xr
    path = Path(path)
    listed = _core.list_grids(file=path)
    names = [name for name, _, _ in listed] if grid is None else [grid]
    if not names:
        raise InputError(f"{path}: no float grids (allowed: one or more)")
    quantities = {name: quantity for name, quantity, _ in listed}
    variables: dict = {}
    cells, shape = None, None
    for name in names:
        is_cloud = quantities.get(name, "") in ("", *_arrays.CLOUDS)
        values, size, low, quantity, units, notes = _core.read_grid(file=path, grid=name, up_axis=up_axis, empty=0.0 if is_cloud else np.nan)
        for note in notes:
            warn_note(note)
        own = _arrays.Cells(tuple(size), tuple(low))
        if cells is None:
            cells, shape = own, values.shape
        if shape != values.shape or not _arrays.nearly(own, cells):
            raise InputError(f"{path}: grids of different cells (found {names[0]} and {name}, allowed one set of cells); name one: grid={name!r}")
        attributes = {"quantity": quantity, "units": units}
        variables[name] = (_arrays.AXES, values, {key: text for key, text in attributes.items() if text})
    coordinates = {}
    for n, axis in enumerate("xyz"):
        centres = cells.min_m[n] + (np.arange(shape[2 - n]) + 0.5) * cells.size_m[n]
        coordinates[axis] = (axis, centres, {"units": "m", "long_name": f"{axis} of the cell centre", "axis": axis.upper(), "cell_size_m": cells.size_m[n]})
    return xr.Dataset(variables, coords=coordinates)


def write_vdb(path: Union[str, os.PathLike], dataset: Union["xr.Dataset", "xr.DataArray"], *, grid: Optional[str] = None, half: bool = False) -> None:
    """Writes a cloud as an OpenVDB file that scenes can name.

    Parameters
    ----------
    path
        The file; one of that name is replaced.
    dataset
        A DataArray (z, y, x), or a Dataset of such. Coordinates are centres of cells in m or km, evenly spaced. The cloud has the attribute
        ``quantity``, "extinction" or "liquid_water_content". Units of one (1/m, km-1, g/m3, kg m-3) serve too. Other variables are written
        at the voxels of the cloud. Their ``quantity`` is effective_radius [um], temperature [K], single_scattering_albedo or phase_index.
    grid
        Name of the variable that is the cloud; None: the first that can be. Of a DataArray, the name of the grid (default: its own, or "density").
    half
        Store the cloud as 16-bit numbers.

    Raises
    ------
    InputError
        If dimensions, coordinates, units or values are not as above, or the file cannot be written.
    """
    if _arrays.is_dataset(dataset):
        arrays = {str(name): dataset[name] for name in dataset.data_vars}
        if not arrays:
            raise refuse("dataset", "no variables", "an empty Dataset", "one or more (z, y, x)")
        chosen = grid or next((name for name, array in arrays.items() if _is_cloud(array)), None)
        if chosen not in arrays:
            raise refuse("grid" if grid else "dataset", "no variable is the cloud", repr(grid) if grid else ", ".join(arrays),
                         "quantity extinction or liquid_water_content, or units of them")
        cloud = arrays.pop(chosen)
    elif _arrays.is_labelled(dataset):
        arrays, cloud, chosen = {}, dataset, grid or (str(dataset.name) if dataset.name else "density")
    else:
        raise refuse("dataset", "no DataArray", type(dataset).__name__, "a DataArray or a Dataset with coordinates z, y, x")
    quantity = _arrays.quantity_of(cloud, chosen)
    values, cells = _arrays.placed(cloud, chosen)
    values = _arrays.in_units(values, quantity, str(cloud.attrs.get("units", "")), chosen)
    _arrays.check_cloud(values, chosen)
    grids = [_arrays.grid(chosen, quantity, values)]
    for name, array in arrays.items():
        beside = array.attrs.get("quantity")
        if beside not in _arrays.UNITS or beside in _arrays.CLOUDS:
            raise refuse(name, "quantity", repr(beside), ", ".join(known for known in _arrays.UNITS if known not in _arrays.CLOUDS))
        others, own = _arrays.placed(array, name)
        if others.shape != values.shape or not _arrays.nearly(own, cells):
            raise refuse(name, f"other cells than {chosen}", f"shape {others.shape}", f"{values.shape}")
        grids.append(_arrays.grid(name, beside, _arrays.in_units(others, beside, str(array.attrs.get("units", "")), name)))
    _core.write_grids(file=Path(path), cell_size_m=cells.size_m, min_m=cells.min_m, grids=grids, half=half)


def _is_cloud(array: "xr.DataArray") -> bool:
    if "quantity" in array.attrs:
        return array.attrs["quantity"] in _arrays.CLOUDS
    return any(str(array.attrs.get("units")) in _arrays.UNITS[quantity] for quantity in _arrays.CLOUDS)
