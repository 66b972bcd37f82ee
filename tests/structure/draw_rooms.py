#!/usr/bin/env python3
"""Draws docs/images/rooms.svg: the layers, and the rooms of the layers that have rooms, with the includes between them. An arrow leads from what
includes to what is included. An include that a chain of arrows implies is not drawn but named in the box ("also").

A public header belongs to the room of the source of its name; one without a source belongs to the layer alone and makes no arrow.

usage: draw_rooms.py ROOT [--check]     (--check: is the committed picture what the sources give, and are the tables of docs/architecture.md?)
"""
import re
import sys
import textwrap
from pathlib import Path

from test_layers import INCLUDE, LAYERS, ROOMS, ROOT, layer_of, room_of

PICTURE = ROOT / "docs/images/rooms.svg"
WIDTH, LINE, PAD, GAP, DROP = 176, 13, 9, 26, 34  # of a box; of a line of text; inside a box; between boxes; between rows
BEND = 18  # width that an arrow takes between boxes


def sources():
    return sorted(path for folder in ("include", "src") for path in (ROOT / folder).rglob("*.?pp"))


def layer_includes():
    """Pairs of layers of which the first includes the second."""
    found = set()
    for path in sources():
        layer = layer_of(path, ROOT)
        found |= {(layer, name) for name in re.findall(r'#include "cloudbow/(\w+)/', path.read_text()) if name != layer}
    return found


def room_includes(layer):
    """Pairs of rooms of a layer of which the first includes the second."""
    owner = {path.stem: path.parent.name for path in (ROOT / "src" / layer).glob("*/*.cpp")}
    found = set()
    for path in sources():
        if layer_of(path, ROOT) != layer:
            continue
        room = room_of(path, ROOT) or owner.get(path.stem)
        for _, target in INCLUDE.findall(path.read_text()):
            private = re.match(rf"{layer}/(\w+)/", target)
            public = re.match(rf"cloudbow/{layer}/(\w+)\.hpp", target)
            other = private[1] if private else owner.get(public[1]) if public else None
            if room and other and other != room:
                found.add((room, other))
    return found


def implied(edges):
    """Edges that a chain of two or more others implies."""
    reach = {}

    def reachable(node):
        if node not in reach:
            below = {b for a, b in edges if a == node}
            reach[node] = below.union(*(reachable(b) for b in below))
        return reach[node]

    return {(a, b) for a, b in edges if any(b in reachable(c) for x, c in edges if x == a and c != b)}


def rows_of(names, edges):
    """Rows from the bottom up, each of (node, ...); a node that is no name but an edge and a row is a bend of a long arrow. And the links between rows."""
    row = {}
    for name in names:  # from the lowest
        row[name] = 1 + max((row[b] for a, b in edges if a == name), default=-1)
    rows = [[] for _ in range(max(row.values()) + 1)]
    for name in names:
        rows[row[name]].append(name)
    links = []
    for a, b in sorted(edges, key=lambda edge: (names.index(edge[0]), names.index(edge[1]))):
        chain = [b, *((a, b, i) for i in range(row[b] + 1, row[a])), a]
        for i in range(row[b] + 1, row[a]):
            rows[i].append((a, b, i))
        links += list(zip(chain[1:], chain))  # upper, lower
    return rows, links


def crossings(rows, links):
    place = {node: (level, i) for level, row in enumerate(rows) for i, node in enumerate(row)}
    total = 0
    for n, (a, b) in enumerate(links):
        for c, d in links[:n]:
            total += place[a][0] == place[c][0] and (place[a][1] - place[c][1]) * (place[b][1] - place[d][1]) < 0
    return total


def ordered(rows, links):
    """Each row in the order of what its nodes are linked to, by turns from below and from above; the best of all turns."""
    best = [list(row) for row in rows]
    rows = [list(row) for row in rows]
    for turn in range(24):
        for level in range(len(rows)) if turn % 2 else reversed(range(len(rows))):
            at = {node: i for row in rows for i, node in enumerate(row)}

            def mean(node):
                near = [at[b] for a, b in links if a == node] if turn % 2 else [at[a] for a, b in links if b == node]
                return sum(near) / len(near) if near else at[node]

            rows[level].sort(key=mean)
        if crossings(rows, links) < crossings(best, links):
            best = [list(row) for row in rows]
    return best


def across(rows, links):
    """The middle of each node: in the order of its row, as near as may be to what it is linked to."""
    def half(node):
        return (WIDTH if isinstance(node, str) else BEND) / 2

    x = {}
    for row in rows:
        at = 0
        for node in row:
            x[node] = at + half(node)
            at += 2 * half(node) + GAP
    for _ in range(200):
        for row in rows:
            for node in row:
                near = [x[b] for a, b in links if a == node] + [x[a] for a, b in links if b == node]
                if near:
                    x[node] += 0.5 * (sum(near) / len(near) - x[node])
            for _ in range(20):
                for left, right in zip(row, row[1:]):
                    lack = half(left) + half(right) + GAP - (x[right] - x[left])
                    if lack > 0:
                        x[left] -= lack / 2
                        x[right] += lack / 2
    left = min(x[node] - half(node) for node in x)
    return {node: x[node] - left for node in x}, max(x[node] + half(node) for node in x) - left


