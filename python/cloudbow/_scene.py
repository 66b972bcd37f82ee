"""A scene as the program reads it: a file and settings. Dicts become TOML, arrays become files of a folder."""
import os
import re
import tempfile
from collections.abc import Callable, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Iterator, NamedTuple, Optional

from . import _arrays, _toml
from ._errors import InputError, refuse, warn_note

# Keys whose text is the name of a file.
FILE_KEYS = {"file", "albedo_map", "temperature_map", "spectral_albedo", "gas_model"}
# Keys that name a grid, and its quantity.
GRID_KEYS = {"effective_radius_grid": "effective_radius", "single_scattering_albedo_grid": "single_scattering_albedo", "temperature_grid": "temperature"}
MAP_KEYS = {"albedo_map": "albedo", "temperature_map": "surface_temperature"}
MEMORY_FOLDER = Path("/dev/shm")
MEMORY_NEEDED = 1 << 30


@contextmanager
def workspace() -> Iterator[Path]:
    """A folder for files of one call, in memory if there is room for a gigabyte."""
    folder = None
    if "TMPDIR" not in os.environ and os.access(MEMORY_FOLDER, os.W_OK | os.X_OK):
        room = os.statvfs(MEMORY_FOLDER)
        if room.f_bavail * room.f_frsize >= MEMORY_NEEDED:
            folder = MEMORY_FOLDER
    with tempfile.TemporaryDirectory(prefix="cloudbow-", dir=folder) as name:
        yield Path(name)


class SceneFile(NamedTuple):
    """Arguments of the program, and how the result shows the scene."""
    path: Path
    overrides: list
    text: str  #: empty: the file's own text
    shown: dict  #: names of files of arrays, and the descriptions that stand in their places


def explain(message: str, folder: Path) -> str:
    """The message with keys in the place of files of the folder."""
    message = re.sub(re.escape(str(folder / "scene.toml")) + r"(?::\d+)*", "scene", message)
    return message.replace(f"{folder}/", "").replace(".array.vdb", " (array)").replace(".array.nc", " (array)")


@contextmanager
def explained(folder: Path) -> Iterator[None]:
    """Errors name keys in the place of files of the folder."""
    try:
        yield
    except InputError as error:
        if str(folder) not in str(error):
            raise
        raise InputError(explain(str(error), folder)) from None


def notes(folder: Path) -> Callable[[str], None]:
    """Makes warnings of the program's messages, at the line that called the caller of this function."""
    return lambda text: warn_note(explain(text, folder), stacklevel=4)


def _part(parent: Any, key: str, name: str) -> Any:
    """A table or list entry below a node of a scene."""
    if isinstance(parent, list):
        if not name.isdigit() or int(name) >= len(parent):
            raise refuse(key, "no such entry", name, f"0 to {len(parent) - 1}")
        return parent[int(name)]
    return parent.setdefault(name, {})


def set_key(tree: dict, key: str, value: Any) -> None:
    """Replaces the value of a dotted key. Missing tables are created; entries of lists must exist."""
    *parents, last = key.split(".")
    node: Any = tree
    for name in parents:
        node = _part(node, key, name)
        if not isinstance(node, (dict, list)):
            raise refuse(key, "no such table", f"a value at {name}", "a key of the scene")
    if isinstance(node, list):
        _part(node, key, last)
        node[int(last)] = value
    else:
        node[last] = value


def _copied(value: Any, key: str = "", level: int = 0) -> Any:
    """Tables and lists anew, all else as it is."""
    _toml.check_levels(level, key)
    if isinstance(value, Mapping) and not _arrays.is_dataset(value):
        return {name: _copied(item, key or str(name), level + 1) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_copied(item, key, level + 1) for item in value]
    return value


def _table(tree: Mapping, name: str) -> dict:
    table = tree.get(name)
    return table if isinstance(table, dict) else {}


