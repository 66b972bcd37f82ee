"""Arrays in place of grids and maps: cells, units and values are checked, then written as the files that a scene names."""
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple, Optional

from . import _core
from ._errors import refuse

# Units of each quantity, with the factor to the program's own unit, which comes first.
WATER = {"g/m3": 1, "g m-3": 1, "g/m^3": 1, "g m^-3": 1, "g m**-3": 1, "kg/m3": 1e3, "kg m-3": 1e3, "kg/m^3": 1e3, "kg m^-3": 1e3, "kg m**-3": 1e3}
WATERS = tuple(f"{kind}_water_content" for kind in ("liquid", "rain", "ice", "snow", "graupel"))
UNITS = {
    "extinction": {"1/m": 1, "m-1": 1, "m^-1": 1, "m**-1": 1, "1/km": 1e-3, "km-1": 1e-3, "km^-1": 1e-3},
    **{name: WATER for name in WATERS},
    "effective_radius": {"um": 1, "\u00b5m": 1, "\u03bcm": 1, "micron": 1, "microns": 1, "micrometer": 1, "micrometers": 1, "micrometre": 1, "m": 1e6},
    "temperature": {"K": 1, "kelvin": 1, "Kelvin": 1},
    "single_scattering_albedo": {"1": 1, "": 1},
    "phase_index": {"1": 1, "": 1},
}
CLOUDS = ("extinction", *WATERS)
LENGTHS = {"m": 1, "metre": 1, "metres": 1, "meter": 1, "meters": 1, "km": 1e3, "kilometre": 1e3, "kilometres": 1e3, "kilometer": 1e3, "kilometers": 1e3}
AXES = ("z", "y", "x")


class Cells(NamedTuple):
    """Voxels of a box, along x, y, z."""
    size_m: tuple
    min_m: tuple


def is_array(value: Any) -> bool:
    """Whether this is a numpy array, a DataArray or another array of dimensions."""
    return hasattr(value, "ndim") and hasattr(value, "shape") and hasattr(value, "dtype") and value.ndim > 0


def is_labelled(value: Any) -> bool:
    """Whether this is a DataArray: an array whose dimensions have names."""
    return is_array(value) and hasattr(value, "dims") and hasattr(value, "coords")


def is_dataset(value: Any) -> bool:
    return hasattr(value, "data_vars") and hasattr(value, "dims")


def shape_text(value: Any) -> str:
    """As results show an array that stood in a scene."""
    if is_dataset(value):
        return f"Dataset ({', '.join(map(str, value.data_vars))})"
    names = value.dims if is_labelled(value) else AXES[-value.ndim:] if value.ndim <= 3 else ()
    return "array (" + ", ".join(f"{name} {n}" for name, n in zip(names, value.shape)) + ")"


def _tidy(value: float, of: float) -> float:
    """The number without the rounding of coordinates: to 1e-9 of a cell."""
    return round(value / of, 9) * of if abs(value) < 1e6 * of else value


def _real(values: Any, key: str) -> Any:
    """Numbers of float64. The imaginary part of complex ones would be lost, and dates would be nanoseconds."""
    import numpy as np
    numbers = np.asarray(values)
    try:
        if numbers.dtype.kind in "fiuO":
            return numbers.astype(float)
    except (TypeError, ValueError):
        pass
    raise refuse(key, "not numbers", str(numbers.dtype), "real numbers")


def _axis(array: Any, axis: str, key: str) -> Optional[tuple]:
    """(cell size, lower edge, descends) in metres, or None for an axis without coordinates."""
    import numpy as np
    if axis not in array.coords:
        return None
    coordinate = array.coords[axis]
    units = str(coordinate.attrs.get("units", ""))
    if units not in LENGTHS:
        raise refuse(key, f"units of the coordinate {axis}", repr(units), f'"m" or "km", as in array.{axis}.attrs["units"] = "m"')
    centre = _real(coordinate.values, f"{key}: coordinate {axis}") * LENGTHS[units]
    if not np.isfinite(centre).all():
        raise refuse(key, f"coordinate {axis}", "a number that is not finite", "centres of cells")
    descends = len(centre) > 1 and centre[-1] < centre[0]
    if descends:
        centre = centre[::-1]
    if len(centre) == 1:
        if "cell_size_m" not in coordinate.attrs:
            raise refuse(key, f"one cell along {axis}", "no size of it", f'array.{axis}.attrs["cell_size_m"]')
        name = f'{key}: coordinate {axis}: attrs["cell_size_m"]'
        size = _real(coordinate.attrs["cell_size_m"], name)
        if size.size != 1 or not 0 < size.item() < math.inf:
            raise refuse(name, "no size of a cell", repr(coordinate.attrs["cell_size_m"]), "one number > 0 [m]")
        size = size.item()
    else:
        size = (centre[-1] - centre[0]) / (len(centre) - 1)
        steps = np.diff(centre)
        if size <= 0 or np.abs(steps - size).max() > 1e-3 * size:
            raise refuse(key, f"coordinate {axis} is not evenly spaced", f"steps of {steps.min():.6g} to {steps.max():.6g} m",
                         "cells of one size (array.interp brings levels onto even ones)")
    size = float(f"{size:.10g}")
    return size, _tidy(float(centre[0]) - size / 2, size), descends


