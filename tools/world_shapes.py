# SPDX-License-Identifier: BSD-3-Clause
"""Reads the shapes of an SDF world as triangles, for pictures: x east, y north, z up, as in the file.

Of each collision in a static model: box, cylinder, sphere, mesh (.obj) and plane, with the poses of model, nested model, link and
collision. Anything else is an error of one line. The simulation reads the same files by sim/world/read_sdf.hpp.
"""

import dataclasses
import math
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy

SIDES = 48  # of what is round


class Refused(RuntimeError):
    """One line for the user."""


@dataclasses.dataclass
class Shape:
    name: str  # of its model
    kind: str
    vertices_m: numpy.ndarray  # n x 3; of a plane the one point that it passes through
    triangles: list[list[int]]  # none of a plane


def read(file: Path) -> list[Shape]:
    try:
        root = ElementTree.parse(file).getroot()
    except OSError as error:
        raise Refused(f"{file}: cannot be read: {error.strerror}") from None
    except ElementTree.ParseError as error:
        raise Refused(f"{file}: found no XML: {error}") from None
    worlds = root.findall("world")
    if root.tag != "sdf" or len(worlds) != 1:
        raise Refused(f"{file}: found {len(worlds)} worlds, allowed 1")
    if worlds[0].find(".//include") is not None:
        raise Refused(f"{file}: found include, allowed models that are in the file")
    return [shape for model in worlds[0].findall("model") for shape in of_model(file, model, numpy.eye(4))]


def of_model(file: Path, model, outer: numpy.ndarray) -> list[Shape]:
    name = model.get("name", "")
    here = outer @ pose(file, name, model)
    found = [shape for nested in model.findall("model") for shape in of_model(file, nested, here)]
    for link in model.findall("link"):
        at_link = here @ pose(file, name, link)
        for collision in link.findall("collision"):
            kind, vertices_m, triangles = geometry(file, name, collision.find("geometry"))
            turned = at_link @ pose(file, name, collision)
            found.append(Shape(name, kind, vertices_m @ turned[:3, :3].T + turned[:3, 3], triangles))
    return found


def pose(file: Path, name: str, element) -> numpy.ndarray:
    """4 x 4, from the axes of the element to those around it."""
    place = numpy.eye(4)
    found = element.find("pose")
    if found is None:
        return place
    if found.attrib:
        raise Refused(f"{file}: model {name}: found a pose with {', '.join(found.attrib)}, allowed none")
    x, y, z, roll, pitch, yaw = numbers(file, f"model {name}: pose", found.text, 6)
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle), math.cos(angle)) for angle in (roll, pitch, yaw))
    place[:3, :3] = [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]]
    place[:3, 3] = x, y, z
    return place


def numbers(file: Path, where: str, text: str | None, count: int) -> list[float]:
    try:
        values = [float(word) for word in (text or "").split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise Refused(f"{file}: {where}: found '{(text or '').strip()}', allowed {count} numbers")
    return values


def geometry(file: Path, name: str, element) -> tuple[str, numpy.ndarray, list[list[int]]]:
    shape = None if element is None else next(iter(element), None)
    kind = "no geometry" if shape is None else shape.tag
    if kind not in SHAPES:
        raise Refused(f"{file}: model {name}: found {kind}, allowed {', '.join(SHAPES)}")

    def of(key: str, count: int = 1) -> list[float]:
        return numbers(file, f"model {name}: {kind}: {key}", shape.findtext(key), count)

    return kind, *SHAPES[kind](file, shape, of)


def box(_file, _shape, of):
    half = 0.5 * numpy.array(of("size", 3))
    rectangle = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    return prism([(x * half[0], y * half[1]) for x, y in rectangle], half[2])


def cylinder(_file, _shape, of):
    radius_m, length_m = of("radius")[0], of("length")[0]
    around = [2.0 * math.pi * k / SIDES for k in range(SIDES)]
    return prism([(radius_m * math.cos(angle), radius_m * math.sin(angle)) for angle in around], 0.5 * length_m)


def prism(outline: list[tuple[float, float]], half_m: float):
    count = len(outline)
    vertices_m = [(*point, z) for z in (-half_m, half_m) for point in outline]
    triangles = [[base, base + k, base + k + 1] for base in (0, count) for k in range(1, count - 1)]
    for k in range(count):
        right = (k + 1) % count
        triangles += [[k, right, count + k], [right, count + right, count + k]]
    return numpy.array(vertices_m), triangles


def sphere(_file, _shape, of):
    radius_m, rows = of("radius")[0], SIDES // 2
    vertices_m = [(radius_m * math.sin(down) * math.cos(around), radius_m * math.sin(down) * math.sin(around), radius_m * math.cos(down))
                  for down in (math.pi * k / rows for k in range(rows + 1)) for around in (2.0 * math.pi * k / SIDES for k in range(SIDES))]
    corners = [(row * SIDES, k, (k + 1) % SIDES) for row in range(rows) for k in range(SIDES)]
    triangles = [[first + k, first + right, first + SIDES + k] for first, k, right in corners]
    triangles += [[first + right, first + SIDES + right, first + SIDES + k] for first, k, right in corners]
    return numpy.array(vertices_m), triangles


def plane(_file, _shape, _of):
    return numpy.zeros((1, 3)), []


def mesh(file, shape, of):
    path = file.parent / (shape.findtext("uri") or "").strip().removeprefix("file://").removeprefix("model://")
    if path.suffix != ".obj" or not path.is_file():
        raise Refused(f"{file}: found mesh {path.name or 'without uri'}, allowed an .obj file that is beside it")
    scale = of("scale", 3) if shape.find("scale") is not None else [1.0, 1.0, 1.0]
    vertices_m, triangles = [], []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        key, *words = line.split() or [""]
        try:
            if key == "v":
                vertices_m.append([float(word) for word in words[:3]])
            elif key == "f":
                index = [int(word.partition("/")[0]) - 1 for word in words]
                triangles += [[index[0], index[k], index[k + 1]] for k in range(1, len(index) - 1)]
        except ValueError:
            raise Refused(f"{path}:{number}: found '{line.strip()}', allowed numbers") from None
    if not triangles or any(not 0 <= corner < len(vertices_m) for triangle in triangles for corner in triangle):
        raise Refused(f"{path}: found no triangles, or corners that are no vertices")
    return numpy.array(vertices_m) * scale, triangles


SHAPES = {"box": box, "cylinder": cylinder, "sphere": sphere, "plane": plane, "mesh": mesh}
