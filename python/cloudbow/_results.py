"""Result files as Datasets."""
import os
from typing import TYPE_CHECKING, Union

from ._errors import InputError

if TYPE_CHECKING:
    import xarray as xr


def _register_accessor() -> None:
    import xarray as xr
    if hasattr(xr.Dataset, "cloudbow"):
        return

    @xr.register_dataset_accessor("cloudbow")
    class Groups:
        """`ds.cloudbow.groups`: the groups of a result, such as "/solver", each a Dataset. They belong to the Dataset that `run` or `open_result`
        has returned; what is derived from it has none."""

        def __init__(self, dataset: "xr.Dataset"):
            self.groups: dict = {}


def load(path: Union[str, os.PathLike]) -> "xr.Dataset":
    """Reads a result file, with its groups, into memory."""
    import h5py
    import xarray as xr
    _register_accessor()
    names: list = []
    try:
        with h5py.File(path, "r") as file:
            file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Group) else None)
        datasets = {}
        for name in ["/", *names]:
            with xr.open_dataset(path, engine="h5netcdf", group=name, decode_timedelta=False) as dataset:
                datasets[name] = dataset.load()
    except OSError as error:
        raise InputError(f"{os.fspath(path)}: can't be read as a result ({error})") from None
    root = datasets.pop("/")
    root.encoding = {}
    root.cloudbow.groups = {f"/{name}": dataset for name, dataset in datasets.items()}
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
