"""Result files as Datasets.

The files have few kinds of attributes and variables, which are read here directly: xarray.open_dataset takes four times as long for the small
results of columns. A group with anything else is left to it.
"""
import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union

from ._errors import InputError

if TYPE_CHECKING:
    import xarray as xr

# Attributes of HDF5's dimension scales and of netCDF-4, which xarray does not show.
HIDDEN = {b"CLASS", b"NAME", b"DIMENSION_LIST", b"REFERENCE_LIST", b"_Netcdf4Dimid", b"_Netcdf4Coordinates", b"_NCProperties", b"_nc3_strict"}
# Attributes that change values or coordinates as they are decoded.
DECODED = {"scale_factor", "add_offset", "missing_value", "_Unsigned", "dtype", "calendar", "valid_range", "grid_mapping"}

BARE_DIMENSION = b"This is a netCDF dimension"
LARGEST_KEPT = 1 << 20  # bytes of a file whose content is kept for its groups


class _Other(Exception):
    """Something that this reader leaves to xarray."""


def _attributes(item: Any) -> dict:
    """Attributes in their order: text, numbers of numpy, and arrays."""
    import h5py
    import numpy as np
    names: list = []
    h5py.h5a.iterate(item, lambda name, *_: names.append(name), index_type=h5py.h5.INDEX_CRT_ORDER)
    attributes = {}
    for name in names:
        if name in HIDDEN:
            continue
        attribute = h5py.h5a.open(item, name)
        value = np.empty(attribute.shape, attribute.dtype)
        if value.dtype.kind not in "ifuS" or value.dtype.kind == "S" and value.shape:
            raise _Other
        attribute.read(value)
        key = name.decode()
        if value.dtype.kind == "S":
            attributes[key] = value[()].decode()
        else:
            attributes[key] = value.reshape(-1)[0] if value.size == 1 else value
    return attributes


def _dimensions(name: str, dataset: Any) -> tuple:
    import h5py
    if h5py.h5ds.is_scale(dataset):
        if dataset.rank != 1:
            raise _Other
        return (name,)
    names: list = []

    def add(scale: Any) -> None:
        # HDF5 searches the file for the name of an object; a scale of a coordinate has it as an attribute.
        found = h5py.h5ds.get_scale_name(scale)
        if not found or found.startswith(BARE_DIMENSION):
            found = h5py.h5i.get_name(scale).rpartition(b"/")[2]
        names.append(found.decode())
    for axis in range(dataset.rank):
        h5py.h5ds.iterate(dataset, axis, add)
    if len(names) != dataset.rank:
        raise _Other
    return tuple(names)


def _is_bare_dimension(dataset: Any) -> bool:
    """Whether netCDF-4 has put this dataset there for the length of a dimension alone."""
    import h5py
    return h5py.h5ds.is_scale(dataset) and h5py.h5ds.get_scale_name(dataset).startswith(BARE_DIMENSION)


def _variable(name: str, dataset: Any) -> "xr.Variable":
    import h5py
    import numpy as np
    import xarray as xr
    attributes = _attributes(dataset)
    values = np.empty(dataset.shape, dataset.dtype)
    fill = attributes.pop("_FillValue", None)
    if values.dtype.kind not in "ifu" or fill is not None and not (values.dtype.kind == "f" and np.isnan(fill)):
        raise _Other
    if DECODED & attributes.keys() or " since " in str(attributes.get("units", "")):
        raise _Other
    if values.size:
        dataset.read(h5py.h5s.ALL, h5py.h5s.ALL, values)
    encoding = {} if fill is None else {"_FillValue": fill}
    if "coordinates" in attributes:  # as xarray does
        encoding["coordinates"] = attributes.pop("coordinates")
    return xr.Variable(_dimensions(name, dataset), values, attributes, encoding)


def _read_group(group: Any) -> "xr.Dataset":
    """The variables of a group, without those of groups in it."""
    import h5py
    import xarray as xr
    variables = {name: _variable(name, item) for name, item in _items(group, h5py.h5i.DATASET) if not _is_bare_dimension(item)}
    named = {name for variable in variables.values() for name in variable.encoding.get("coordinates", "").split()}
    if not named <= variables.keys():
        raise _Other
    # A variable of one dimension of its own name becomes a coordinate, and so do those that others name.
    dataset = xr.Dataset(variables, attrs=_attributes(group))
    return dataset.set_coords(named) if named else dataset


