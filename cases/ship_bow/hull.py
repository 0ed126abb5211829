# SPDX-License-Identifier: MIT
"""Writes hull.ply.gz, a Wigley hull of length 1, beam 0.2 and draft 0.1 with plumb sides above the water and a flat deck.

    y = +-B/2 (1 - (2x/L)^2) (1 - (z/T)^2) below z = 0, y = +-B/2 (1 - (2x/L)^2) above it, to the deck at z = 0.1

x points ahead, z up. The file of the case is what this script writes; it takes a second.
"""
import gzip
import struct
from pathlib import Path

import numpy as np

LENGTH, BEAM, DRAFT, FREEBOARD = 1.0, 0.2, 0.1, 0.1
ALONG, UP, ACROSS = 224, 100, 24  # cells of a side along x and z, and of the deck along y


def hull():
    """Points (N, 3) and faces: lists of three or four corners, counter-clockwise seen from outside."""
    points, faces, known = [], [], {}

    def number(*place):
        # The sides meet in the stems and in the keel, and the deck joins them.
        if place not in known:
            known[place] = len(points)
            points.append(place)
        return known[place]

    def face(*corners):
        corners = list(dict.fromkeys(corners))
        if len(corners) > 2:
            faces.append(corners)

    xs = np.round(np.linspace(-LENGTH / 2, LENGTH / 2, ALONG + 1), 12)
    zs = np.round(np.linspace(-DRAFT, FREEBOARD, UP + 1), 12)

    def half_width(x, z):
        return round(BEAM / 2 * (1 - (2 * x / LENGTH) ** 2) * (1 - (min(z, 0.0) / DRAFT) ** 2), 7)

    for side in (-1, 1):
        grid = [[number(x, side * half_width(x, z), z) for z in zs] for x in xs]
        for i in range(ALONG):
            for k in range(UP):
                corners = grid[i][k], grid[i + 1][k], grid[i + 1][k + 1], grid[i][k + 1]
                face(*(corners if side < 0 else corners[::-1]))
    shares = np.linspace(-1, 1, ACROSS + 1)
    deck = [[number(x, round(s * half_width(x, zs[-1]), 7), zs[-1]) for s in shares] for x in xs]
    for i in range(ALONG):
        for j in range(ACROSS):
            face(deck[i][j], deck[i + 1][j], deck[i + 1][j + 1], deck[i][j + 1])
    return np.array(points), faces


def main():
    points, faces = hull()
    head = (f"ply\nformat binary_little_endian 1.0\ncomment Wigley hull, L {LENGTH:g} B {BEAM:g} T {DRAFT:g}, by hull.py\n"
            f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(faces)}\nproperty list uchar uint vertex_indices\nend_header\n").encode()
    body = points.astype("<f4").tobytes() + b"".join(struct.pack(f"<B{len(f)}I", len(f), *f) for f in faces)
    with open(Path(__file__).with_name("hull.ply.gz"), "wb") as out:
        # Without the time of writing: the same bytes whenever it is written.
        with gzip.GzipFile(filename="", mode="wb", compresslevel=9, fileobj=out, mtime=0) as zipped:
            zipped.write(head + body)
    print(len(points), "points,", sum(len(face) - 2 for face in faces), "triangles")


if __name__ == "__main__":
    main()
