"""Optics of droplets and phase functions."""
import os
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _core
from ._errors import refuse
from ._run import Progress, threads_of
from ._scene import explained, notes, path_of, workspace

if TYPE_CHECKING:
    import xarray as xr

Numbers = Union[float, str, Sequence[float]]


def _texts(value: Numbers, name: str) -> list:
    """Numbers as the program reads them: each as text."""
    if isinstance(value, str):
        return [value]
    if not hasattr(value, "__len__"):
        value = [value]
    try:
        return [repr(float(number)) for number in value]
    except (TypeError, ValueError):
        raise refuse(name, "not numbers", repr(value), "a number, numbers, or text FROM:TO:STEP") from None


def mie(wavelength_um: Numbers, effective_radius_um: Union[float, str], *, distribution: str = "gamma", variance: float = 0.1, substance: str = "water",
        refractive_index: Optional[complex] = None, density_g_cm3: Optional[float] = None, threads: Optional[int] = None,
        progress: Optional[Callable[[Progress], Any]] = None, output: Union[str, os.PathLike, None] = None) -> "xr.Dataset":
    """A table of droplets by Mie theory, as `cloudbow mie` makes it.

    Parameters
    ----------
    wavelength_um
        Wavelengths [um]: a number, several, or text "FROM:TO:STEP".
    effective_radius_um
        Effective radii [um]: a number, or text "FROM:TO:STEP".
    distribution, variance
        Sizes: "gamma" or "lognormal", and their effective variance.
    substance, refractive_index, density_g_cm3
        "water" or "ice", or a refractive index n + ik (k >= 0) and a density.
    threads, progress
        As for `run`; the phase is "mie".
    output
        File to which the table is written too (HDF5); a scene names it as the `file` of a phase function of type "mie".

    Returns
    -------
    xarray.Dataset
        Extinction [m2/g], single-scattering albedo and Legendre moments by radius and wavelength (docs/formats.md).

    Raises
    ------
    InputError
        If a number is out of its range, or the file cannot be written.
    """
    from ._results import load
    options = _core.MieOptions()
    options.wavelength_um = _texts(wavelength_um, "wavelength_um")
    radii = _texts(effective_radius_um, "effective_radius_um")
    if len(radii) != 1:
        raise refuse("effective_radius_um", "several", f"{len(radii)} numbers", 'a number or text "FROM:TO:STEP"')
    options.effective_radius_um = radii[0]
    if distribution not in ("gamma", "lognormal"):
        raise refuse("distribution", "unknown", repr(distribution), "gamma, lognormal")
    if substance not in ("water", "ice"):
        raise refuse("substance", "unknown", repr(substance), "water, ice")
    if not 0 < variance < float("inf"):
        raise refuse("variance", "out of range", variance, "> 0")
    options.distribution, options.variance, options.substance = distribution, float(variance), substance
    if refractive_index is not None:
        options.refractive_index = [complex(refractive_index).real, complex(refractive_index).imag]
    options.density_g_cm3, options.threads = density_g_cm3, threads_of(threads)
    options.command = "cloudbow.mie"
    report = None if progress is None else lambda *state: progress(Progress(*state))
    with workspace() as folder, explained(folder):
        options.output = folder / "table.h5" if output is None else path_of(output, "output")
        _core.mie(options=options, message=notes(folder), progress=report)
        return load(options.output)


def phase(type: str, *, asymmetry_parameter: Optional[float] = None, forward_asymmetry_parameter: Optional[float] = None,
          backward_asymmetry_parameter: Optional[float] = None, forward_weight: Optional[float] = None, file: Union[str, os.PathLike, None] = None,
          control_points: int = 162, delta_m_order: int = 12, fits: Optional[Sequence[str]] = None,
          output: Union[str, os.PathLike, None] = None) -> "xr.Dataset":
    """A phase function, with its fits to control points and their errors, as `cloudbow phase` makes them.

    Parameters
    ----------
    type
        "isotropic", "rayleigh", "henyey-greenstein", "double-henyey-greenstein", "legendre" or "table".
    asymmetry_parameter
        Of henyey-greenstein, between -1 and 1.
    forward_asymmetry_parameter, backward_asymmetry_parameter, forward_weight
        Of double-henyey-greenstein.
    file
        Of legendre and table: a text file (docs/formats.md).
    control_points, delta_m_order
        12, 42, 162 or 642; moments that the truncation keeps, 1 to 64.
    fits
        Methods of fitting; None: all.
    output
        File to which all is written too (HDF5).

    Returns
    -------
    xarray.Dataset
        Attributes of the function; groups of its fits are in ``ds.cloudbow.groups``.

    Raises
    ------
    InputError
        If an argument is missing, out of range or belongs to another type.
    """
    from ._results import load
    options = _core.PhaseOptions()
    options.type, options.asymmetry_parameter, options.forward_weight = type, asymmetry_parameter, forward_weight
    options.forward_asymmetry_parameter, options.backward_asymmetry_parameter = forward_asymmetry_parameter, backward_asymmetry_parameter
    options.file = None if file is None else os.fspath(file)
    options.control_points, options.delta_m_order, options.fits = control_points, delta_m_order, list(fits or [])
    options.command = f"cloudbow.phase({type!r})"
    with workspace() as folder, explained(folder):
        options.output = folder / "phase.h5" if output is None else path_of(output, "output")
        _core.phase(options=options, message=notes(folder))
        return load(options.output)