class _Arrays:
    """Writes the arrays of a tree into a folder and puts names of files and grids in their places."""

    def __init__(self, tree: dict, folder: Path):
        self.tree, self.folder = tree, folder
        self.shown: dict = {}

    def replace(self) -> None:
        clouds = self.tree.get("cloud")
        if isinstance(clouds, list):
            for n, cloud in enumerate(clouds):
                if isinstance(cloud, dict):
                    self._cloud(cloud, f"cloud.{n}")
        else:
            self._cloud(_table(self.tree, "cloud"), "cloud")
        surface = _table(self.tree, "surface")
        for key, variable in MAP_KEYS.items():
            value = surface.get(key)
            if isinstance(value, list):
                surface[key] = [self._map(item, variable, f"surface.{key}.{n}") for n, item in enumerate(value)]
            elif value is not None:
                surface[key] = self._map(value, variable, f"surface.{key}")

    def _map(self, value: Any, variable: str, key: str) -> Any:
        if not _arrays.is_array(value):
            return value
        path = self.folder / f"{key}.array.nc"
        _arrays.write_map(path, value, variable, key)
        self.shown[str(path)] = _arrays.shape_text(value)
        return str(path)

    def _index_grids(self, cloud: dict) -> Iterator[tuple]:
        """Of a cloud's phase function; of all if there is one cloud."""
        only = cloud.get("phase_function") if isinstance(self.tree.get("cloud"), list) else None
        for name, function in _table(self.tree, "phase_function").items():
            if isinstance(function, dict) and _arrays.is_array(function.get("index_grid")) and only in (None, name):
                yield function, "index_grid", "phase_index", f"phase_function.{name}.index_grid"

    def _cloud(self, cloud: dict, table_key: str) -> None:
        others = [(cloud, name, quantity, f"{table_key}.{name}") for name, quantity in GRID_KEYS.items() if _arrays.is_array(cloud.get(name))]
        others += self._index_grids(cloud)
        source = cloud.get("file")
        if not _arrays.is_array(source) and not _arrays.is_dataset(source):
            if others:
                raise refuse(others[0][3], "an array beside a file", repr(source), f"the name of a grid, or {table_key}.file as an array too")
            return
        if cloud.get("up_axis", "z") != "z":
            raise refuse(f"{table_key}.up_axis", "an array has its own axes", cloud["up_axis"], '"z", or no such key')
        shown = _arrays.shape_text(source)
        beside = {}
        if _arrays.is_dataset(source):
            beside = {str(name): source[name] for name in source.data_vars}
            name = cloud.get("grid") or next((name for name, array in beside.items() if array.attrs.get("quantity") in _arrays.CLOUDS), None)
            name = name or ("density" if "density" in beside or len(beside) != 1 else next(iter(beside)))
            if name not in beside:
                raise refuse(f"{table_key}.grid", "no such variable of the Dataset", repr(name), ", ".join(beside))
            source = beside.pop(name)
        else:
            name = cloud.get("grid") or getattr(source, "name", None) or "density"
        key = f"{table_key}.file"
        quantity = _arrays.quantity_of(source, key, cloud.get("quantity"))
        values, cells = _arrays.placed(source, key, _table(self.tree, "domain"), cloud)
        values = _arrays.in_units(values, quantity, str(getattr(source, "attrs", {}).get("units", "")), key)
        _arrays.check_cloud(values, key)
        grids = [_arrays.grid(str(name), quantity, values)]
        for table, entry, quantity_beside, key_beside in others:
            array = table[entry]
            grids.append(_arrays.grid(entry, quantity_beside, self._beside(array, source, quantity_beside, key_beside, cells, values.shape)))
            table[entry] = entry
        for entry, array in beside.items():
            quantity_beside = array.attrs.get("quantity")
            if quantity_beside in _arrays.UNITS and quantity_beside not in _arrays.CLOUDS and array.ndim == 3:
                grids.append(_arrays.grid(entry, quantity_beside, self._beside(array, source, quantity_beside, f"{key}.{entry}", cells, values.shape)))
        path = self.folder / f"{key}.array.vdb"
        _write(path, cells, grids)
        self.shown[str(path)] = shown
        cloud["file"], cloud["grid"] = str(path), str(name)

    def _beside(self, array: Any, source: Any, quantity: str, key: str, cells: Any, shape: tuple) -> Any:
        units = str(getattr(array, "attrs", {}).get("units", ""))
        array = _arrays.like(array, source, key)
        if _arrays.is_labelled(array) and array.coords:
            values, own = _arrays.placed(array, key)
            if not _arrays.nearly(own, cells):
                raise refuse(key, "other cells than cloud.file", f"size {own.size_m} m from {own.min_m} m", f"{cells.size_m} m from {cells.min_m} m")
        else:
            values = _arrays.placed(array, key, None, {"voxel_size_m": cells.size_m})[0]
        if values.shape != shape:
            raise refuse(key, "another shape than cloud.file", f"{values.shape}", f"{shape}")
        return _arrays.in_units(values, quantity, units, key)


