"""The extension module: functions of the program with plain arguments. The functions of the package call them."""
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

_Path = Union[str, PathLike[str]]
_Message = Optional[Callable[[str], Any]]
_Progress = Optional[Callable[[str, int, float, float, float], Any]]

version: str

class RunOptions:
    scene: _Path
    overrides: Sequence[str]
    output: _Path
    threads: int
    compare: bool
    clear_sky: bool
    dry_run: bool
    command: str
    def __init__(self) -> None: ...

class RunEstimate:
    @property
    def cells(self) -> list[int]: ...
    @property
    def active_cells(self) -> int: ...
    @property
    def memory_bytes(self) -> int: ...
    @property
    def available_bytes(self) -> int: ...
    @property
    def seconds(self) -> float: ...
    @property
    def text(self) -> str: ...

class SweepOutcome:
    @property
    def exit_code(self) -> int: ...
    @property
    def written(self) -> bool: ...
    @property
    def sentences(self) -> list[str]: ...

class MieOptions:
    wavelength_um: Sequence[str]
    effective_radius_um: str
    distribution: str
    variance: float
    substance: str
    refractive_index: Sequence[float]
    density_g_cm3: Optional[float]
    output: _Path
    threads: int
    command: str
    def __init__(self) -> None: ...

class PhaseOptions:
    type: str
    asymmetry_parameter: Optional[float]
    forward_asymmetry_parameter: Optional[float]
    backward_asymmetry_parameter: Optional[float]
    forward_weight: Optional[float]
    file: Optional[str]
    control_points: int
    delta_m_order: int
    fits: Sequence[str]
    output: _Path
    command: str
    def __init__(self) -> None: ...

class Grid:
    def __init__(self, name: str, quantity: str, units: str, values: NDArray[np.float32]) -> None: ...

def run(options: RunOptions, scene_text: str, shown: Mapping[str, str], message: _Message, progress: _Progress) -> list[str]: ...
def swept_values(key: str, list: str) -> tuple[list[str], bool]: ...
def sweep(options: RunOptions, lists: Sequence[tuple[str, Sequence[str], bool]], jobs: int, shown: Mapping[str, str], message: _Message,
          progress: _Progress) -> SweepOutcome: ...
def check(options: RunOptions, message: _Message) -> RunEstimate: ...
def mie(options: MieOptions, message: _Message, progress: _Progress) -> None: ...
def phase(options: PhaseOptions, message: _Message) -> None: ...
def verify(only: Sequence[str]) -> list[tuple[str, str, str, float, float, bool, str, float]]: ...
def check_names() -> list[str]: ...
def list_grids(file: _Path) -> list[list[str]]: ...
def read_grid(file: _Path, grid: str, up_axis: str, empty: float) -> tuple[NDArray[np.float32], list[float], list[float], str, str, list[str]]: ...
def write_grids(file: _Path, cell_size_m: Sequence[float], min_m: Sequence[float], grids: Sequence[Grid], half: bool) -> None: ...
