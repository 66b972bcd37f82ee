"""A scene from a dict to TOML, exactly: numbers keep their bits, text its characters."""
import datetime
import os
import re
from collections.abc import Mapping
from typing import Any

from ._errors import refuse

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
MOST_LEVELS = 32  #: as scene files may have
_ESCAPES = {"\b": "\\b", "\t": "\\t", "\n": "\\n", "\f": "\\f", "\r": "\\r", '"': '\\"', "\\": "\\\\"}


def text_of(text: str) -> str:
    """A basic string of TOML."""
    return '"' + "".join(_ESCAPES.get(c, c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}") for c in text) + '"'


def key_of(key: str) -> str:
    return key if _BARE_KEY.fullmatch(key) else text_of(key)


def check_text(text: str, key: str) -> None:
    """Half of a surrogate pair is a character of Python and of no file."""
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        raise refuse(key, "no text", ascii(text[:80]), "characters of Unicode") from None


def check_levels(level: int, key: str) -> None:
    """A dict that contains itself has no end."""
    if level > MOST_LEVELS:
        raise refuse(key.partition(".")[0] or "scene", "nested too deeply", f"more than {MOST_LEVELS} levels of keys, lists and tables", str(MOST_LEVELS))


def plain(value: Any, key: str, level: int = 0) -> Any:
    """The value with numbers of numpy as those of Python, arrays of one dimension as lists, paths as text."""
    check_levels(level, key)
    if isinstance(value, Mapping):
        for name in value:
            if not isinstance(name, str):
                raise refuse(key or "scene", "a key that is no text", repr(name), "text")
            check_text(name, key or "scene")
        return {name: plain(item, f"{key}.{name}" if key else name, level + 1) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item, f"{key}.{n}", level + 1) for n, item in enumerate(value)]
    if isinstance(value, os.PathLike):
        return plain(os.fspath(value), key, level + 1)
    if isinstance(value, (bool, int, float, str)) and type(value).__module__ == "builtins":
        if isinstance(value, str):
            check_text(value, key)
        return value
    if hasattr(value, "ndim") and (hasattr(value, "tolist") or hasattr(value, "values")):
        if value.ndim > 1:
            raise refuse(key, "an array", f"{value.ndim} dimensions", "a number, a list, or an array where a grid or a map may stand")
        return plain(value.tolist() if not hasattr(value, "values") else value.values.tolist(), key, level + 1)
    if isinstance(value, (datetime.date, datetime.time)):
        raise refuse(key, "a date or time", repr(value), "a number, text, true or false, a list or a dict")
    raise refuse(key, "no value of a scene", type(value).__name__, "a number, text, true or false, a list or a dict")


def value_of(value: Any) -> str:
    """A value on one line; tables are inline tables."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return text_of(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(value_of, value)) + "]"
    return "{" + ", ".join(f"{key_of(key)} = {value_of(item)}" for key, item in value.items()) + "}"


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def _write(table: dict, path: str, lines: list) -> None:
    tables = {key: value for key, value in table.items() if isinstance(value, dict) or _is_tables(value)}
    lines += [f"{key_of(key)} = {value_of(value)}" for key, value in table.items() if key not in tables]
    for key, value in tables.items():
        name = f"{path}.{key_of(key)}" if path else key_of(key)
        for item in [value] if isinstance(value, dict) else value:
            lines += ["", f"[{name}]" if isinstance(value, dict) else f"[[{name}]]"]
            _write(item, name, lines)


def document(table: dict) -> str:
    """TOML of a dict of plain values: tomllib.loads() of it gives the dict again."""
    lines: list = []
    _write(table, "", lines)
    return "\n".join(lines).lstrip("\n") + "\n"
