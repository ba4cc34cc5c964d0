# SPDX-License-Identifier: BSD-3-Clause
"""Usage: make_mesh.py SHAPE FILE

Writes a simple shape of a vehicle as an STL file, from boxes. In the file the nose is at -y, the left side
at x, the top at z: what the frame `stl_frame` turns to forward, left, up. Below, y is forward and x right.
"""

import sys
from itertools import product
from math import cos, radians, sin

# centre, size (x right, y forward, z up), turn about z [deg]
SHAPES = {
    "multirotor": [((0, 0, 0.0), (0.16, 0.22, 0.07), 0),
                   ((0, 0, 0.0), (0.03, 0.65, 0.02), 45), ((0, 0, 0.0), (0.03, 0.65, 0.02), -45),
                   ((0, 0.12, 0.03), (0.04, 0.06, 0.03), 0)]
                  + [((x, y, 0.03), (0.04, 0.04, 0.06), 0) for x, y in product((-0.23, 0.23), repeat=2)]
                  + [((x, y, 0.065), (0.02, 0.38, 0.005), turn)
                     for x, y in product((-0.23, 0.23), repeat=2) for turn in (30, -30)]
                  + [((x, y, -0.1), (0.02, 0.02, 0.2), 0) for x, y in product((-0.12, 0.12), repeat=2)],
    "fixedwing": [((0, 0.05, 0), (0.14, 1.1, 0.14), 0), ((0, 0.1, 0.08), (2.06, 0.24, 0.03), 0),
                  ((0, -0.65, 0.02), (0.04, 0.5, 0.04), 0), ((0, -0.85, 0.02), (0.7, 0.16, 0.02), 0),
                  ((0, -0.85, 0.12), (0.02, 0.16, 0.2), 0), ((0, 0.62, 0), (0.38, 0.01, 0.03), 0)],
}
# Corners of the six faces of a box, anticlockwise from outside; corner = x + 2 y + 4 z.
FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def box(centre, size, turn):
    c, s = cos(radians(turn)), sin(radians(turn))
    corners = []
    for z, y, x in product((-0.5, 0.5), repeat=3):
        px, py = x * size[0], y * size[1]
        corners.append((-centre[0] - c * px + s * py, -centre[1] - s * px - c * py,
                        centre[2] + z * size[2]))
    return corners


def triangles(shape):
    for part in SHAPES[shape]:
        corners = box(*part)
        for a, b, c, d in FACES:
            yield corners[a], corners[b], corners[c]
            yield corners[a], corners[c], corners[d]


def normal(a, b, c):
    u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = sum(x * x for x in n) ** 0.5
    return tuple(x / length for x in n)


def main(shape, file):
    lines = [f"solid {shape}"]
    for corners in triangles(shape):
        lines += ["facet normal {:.6g} {:.6g} {:.6g}".format(*normal(*corners)), "outer loop"]
        lines += ["vertex {:.6g} {:.6g} {:.6g}".format(*corner) for corner in corners]
        lines += ["endloop", "endfacet"]
    with open(file, "w") as out:
        out.write("\n".join([*lines, f"endsolid {shape}", ""]))


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in SHAPES:
        sys.exit(f"make_mesh: found {sys.argv[1:]}, allowed one of {', '.join(SHAPES)} and a file")
    main(*sys.argv[1:])