def _items(group: Any, kind: int) -> Iterator[tuple]:
    """(name, object) of the objects of a kind in a group, in the order of their creation."""
    import h5py
    names: list = []
    group.links.iterate(lambda name, *_: names.append(name), idx_type=h5py.h5.INDEX_CRT_ORDER, order=h5py.h5.ITER_INC)
    for name in names:
        item = h5py.h5o.open(group, name)
        if h5py.h5i.get_type(item) == kind:
            yield name.decode(), item


def _groups(group: Any, path: str) -> Iterator[tuple]:
    """(path, group) of this one and of all below it."""
    import h5py
    yield path, group
    for name, item in _items(group, h5py.h5i.GROUP):
        yield from _groups(item, f"{path.rstrip('/')}/{name}")


def read_groups(source: Union[str, os.PathLike, bytes], by_xarray: bool = False, root: bool = True, others: bool = True) -> dict:
    """Every group of a file, by its path: "/" is the file's own.

    `source` is the path or the content of the file. Without `root` or `others` these groups are left out.
    """
    import h5py
    import xarray as xr
    datasets: dict = {}
    with h5py.File(h5py.h5f.open_file_image(source) if isinstance(source, bytes) else source, "r") as file:
        groups = [("/", file["/"].id)] if not others else [(name, group) for name, group in _groups(file["/"].id, "/") if root or name != "/"]
        for name, group in groups:
            try:
                datasets[name] = None if by_xarray else _read_group(group)
            except _Other:
                datasets[name] = None
    for name in [name for name, dataset in datasets.items() if dataset is None]:
        file_like = io.BytesIO(source) if isinstance(source, bytes) else source
        with xr.open_dataset(file_like, engine="h5netcdf", group=name, decode_timedelta=False) as dataset:
            datasets[name] = dataset.load()
            for variable in datasets[name].variables.values():  # the file may be a temporary one
                variable.encoding.pop("source", None)
            datasets[name].encoding = {}
    return datasets


class GroupsByPath(dict):
    """Datasets by the paths of their groups. The first "/" may be left out."""

    def __missing__(self, name: Any) -> "xr.Dataset":
        if super().__contains__(f"/{name}"):
            return self[f"/{name}"]
        there = ", ".join(self) or "none: they belong to the Dataset that `run` or `open_result` has returned"
        raise KeyError(f"no such group (found {name!r}, allowed {there})")

    def __contains__(self, name: Any) -> bool:
        return super().__contains__(name) or super().__contains__(f"/{name}")

    def get(self, name: Any, default: Any = None) -> Any:
        return self[name] if name in self else default


class Groups:
    """`ds.cloudbow.groups`: the groups of a result, such as "/solver", each a Dataset.

    They belong to the Dataset that `run` or `open_result` has returned. Datasets derived from it have none.
    """

    def __init__(self, dataset: "xr.Dataset"):
        self._content: Optional[bytes] = None
        self._groups = GroupsByPath()

    @property
    def groups(self) -> GroupsByPath:
        if self._content is not None:
            self._groups, self._content = GroupsByPath(read_groups(self._content, root=False)), None
        return self._groups

    def set(self, source: Union[str, os.PathLike, bytes]) -> None:
        """Groups of a file: at once, or of its content when they are first asked for."""
        if isinstance(source, bytes):
            self._content = source
        else:
            self._groups = GroupsByPath(read_groups(source, root=False))


def _register_accessor() -> None:
    import xarray as xr
    if not hasattr(xr.Dataset, "cloudbow"):
        xr.register_dataset_accessor("cloudbow")(Groups)


def load(path: Union[str, os.PathLike]) -> "xr.Dataset":
    """Reads a result file, with its groups, into memory."""
    _register_accessor()
    # Of a pipe nothing may ever come.
    if not os.path.isfile(path):
        what = "no file of this name" if not os.path.exists(path) else "a folder" if os.path.isdir(path) else "a device, pipe or socket"
        raise InputError(f"{os.fspath(path)!r}: can't be read as a result (found {what}, allowed a result file of `cloudbow run` or `sweep`)")
    try:
        # Groups take longer than the variables of a small result, and few calls look at them.
        source = Path(path).read_bytes() if os.path.getsize(path) <= LARGEST_KEPT else path
        root = read_groups(source, others=False)["/"]
        root.cloudbow.set(source)
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{os.fspath(path)}: can't be read as a result ({error})") from None
    return root


def open_result(path: Union[str, os.PathLike]) -> "xr.Dataset":
    """The result file of `cloudbow run` at a path, in memory, as `run` returns it.

    The groups of the file are in `ds.cloudbow.groups`, by their paths ("/solver", "/profile", ...).

    Raises
    ------
    InputError
        If the file is not there or is no HDF5 file.
    """
    return load(path)