def _write(path: Path, cells: Any, grids: list) -> None:
    from . import _core
    _core.write_grids(file=path, cell_size_m=cells.size_m, min_m=cells.min_m, grids=grids, half=False)


def _absolute(tree: Any, key: str = "") -> Any:
    """The tree with names of files from the working directory on."""
    if isinstance(tree, dict):
        return {name: _absolute(item, name) for name, item in tree.items()}
    if isinstance(tree, list):
        return [_absolute(item, key) for item in tree]
    return os.path.join(os.getcwd(), tree) if key in FILE_KEYS and isinstance(tree, str) and tree else tree


def _flat(tree: dict, path: str = "") -> Iterator[tuple]:
    for name, value in tree.items():
        key = f"{path}.{name}" if path else name
        if isinstance(value, dict) and value:
            yield from _flat(value, key)
        else:
            yield key, value


def path_of(path: Any, key: str) -> Path:
    if not isinstance(path, (str, os.PathLike)) or "\0" in os.fspath(path):
        raise refuse(key, "no path", repr(path), "a path: text or a pathlib.Path")
    try:
        os.fsencode(path)
    except UnicodeEncodeError:
        raise refuse(key, "no path", ascii(os.fspath(path)), "characters that a name of a file can have") from None
    return Path(path)


def check_keys(settings: Mapping, name: str) -> None:
    """@param name of the argument that holds values by dotted key"""
    for key in settings:
        if not isinstance(key, str):
            raise refuse(name, "a key that is no text", repr(key), 'dotted keys, as in "sun.zenith_deg"')
        _toml.check_text(key, name)


def prepare(scene: Any, settings: Optional[Mapping], folder: Path) -> SceneFile:
    """@param scene a path, or a dict with the keys of a scene file. @param settings values by dotted key."""
    if settings is not None and not isinstance(settings, Mapping):
        raise refuse("set", "no dict", type(settings).__name__, "a dict of values by dotted key")
    settings = dict(settings or {})
    check_keys(settings, "set")
    if isinstance(scene, (str, os.PathLike)):
        path_of(scene, "scene")
        tree: dict = {}
        for key, value in settings.items():
            set_key(tree, key, _copied(value, key))
        arrays = _Arrays(tree, folder)
        arrays.replace()
        return SceneFile(Path(scene), [f"{key}={_toml.value_of(_toml.plain(value, key))}" for key, value in _flat(tree)], "", arrays.shown)
    if not isinstance(scene, Mapping) or _arrays.is_dataset(scene):
        raise refuse("scene", "no scene", type(scene).__name__, "a path, or a dict with the keys of a scene file")
    tree = _copied(scene)
    for key, value in settings.items():
        set_key(tree, key, _copied(value, key))
    arrays = _Arrays(tree, folder)
    arrays.replace()
    tree = _toml.plain(tree, "")
    path = folder / "scene.toml"
    path.write_text(_toml.document(_absolute(tree)), encoding="utf-8")
    return SceneFile(path, [], _toml.document(tree), arrays.shown)