def _voxel_size(cloud: Mapping, key: str) -> Optional[tuple]:
    """The scene's voxel size along x, y, z [m]; None if it has none."""
    size = cloud.get("voxel_size_m")
    if size is None:
        return None
    try:
        sizes = tuple(float(part) for part in (size if hasattr(size, "__len__") and not isinstance(size, str) else [size] * 3))
    except (TypeError, ValueError):
        sizes = ()
    if len(sizes) != 3:
        raise refuse(key.removesuffix(".file") + ".voxel_size_m", "no size", repr(size), "a number, or three for x, y, z [m]")
    return sizes


def _check_voxel_size(cells: Cells, cloud: Mapping, key: str) -> None:
    """Coordinates and the scene's voxel size must not contradict each other."""
    size = _voxel_size(cloud, key)
    if size is not None and not all(math.isclose(a, b, rel_tol=1e-6) for a, b in zip(size, cells.size_m)):
        texts = [" x ".join(f"{part:g}" for part in parts) for parts in (size, cells.size_m)]
        raise refuse(key.removesuffix(".file") + ".voxel_size_m", f"contradicts the coordinates of {key}", f"{texts[0]} m",
                     f"{texts[1]} m, as the coordinates say; leave the key out, or give the array without coordinates")


def _box(domain: Any, cloud: Mapping, shape: tuple, key: str) -> Cells:
    """Cells of an array without coordinates: those that fill the scene's domain, or of the scene's voxel size."""
    size = _voxel_size(cloud, key)
    if size is not None:
        return Cells(size, (0.0, 0.0, 0.0))
    low, high = (domain or {}).get("min_m"), (domain or {}).get("max_m")
    if low is None or high is None:
        raise refuse(key, "an array without coordinates", "neither cloud.voxel_size_m nor domain.min_m and domain.max_m",
                     "one of them, or a DataArray with coordinates z, y, x in m or km")
    if len(low) != 3 or len(high) != 3:
        raise refuse("domain.min_m", "not a corner", f"{len(low)} and {len(high)} numbers", "x, y, z of min_m and max_m")
    return Cells(tuple((float(high[n]) - float(low[n])) / shape[2 - n] for n in range(3)), tuple(float(part) for part in low))


def check_unmasked(array: Any, key: str) -> None:
    """The numbers below a mask would be taken for values."""
    import numpy as np
    if np.ma.is_masked(array):
        raise refuse(key, "a masked array", "masked values", "a number everywhere (array.filled)")


def like(array: Any, source: Any, key: str) -> Any:
    """An array without coordinates, with those of the array beside which it stands."""
    if not is_labelled(source) or is_labelled(array) and array.coords:
        return array
    if is_labelled(array):
        return array.assign_coords(source.coords) if dict(zip(array.dims, array.shape)) == dict(zip(source.dims, source.shape)) else array
    if array.shape != source.shape:
        raise refuse(key, "another shape than cloud.file", f"{array.shape}", f"{source.shape}")
    check_unmasked(array, key)
    labelled = source.copy(data=array)
    labelled.attrs.clear()
    return labelled


def placed(array: Any, key: str, domain: Any = None, cloud: Mapping = {}) -> tuple:
    """(the array as (z, y, x) with ascending axes, its cells)."""
    import numpy as np
    if array.ndim != 3:
        raise refuse(key, "not a field", f"{array.ndim} dimension{'s' if array.ndim != 1 else ''}", "three, z, y, x")
    check_unmasked(array, key)
    if min(array.shape) == 0:
        raise refuse(key, "empty", f"shape {tuple(array.shape)}", "one cell or more along each axis")
    if is_labelled(array):
        if sorted(map(str, array.dims)) != sorted(AXES):
            raise refuse(key, "dimensions", ", ".join(map(str, array.dims)), "z, y, x in any order (array.rename, array.isel)")
        array = array.transpose(*AXES)
        axes = {axis: _axis(array, axis, key) for axis in AXES}
        values = array.values
        if all(axes.values()):
            for n, axis in enumerate(AXES):
                if axes[axis][2]:
                    values = np.flip(values, n)
            cells = Cells(*(tuple(axes[axis][n] for axis in "xyz") for n in (0, 1)))
            _check_voxel_size(cells, cloud, key)
            return values, cells
        if any(axes.values()):
            raise refuse(key, "coordinates", ", ".join(axis for axis in AXES if axes[axis]), "those of z, y, x, or none")
        return values, _box(domain, cloud, array.shape, key)
    return np.asarray(array), _box(domain, cloud, array.shape, key)


