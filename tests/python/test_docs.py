"""The Python of docs/python.md runs as it stands there; the page and the docstrings have every function and argument.

Truth: the page, and the signatures of the package.
"""
import inspect
import re
import subprocess
import sys
from pathlib import Path

import cloudbow as cb

PAGE = Path(__file__).resolve().parents[2] / "docs/python.md"


def test_the_page_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for block in re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL):
        exec(compile(block, str(PAGE), "exec"), names)
    assert (tmp_path / "heating.png").stat().st_size > 1000
    assert float(names["day"].max()) > 0 and names["series"].sizes["zenith_deg"] == 3


def test_the_figure_of_sweeps_needs_no_comparison(layers, tmp_path):
    for compare in (False, True):
        picture = tmp_path / f"{compare}.png"
        cb.sweep(layers, {"sun.zenith_deg": [0, 40]}, compare=compare, output=tmp_path / f"{compare}.h5")
        subprocess.run([sys.executable, PAGE.parent / "examples/plot_sweep.py", tmp_path / f"{compare}.h5", picture], check=True)
        assert picture.stat().st_size > 1000


def test_the_page_has_every_name():
    text = PAGE.read_text()
    for name in cb.__all__:
        assert f"`{name}" in text, name


def test_functions_explain_every_argument():
    for name in cb.__all__:
        thing = getattr(cb, name)
        assert thing.__doc__, name
        if inspect.isfunction(thing) and name != "check":  # whose arguments are those of run
            for argument in inspect.signature(thing).parameters:
                assert re.search(rf"\b{argument}\b", thing.__doc__), f"{name}: {argument}"
        if inspect.isfunction(thing):
            assert not [a for a, p in inspect.signature(thing).parameters.items() if p.annotation is p.empty], name
            assert inspect.signature(thing).return_annotation is not inspect.Signature.empty, name
