"""Errors and warnings."""
import warnings
from typing import Any


class InputError(ValueError):
    """The input is wrong. The message names the key or the file, what was found and what is allowed."""


class NotConverged(UserWarning):
    """A solution did not reach its tolerance, or its energy ledger does not close. The result is there and is marked so."""


class RunFailed(UserWarning):
    """A run of a sweep has no result: its values are NaN. The message says why."""


class Note(UserWarning):
    """A guess or a correction that was made in reading the input."""


def warn_note(text: str, stacklevel: int = 3) -> None:
    """Passes on a message of the program as a warning at the line of the user."""
    warnings.warn(text.strip().removeprefix("cloudbow: "), Note, stacklevel=stacklevel)


def refuse(key: str, problem: str, found: Any, allowed: str) -> InputError:
    """The error of a key, in the program's form."""
    return InputError(f"{key}: {problem} (found {found}, allowed {allowed})")