def in_units(values: Any, quantity: str, units: str, key: str) -> Any:
    """float32 in the program's unit of the quantity; no copy if they are so already."""
    import numpy as np
    known = UNITS.get(quantity, {})
    factor = 1 if not units else known.get(units)
    if factor is None:
        raise refuse(key, f"units of {quantity}", repr(units), ", ".join(repr(name) for name in known if name))
    if values.dtype.kind not in "fiub":
        raise refuse(key, "not numbers", str(values.dtype), "an array of float32 or float64")
    if factor != 1:
        values = values * np.float64(factor)
    return np.ascontiguousarray(values, dtype=np.float32)


def quantity_of(array: Any, key: str, given: Optional[str] = None) -> str:
    """Quantity of a cloud: as the scene says it, else the attribute, else by the units."""
    key_of_quantity = key.removesuffix(".file") + ".quantity"
    if given is not None and given not in CLOUDS:
        raise refuse(key_of_quantity, "not one of the choices", repr(given), ", ".join(CLOUDS))
    attributes = getattr(array, "attrs", {})
    quantity = given or attributes.get("quantity")
    units = str(attributes.get("units", ""))
    if not quantity:
        quantity = next((name for name in UNITS if units and units in UNITS[name] and name in CLOUDS), None)
    if quantity not in CLOUDS:
        raise refuse(key, "no quantity", repr(quantity or units), f'{key_of_quantity} = {" or ".join(repr(name) for name in CLOUDS[:2])}, or units of them')
    return quantity


def check_cloud(values: Any, key: str) -> None:
    """Values of a cloud are finite, not negative, and not all 0."""
    import numpy as np
    for wrong, problem in ((~np.isfinite(values), "not finite"), (values < 0, "negative")):
        if wrong.any():
            k, j, i = (int(n) for n in np.argwhere(wrong)[0])
            raise refuse(key, f"{problem} at z, y, x = {k}, {j}, {i}", values[k, j, i], "numbers >= 0")
    if not (values > 0).any():
        raise refuse(key, "no cloud", "only zeros", "a number > 0 in a voxel or more")


def write_map(path: Path, array: Any, name: str, key: str) -> None:
    """A map of the ground as netCDF; (y, x), with coordinates if they have units of length."""
    import numpy as np
    import xarray as xr
    if array.ndim != 2:
        raise refuse(key, "not a map", f"{array.ndim} dimension{'s' if array.ndim != 1 else ''}", "two, y, x")
    check_unmasked(array, key)
    if is_labelled(array):
        if sorted(map(str, array.dims)) != ["x", "y"]:
            raise refuse(key, "dimensions", ", ".join(map(str, array.dims)), "y, x (array.rename)")
        array = array.transpose("y", "x")
        units = str(array.attrs.get("units", ""))
        coordinates = {axis: (axis, _real(array.coords[axis].values, f"{key}: coordinate {axis}"), {"units": array.coords[axis].attrs.get("units", "")})
                       for axis in ("y", "x") if axis in array.coords}
        values = array.values
    else:
        values, units, coordinates = np.asarray(array), "", {}
    if values.dtype.kind not in "fiub":
        raise refuse(key, "not numbers", str(values.dtype), "an array of float32 or float64")
    if not np.isfinite(values).all():
        j, i = (int(n) for n in np.argwhere(~np.isfinite(values))[0])
        raise refuse(key, f"not finite at y, x = {j}, {i}", values[j, i], "a number everywhere")
    if values.dtype.kind != "f":
        values = values.astype(float)
    variable = xr.DataArray(values, dims=("y", "x"), coords=coordinates, name=name, attrs={"units": units} if units else {})
    variable.to_netcdf(path, engine="h5netcdf")


def grid(name: str, quantity: str, values: Any) -> Any:
    return _core.Grid(name=name, quantity=quantity, units=next(iter(UNITS[quantity])), values=values)


def nearly(a: Cells, b: Cells) -> bool:
    """Whether these are the same cells, to 1e-3 of a cell."""
    return all(math.isclose(p, q, rel_tol=1e-6) for p, q in zip(a.size_m, b.size_m)) and all(
        abs(p - q) <= 1e-3 * size for p, q, size in zip(a.min_m, b.min_m, a.size_m))
