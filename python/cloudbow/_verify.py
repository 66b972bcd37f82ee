"""Physical checks on this machine."""
from collections.abc import Sequence
from typing import NamedTuple, Optional

from . import _core
from ._errors import refuse


class CheckOutcome(NamedTuple):
    """One check of `verify`."""
    name: str
    statement: str  #: the property that must hold
    unit: str  #: of the deviation and the tolerance
    tolerance: float
    found: float  #: the deviation; NaN if the check ended in an error
    passed: bool
    error: str  #: message of that error, or empty
    seconds: float


def verify(only: Optional[Sequence[str]] = None) -> list:
    """Carries out the checks of `cloudbow verify` and returns a `CheckOutcome` of each, in their order.

    Parameters
    ----------
    only
        Names of checks; None: all, which takes some seconds.

    Raises
    ------
    InputError
        If there is no check of a name.
    """
    names = _core.check_names()
    for name in only or []:
        if name not in names:
            raise refuse("only", "no such check", repr(name), ", ".join(names))
    return [CheckOutcome(*outcome) for outcome in _core.verify(only=list(only or []))]
