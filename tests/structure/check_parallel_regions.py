#!/usr/bin/env python3
"""No exception may leave an OpenMP region: each has a ParallelErrors (core/parallel_errors.hpp) before it, whose rethrow() stands after it, or says
that nothing in it throws. Loops `parallel for simd` are arithmetic alone.

usage: check_parallel_regions.py ROOT
"""
import re
import sys
from pathlib import Path

REGION = re.compile(r"^[ \t]*#pragma omp parallel\b(?!.*\bsimd\b)", re.MULTILINE)
ABOVE = 4  # lines in which the guard or the remark stands


def faults(name, text):
    lines = text.splitlines()
    found = []
    guards = 0
    for match in REGION.finditer(text):
        at = text.count("\n", 0, match.start())
        before = "\n".join(lines[max(0, at - ABOVE):at])
        if re.search(r"\bParallelErrors \w+;", before):
            guards += 1
        elif "Nothing throws here" not in before:
            found.append(f"{name}:{at + 1}: a parallel region without ParallelErrors, and without the remark \"Nothing throws here\"")
    if text.count(".rethrow();") < guards:
        found.append(f"{name}: {guards} guarded regions, and fewer calls of rethrow()")
    return found


def check_the_checker():
    region = "#pragma omp parallel for\nfor (;;) f();\n"
    assert faults("a", region)
    assert faults("a", "ParallelErrors errors;\n" + region)
    assert not faults("a", "ParallelErrors errors;\n" + region + "errors.rethrow();\n")
    assert not faults("a", "// Nothing throws here.\n" + region)
    assert not faults("a", "#pragma omp parallel for simd\n")


def main():
    check_the_checker()
    root = Path(sys.argv[1])
    found = []
    for path in sorted([*root.glob("src/**/*.cpp"), *root.glob("src/**/*.hpp"), *root.glob("include/**/*.hpp")]):
        found += faults(path.relative_to(root), path.read_text())
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
