#!/usr/bin/env python3
"""Writes docs/commands.md from the help texts of the program. Writes docs/python-api.md from the docstrings of the package.

usage: write_lookups.py PROGRAM ROOT [--check]      (--check: are the committed pages up to date?)
"""
import ast
import inspect
import re
import subprocess
import sys
from pathlib import Path

COMMANDS = """# Commands

Made from `--help` of the program (`tests/structure/write_lookups.py`). Every command has `-h,--help`.

"""
FUNCTIONS = """# Functions of the Python package

Made from the docstrings (`tests/structure/write_lookups.py`). [Python](python.md) shows how to use them; `help(cloudbow.run)` prints the same.

"""
COLUMN = 30  # of CLI11


def help_text(program, words):
    return subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True).stdout


def subcommands(text):
    """Names below "Subcommands:" of a help text."""
    part = re.search(r"^Subcommands:\n((?:  .*\n)+)", text, re.MULTILINE)
    return re.findall(r"^  (\w+)", part.group(1), re.MULTILINE) if part else []


def without_common(text):
    """A help text without the lines that all commands share: the option --help, and the exit codes at the end."""
    text = re.sub(r"\n  -h,--help .*", "", text)
    text = re.sub(r"\n+Exit codes: .*", "", text)
    return re.sub(r"\nOptions:\n(?=\n|$)", "\n", text).strip()


def table(lines):
    """Rows of positionals or options, each with its explanation, which may stand on the line below."""
    rows = []
    for line, below in zip(lines, [*lines[1:], "end"]):
        # Explanations begin in this column, on a line of their own if the name is longer. Without a name the line continues the one before.
        name, gap, what = line.strip().partition("  ")
        if not line[:COLUMN].strip():
            name, what = "", line
        elif not gap and below[:COLUMN].strip():
            name, what = line[:COLUMN].strip(), line[COLUMN:]
        if name:
            rows.append([name, what.strip()])
        else:
            rows[-1][1] = f"{rows[-1][1]} {what.strip()}".strip()
    return "| option | meaning |\n| --- | --- |\n" + "".join(row(*parts) for parts in rows)


def row(name, what):
    """Of the table of a command: the words of the parser about types and other options become plain ones."""
    name, _, needed = name.partition(" Needs: ")
    name, _, excluded = name.partition(" Excludes: ")
    name = re.sub(r"\b(?:INT|UINT|FLOAT|MINUTES|TEXT):(?=[N{])", "", name)
    for words, more in (("required", " REQUIRED" in name), (f"needs {needed}", needed), (f"not with {excluded.replace(' --', ', --')}", excluded)):
        what += f"; {words}" if more else ""
    name = name.replace(" REQUIRED", "").replace("|", "\\|")
    return f"| `{name}` | {what} |\n"


def commands_page(program):
    top = help_text(program, [])
    codes = re.search(r"^Exit codes: (.*)$", top, re.MULTILINE).group(1)
    text = f"{COMMANDS}**Exit codes**: {codes}.\n"

    def section(words):
        nonlocal text
        shown = help_text(program, words)
        inner = subcommands(shown)
        if inner:
            for name in inner:
                section([*words, name])
            return
        first, usage, *rest = filter(None, without_common(shown).split("\n"))
        text += f"\n## cloudbow {' '.join(words)}\n\n{first}. `{usage.removeprefix('Usage: ')}`\n\n{table([line for line in rest if line.startswith(' ')])}"

    for name in subcommands(top):
        section([name])
    return text


def signature(node):
    """Of a function, without annotations."""
    spec, parts = node.args, []
    for argument, default in zip(spec.args, [None] * (len(spec.args) - len(spec.defaults)) + spec.defaults):
        parts.append(argument.arg + (f"={ast.unparse(default)}" if default is not None else ""))
    parts += ["*"] if spec.kwonlyargs else []
    for argument, default in zip(spec.kwonlyargs, spec.kw_defaults):
        parts.append(argument.arg + (f"={ast.unparse(default)}" if default is not None else ""))
    return f"{node.name}({', '.join(parts)})"


def functions_page(root):
    trees = [ast.parse(path.read_text()) for path in sorted((root / "python/cloudbow").glob("*.py"))]
    nodes = {node.name: node for tree in trees for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    public = next(ast.literal_eval(node.value) for tree in trees for node in tree.body
                  if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__")
    text = FUNCTIONS.rstrip("\n") + "\n"
    for name in sorted(public, key=lambda name: (isinstance(nodes[name], ast.ClassDef), name)):
        node = nodes[name]
        head = signature(node) if isinstance(node, ast.FunctionDef) else name + "".join(f"({ast.unparse(base)})" for base in node.bases)
        text += f"\n## {name}\n\n```text\n{head}\n\n{inspect.cleandoc(ast.get_docstring(node))}\n"
        fields = [ast.unparse(field.target) for field in node.body if isinstance(field, ast.AnnAssign)] if isinstance(node, ast.ClassDef) else []
        text += (f"\nFields: {', '.join(fields)}\n" if fields else "") + "```\n"
    return text


def check_itself():
    text = "A tool\nUsage: x\n\nOptions:\n  -h,--help  Print\n  --a  Letter\n\nSubcommands:\n  one   First\n  two   Second\n\nExit codes: 0 done\n"
    assert subcommands(text) == ["one", "two"] and subcommands("A\n") == []
    assert without_common(text).endswith("Second") and "--help" not in without_common(text) and "--a" in without_common(text)
    assert table(["  --a INT:N REQUIRED".ljust(30) + "Letter", "  --b Excludes: --a", " " * 30 + "Two"]) == "| option | meaning |\n| --- | --- |\n| `--a N` | Letter; required |\n| `--b` | Two; not with --a |\n"
    assert signature(ast.parse("def f(a, b=1, *, c, d='x'): pass").body[0]) == "f(a, b=1, *, c, d='x')"


def main():
    check_itself()
    program, root = sys.argv[1], Path(sys.argv[2])
    pages = {"docs/commands.md": commands_page(program), "docs/python-api.md": functions_page(root)}
    stale = [name for name, text in pages.items() if not (root / name).exists() or (root / name).read_text() != text]
    if "--check" in sys.argv[3:]:
        print("\n".join(f"{name} is not what the program says: tests/structure/write_lookups.py PROGRAM . writes it anew" for name in stale) or "up to date")
        return 1 if stale else 0
    for name in stale:
        (root / name).write_text(pages[name])
        print(name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