def drawn(title, names, edges, accent):
    """SVG of a picture of its own from (0, 0), its width and its height."""
    up = sorted((a, b) for a, b in edges if names.index(a) < names.index(b))
    if up:
        sys.exit(f"{title}: includes that point up (test_layers.py says where): {', '.join(f'{a} to {b}' for a, b in up)}")
    hidden = implied(edges)
    rows, links = rows_of(names, edges - hidden)
    rows = ordered(rows, links)
    x, width = across(rows, links)
    also = {name: [b for b in names if (name, b) in hidden] for name in names}
    notes = {name: textwrap.wrap("also " + ", ".join(also[name]), 30) if also[name] else [] for name in names}
    tall = {name: 2 * PAD + 14 + LINE * len(notes[name]) for name in names}
    top, y = {}, 34
    for row in reversed(rows):
        height = max([tall[node] for node in row if isinstance(node, str)])
        for node in row:
            top[node] = (y + (height - tall[node]) / 2, tall[node]) if isinstance(node, str) else (y, height)
        y += height + DROP
    out = [f'<text class="title" x="0" y="14">{title}</text>']
    for upper, lower in links:
        x1, y1, x2, y2 = x[upper], sum(top[upper]), x[lower], top[lower][0]
        end = ' marker-end="url(#head)"' if isinstance(lower, str) else ""
        y2 -= 7 if end else 0
        bend = f"M{x1:.0f} {y1:.0f}C{x1:.0f} {(y1 + y2) / 2:.0f} {x2:.0f} {(y1 + y2) / 2:.0f} {x2:.0f} {y2:.0f}"
        through = "" if isinstance(lower, str) else f"V{sum(top[lower]):.0f}"
        out.append(f'<path d="{bend}{through}"{end}/>')
    for name in names:
        left, (upper, height) = x[name] - WIDTH / 2, top[name]
        kind = ' class="roomy"' if name in accent else ""
        out.append(f'<rect{kind} x="{left:.0f}" y="{upper:.0f}" width="{WIDTH}" height="{height}" rx="5"/>')
        out.append(f'<text class="name" x="{x[name]:.0f}" y="{upper + PAD + 11:.0f}">{name}</text>')
        out += [f'<text class="also" x="{x[name]:.0f}" y="{upper + PAD + 13 + LINE * (i + 1):.0f}">{line}</text>' for i, line in enumerate(notes[name])]
    return "\n".join(out), width, y - DROP


def picture():
    parts = [drawn("layers", [*LAYERS, "main"], layer_includes(), set(ROOMS))]
    parts += [drawn(f"rooms of {layer}", rooms, room_includes(layer), set()) for layer, rooms in ROOMS.items()]
    margin, between = 20, 56
    width = sum(part[1] for part in parts) + between * (len(parts) - 1) + 2 * margin
    height = max(part[2] for part in parts) + 2 * margin
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}">',
        "<!-- Written by tests/structure/draw_rooms.py from the includes of the sources. -->",
        "<style>",
        "text{font-family:'DejaVu Sans',Verdana,sans-serif;fill:#1b2733}.title{font-size:15px;font-weight:bold}",
        ".name{font-size:14px;text-anchor:middle}.also{font-size:10px;text-anchor:middle;fill:#5a6b7b}",
        "rect{fill:#eef4fa;stroke:#35618c;stroke-width:1.2}.roomy{fill:#fdf0d5;stroke:#a8741a}",
        "path{fill:none;stroke:#35618c;stroke-width:1.3}#head path{fill:#35618c;stroke:none}",
        "</style>",
        '<defs><marker id="head" viewBox="0 0 8 8" refX="1" refY="4" markerWidth="7" markerHeight="7" orient="auto"><path d="M0 0L8 4L0 8z"/></marker></defs>',
        f'<rect x="0" y="0" width="{width:.0f}" height="{height:.0f}" style="fill:#fff;stroke:none"/>',
    ]
    left = margin
    for svg, part_width, _ in parts:
        out.append(f'<g transform="translate({left:.0f} {margin})">\n{svg}\n</g>')
        left += part_width + between
    return "\n".join(out) + "\n</svg>\n"


def check_the_rules():
    edges = {("a", "b"), ("b", "c"), ("a", "c"), ("d", "c")}
    assert implied(edges) == {("a", "c")}
    rows, links = rows_of(["c", "b", "a"], edges - {("d", "c")})
    assert tabled("| x | y |\n| --- | --- |\n| `a` | `c` |\n| `b` | d |\n\n| `e` | f |\n", "x") == ["a", "b"]
    assert rows == [["c"], ["b", ("a", "c", 1)], ["a"]] and len(links) == 4, (rows, links)


def tabled(page, head):
    """The first column of the table whose head begins so, in order."""
    table = re.search(rf"^\| {re.escape(head)} \|.*\n\|[- |]+\n((?:\|.*\n)+)", page, re.MULTILINE)
    return re.findall(r"^\| `(\w+)` \|", table[1], re.MULTILINE) if table else []


def faults_of_tables(page):
    tables = {"layer": [*LAYERS, "main"], **{f"room of `{layer}`": rooms for layer, rooms in ROOMS.items()}}
    return [f"docs/architecture.md: table of {head}: {tabled(page, head)}, in test_layers.py {names}" for head, names in tables.items() if tabled(page, head) != names]


def main():
    check_the_rules()
    svg = picture()
    if "--check" not in sys.argv:
        PICTURE.write_text(svg)
        return 0
    faults = faults_of_tables((ROOT / "docs/architecture.md").read_text())
    if not PICTURE.exists() or PICTURE.read_text() != svg:
        faults.append("docs/images/rooms.svg is not what the sources give: tests/structure/draw_rooms.py . draws it anew")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
