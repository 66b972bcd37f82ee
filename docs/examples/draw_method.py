#!/usr/bin/env python3
"""Draws the figures of docs/theory.md: control points, a march, the final gather. Plain SVG.

usage: draw_method.py FOLDER      (docs/images)
"""
import sys
from pathlib import Path

import numpy as np

BLUE, RED, GREY, INK = "#1f5fa8", "#c4442d", "#9aa5b1", "#1c2733"


class Drawing:
    """Lines, polygons, dots and words on a white sheet, y downward."""

    def __init__(self, width, height):
        self.size, self.parts = (width, height), []

    def polygon(self, points, fill, opacity=1.0, stroke="none"):
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(f'<polygon points="{text}" fill="{fill}" fill-opacity="{opacity}" stroke="{stroke}"/>')

    def line(self, start, end, colour=INK, width=1.5, dashed=False, arrow=False):
        style = ' stroke-dasharray="5 4"' if dashed else ""
        style += ' marker-end="url(#arrow)"' if arrow else ""
        self.parts.append(f'<line x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}" stroke="{colour}" stroke-width="{width}"{style}/>')

    def dot(self, centre, radius, fill):
        self.parts.append(f'<circle cx="{centre[0]:.1f}" cy="{centre[1]:.1f}" r="{radius}" fill="{fill}"/>')

    def word(self, at, text, colour=INK, size=15, anchor="middle", italic=False):
        style = ' font-style="italic"' if italic else ""
        self.parts.append(f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" fill="{colour}" font-size="{size}" text-anchor="{anchor}"{style}>{text}</text>')

    def save(self, path):
        width, height = self.size
        head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-family="DejaVu Sans, Arial, sans-serif">'
        arrow = f'<defs><marker id="arrow" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto"><path d="M0 0L8 4L0 8z" fill="{INK}"/></marker></defs>'
        path.write_text("\n".join([head, arrow, f'<rect width="{width}" height="{height}" fill="white"/>', *self.parts, "</svg>"]) + "\n")


def icosphere(divisions):
    """Vertices (n, 3) and triangles (m, 3) of an icosahedron, each triangle divided into four `divisions` times."""
    golden = (1 + 5**0.5) / 2
    points = [np.array(p) / np.hypot(1, golden) for s in (1, -1) for t in (golden, -golden) for p in ((0, s, t), (s, t, 0), (t, 0, s))]
    edge = min(np.linalg.norm(points[0] - p) for p in points[1:]) * 1.01
    near = lambda a, b: np.linalg.norm(points[a] - points[b]) < edge
    triangles = [(a, b, c) for a in range(12) for b in range(a + 1, 12) for c in range(b + 1, 12) if near(a, b) and near(b, c) and near(a, c)]
    for _ in range(divisions):
        middle = {}

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                centre = points[a] + points[b]
                middle[key] = len(points)
                points.append(centre / np.linalg.norm(centre))
            return middle[key]

        parts = []
        for a, b, c in triangles:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            parts += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = parts
    return np.array(points), triangles


def control_points(path):
    drawing = Drawing(760, 340)
    points, triangles = icosphere(2)
    turn = np.linalg.qr(np.array([[0.8, 0.3, 0.5], [-0.4, 0.9, 0.2], [-0.3, -0.3, 0.9]]))[0]
    seen = points @ turn.T
    flat = np.array([170.0, 170.0]) + 145 * seen[:, :2] * [1, -1]
    for corners in triangles:
        if np.mean(seen[list(corners), 2]) > 0:
            drawing.polygon(flat[list(corners)], "#f2f5f9", 1, GREY)
    for n in np.flatnonzero(seen[:, 2] > 0):
        drawing.dot(flat[n], 3.2, BLUE)
    face = max(triangles, key=lambda corners: np.mean(seen[list(corners), 2]))
    drawing.polygon(flat[list(face)], RED, 0.35, RED)
    drawing.line(flat[face[0]] + [20, -2], (430, 120), GREY, 1.2, dashed=True)

    a, b, c, o = np.array([560.0, 45.0]), np.array([440.0, 275.0]), np.array([700.0, 265.0]), np.array([590.0, 185.0])
    drawing.polygon([a, b, c], "#f2f5f9", 1, INK)
    drawing.polygon([o, b, c], RED, 0.35, "none")
    for corner in (a, b, c):
        drawing.line(o, corner, GREY)
        drawing.dot(corner, 5, BLUE)
    drawing.dot(o, 5, RED)
    for at, text in ((a + [0, -14], "q(A)"), (b + [-6, 26], "q(B)"), (c + [6, 26], "q(C)"), (o + [16, -8], "Ω")):
        drawing.word(at, text)
    drawing.word((572, 245), "weight of A", RED, 13)
    drawing.save(path)


def march(path):
    drawing = Drawing(760, 250)
    left, width, top, height = 90, 190, 50, 140
    for n, shade in enumerate((0.10, 0.35, 0.20)):
        x = left + n * width
        drawing.polygon([(x, top), (x + width, top), (x + width, top + height), (x, top + height)], BLUE, shade, INK)
    entry = lambda x: np.array([x, 75.0 + (x - 90) * 0.155])
    ends = [left + n * width for n in range(4)]
    drawing.line(entry(30), entry(left), INK, 2)
    for n, (start, end) in enumerate(zip(ends, ends[1:])):
        drawing.line(entry(start), entry(end), RED, 5 - 1.2 * n)
        middle = entry((start + end) / 2)
        drawing.word(middle + [0, -14], f"t{'₁₂₃'[n]}, I mean", INK, 14, italic=True)
        drawing.word((start + width / 2, top + height + 22), f"source S{'₁₂₃'[n]}", BLUE, 14)
    drawing.line(entry(ends[-1]), entry(ends[-1] + 70), INK, 2, arrow=True)
    for x in ends:
        drawing.dot(entry(x), 4, INK)
    drawing.word(entry(40) + [0, -12], "I in", italic=True)
    drawing.word(entry(ends[-1] + 45) + [0, -12], "I out", italic=True)
    drawing.word((380, 236), "I out = I in exp(-t) + what the source adds; the mean of I goes to the cell", GREY, 14)
    drawing.save(path)


def final_gather(path):
    drawing = Drawing(760, 360)
    ground, eye = 310.0, np.array([300.0, 310.0])
    for n, low in enumerate((0, 28, 72, 142)):
        high = (28, 72, 142, 255)[n]
        drawing.polygon([(40, ground - low), (720, ground - low), (720, ground - high), (40, ground - high)], GREY, 0.06 + 0.07 * n)
        drawing.word((714, ground - low - 8), f"band {n + 1}", GREY, 12, anchor="end")
    cloud = [(430, 150), (445, 110), (490, 95), (520, 65), (580, 70), (610, 105), (640, 120), (640, 150)]
    drawing.polygon(cloud, BLUE, 0.45, BLUE)
    drawing.word((545, 125), "cloud: source S(Ω)", INK, 14)
    for degrees in (-30, -10, 15, 35, 47, 57):
        slope = np.tan(np.radians(degrees))
        end = eye + [255 * slope, -255] if abs(slope) < 1.05 else eye + [np.sign(slope) * 268, -268 / abs(slope)]
        if degrees > 0 and end[0] > 700:
            end = eye + [400, -400 / slope]
        drawing.line(eye, end, RED, 1.5, arrow=True)
    drawing.line((40, ground), (720, ground), INK, 2)
    for x in range(40, 721, 40):
        drawing.line((x, ground), (x, ground + 8), INK, 1)
    drawing.dot(eye, 5, RED)
    drawing.word((300, 342), "receiving column", RED, 14)
    for n, spread in enumerate((8, 16, 30, 54)):
        height = (14, 50, 107, 195)[n]
        drawing.line((105 - spread, ground - height), (105 + spread, ground - height), INK, 3)
    drawing.word((105, 95), "blur of a band", INK, 13)
    drawing.save(path)


def main():
    folder = Path(sys.argv[1])
    control_points(folder / "control_points.svg")
    march(folder / "march.svg")
    final_gather(folder / "final_gather.svg")


if __name__ == "__main__":
    main()
