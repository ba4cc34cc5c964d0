# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of worlds: shapes of a made-up world file, what sensors measured in the world's axes, and the drawing of both."""

import json
import math
import struct
import subprocess
import sys
from types import SimpleNamespace

import bench_programs
import numpy
import project
import pytest
import world_shapes
import worlds_pictures

DRAWING = project.ROOT / "tools/worlds_drawing.py"
PYTHON = project.ROOT / ".venv-plot/bin/python3"
RIDGE = "v 0 0 0\nv 4 0 0\nv 4 2 1\nv 0 2 1\nf 1/1 2/1 3/1 4/1\n"
QUARTER = f"0 0 {math.pi / 2:.9f}"
WORLD = f"""<sdf version="1.9"><world name="w">
  <model name="ground"><static>true</static><link name="l"><collision name="c"><geometry>
    <plane><normal>0 0 1</normal><size>9 9</size></plane></geometry></collision></link></model>
  <model name="yard"><pose>10 20 0 0 0 0</pose><static>true</static>
    <model name="shed"><pose>0 0 1 {QUARTER}</pose><link name="l"><pose>3 0 0 0 0 0</pose><collision name="c">
      <geometry><box><size>4 2 2</size></box></geometry></collision></link></model></model>
  <model name="pole"><static>true</static><pose>-5 0 2.5 0 0 0</pose><link name="l"><collision name="c">
    <geometry><cylinder><radius>0.5</radius><length>5</length></cylinder></geometry></collision></link></model>
  <model name="ball"><static>true</static><pose>0 -5 1 0 0 0</pose><link name="l"><collision name="c">
    <geometry><sphere><radius>1</radius></sphere></geometry></collision></link></model>
  <model name="ridge"><static>true</static><link name="l"><collision name="c">
    <geometry><mesh><uri>ridge.obj</uri><scale>2 1 3</scale></mesh></geometry></collision></link></model>
</world></sdf>
"""


def world(folder, text=WORLD):
    (folder / "ridge.obj").write_text(RIDGE)
    file = folder / "small.sdf"
    file.write_text(text)
    return file


def test_shapes_are_where_the_file_has_them(tmp_path):
    shapes = {shape.name: shape for shape in world_shapes.read(world(tmp_path))}
    ends = {name: (shape.vertices_m.min(axis=0).round(6).tolist(), shape.vertices_m.max(axis=0).round(6).tolist())
            for name, shape in shapes.items()}
    # The shed is turned left by 90 degrees: 3 m along its own x is 3 m north, and 4 m long is 4 m from south to north.
    assert ends["shed"] == ([9, 21, 0], [11, 25, 2])
    assert ends["pole"] == ([-5.5, -0.5, 0], [-4.5, 0.5, 5])
    assert ends["ball"] == ([-1, -6, 0], [1, -4, 2])
    assert ends["ridge"] == ([0, 0, 0], [8, 2, 3])
    assert shapes["ground"].triangles == [] and len(shapes["shed"].triangles) == 12 and len(shapes["ridge"].triangles) == 2


def area(shape) -> float:
    corners = shape.vertices_m[numpy.array(shape.triangles)]
    return 0.5 * numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()


def test_surfaces_are_whole(tmp_path):
    shapes = {shape.name: shape for shape in world_shapes.read(world(tmp_path))}
    assert area(shapes["shed"]) == pytest.approx(2 * (4 * 2 + 4 * 2 + 2 * 2))
    assert area(shapes["pole"]) == pytest.approx(2 * math.pi * 0.5 * (5 + 0.5), rel=5e-3)
    assert area(shapes["ball"]) == pytest.approx(4 * math.pi, rel=1e-2)


@pytest.mark.parametrize("changed, to, said", [
    ("<world", "<earth", "found no XML"),
    ("<box><size>4 2 2</size></box>", "<capsule/>", "model shed: found capsule, allowed box, cylinder, sphere, plane, mesh"),
    ("<size>4 2 2</size>", "<size>4 2</size>", "model shed: box: size: found '4 2', allowed 3 numbers"),
    ("<radius>1</radius>", "<radius>one</radius>", "model ball: sphere: radius: found 'one', allowed 1 numbers"),
    ("-5 0 2.5 0 0 0", "-5 0 nan 0 0 0", "model pole: pose: found '-5 0 nan 0 0 0', allowed 6 numbers"),
    ("ridge.obj", "nowhere.obj", "found mesh nowhere.obj, allowed an .obj file that is beside it"),
    ('<model name="pole">', '<include><uri>model://x</uri></include><model name="pole">', "found include"),
])
def test_a_bad_world_is_one_line(changed, to, said, tmp_path):
    file = world(tmp_path, WORLD.replace(changed, to))
    with pytest.raises(world_shapes.Refused) as refused:
        world_shapes.read(file)
    assert str(refused.value).startswith(f"{file}: ") and said in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize("line, said", [("f 1 2 9", "found no triangles, or corners that are no vertices"), ("v 1 b 2", "ridge.obj:6: found 'v 1 b 2'")])
def test_a_bad_mesh_is_one_line(line, said, tmp_path):
    file = world(tmp_path)
    (tmp_path / "ridge.obj").write_text(f"{RIDGE}{line}\n")
    with pytest.raises(world_shapes.Refused, match=said):
        world_shapes.read(file)


def test_a_missing_world_is_one_line(tmp_path):
    with pytest.raises(world_shapes.Refused, match="no.sdf: cannot be read: No such file"):
        world_shapes.read(tmp_path / "no.sdf")


def track(yaw_deg=0.0, pitch_deg=0.0):
    """At 3 m north, 1 m east, 2 m up."""
    yaw, pitch = 0.5 * math.radians(yaw_deg), 0.5 * math.radians(pitch_deg)
    turned = {"w": math.cos(yaw) * math.cos(pitch), "x": -math.sin(yaw) * math.sin(pitch), "y": math.cos(yaw) * math.sin(pitch),
              "z": math.sin(yaw) * math.cos(pitch)}
    pose = SimpleNamespace(position=SimpleNamespace(x=3.0, y=1.0, z=-2.0), orientation=SimpleNamespace(**turned))
    return worlds_pictures.Track([(t, SimpleNamespace(pose=pose)) for t in (0.0, 1.0)])


@pytest.mark.parametrize("yaw_deg, pitch_deg, ends", [
    (0, 0, [[1, 8, 2], [-1, 3, 2]]),  # forward is north, left is west
    (90, 0, [[6, 3, 2], [1, 5, 2]]),  # forward is east, left is north
    (0, -90, [[1, 3, -3], [-1, 3, 2]]),  # nose down
])
def test_beams_end_where_the_true_attitude_turns_them(yaw_deg, pitch_deg, ends):
    scan = SimpleNamespace(angle_min=0.0, angle_increment=math.pi / 4, ranges=[5.0, math.inf, 2.0])
    assert worlds_pictures.lidar_points(track(yaw_deg, pitch_deg), 0.5, scan).round(9).tolist() == ends


def test_what_the_stand_in_measured_is_in_our_axes():
    pixels = worlds_pictures.SCENARIO["agents"][0]["sensors"][0]["configuration"]
    count = pixels["CaptureWidth"] * pixels["CaptureHeight"]
    raw = {"location": struct.pack("<3f", 3.0, -1.0, 2.0), "rotation": struct.pack("<3f", 0.0, 60.0, 0.0), "below": struct.pack("<f", 4.0),
           "rgb": bytes([1, 2, 3, 255]) * count, "depth": bytes([2, 143, 92, 255]) * count}
    events = [{"event": "state", "tick": 7}] + [{"event": "measured", "tick": tick, "sensor": name, "bytes": value.hex()}
                                                for tick in (6, 7) for name, value in raw.items()]
    facts = worlds_pictures.stand_in_facts(events)
    assert facts["tick"] == 7 and facts["places_m"] == [[1.0, 3.0, 2.0]]
    assert facts["ground_m"] == [pytest.approx([3.0 - 4.0 * math.sin(math.radians(60)), 0.0])]
    assert facts["rgb"][0][0] == [3, 2, 1] and facts["depths_m"][0][0] == 10.0


@pytest.fixture(scope="module")
def plotting():
    bench_programs.environment(".venv-plot", "tools/requirements-plot.txt")


@pytest.fixture
def facts(tmp_path):
    shapes = [{"name": shape.name, "kind": shape.kind, "vertices_m": shape.vertices_m.tolist(), "triangles": shape.triangles}
              for shape in world_shapes.read(world(tmp_path))]
    flown = {"label": "kite", "points_m": [[0, 0, 0], [0, 10, 3], [10, 20, 1]],
             "marks": [{"text": "hit shed at 3 m/s", "crash": True, "point_m": [10, 20, 1]}]}
    return {"title": "small.sdf", "shapes": shapes, "paths": [flown]}


SENSED = {"at_s": 4.0, "reach_m": 40, "sensor_m": [0, 10, 3], "scan_m": [[10, 21, 1]], "scans_m": [[10, 21, 1], [0, 3, 0]],
          "depths_m": [[1.0, None], [2.0, 3.0]]}


@pytest.mark.parametrize("more", [{}, SENSED])
def test_a_picture_is_left(more, facts, plotting, tmp_path):
    (tmp_path / "facts.json").write_text(json.dumps({**facts, **more}))
    done = subprocess.run([PYTHON, DRAWING, tmp_path / "facts.json", tmp_path / "world.png"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    head = (tmp_path / "world.png").read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n" and min(struct.unpack(">2I", head[16:])) >= 600


def test_the_picture_is_to_scale_and_names_what_it_shows(facts, plotting, tmp_path):
    (tmp_path / "facts.json").write_text(json.dumps(facts))
    program = ("import json, sys; sys.path.insert(0, sys.argv[1]); import worlds_drawing as d\n"
               "figure = d.draw_world(json.load(open(sys.argv[2])))\n"
               "print(json.dumps({'axes': [[a.get_xlabel(), a.get_ylabel(), a.get_aspect(), a.get_xlim(), [t.get_text() for t in a.texts]]"
               " for a in figure.axes[:2]], 'legend': [t.get_text() for t in figure.legends[0].texts]}))")
    done = subprocess.run([PYTHON, "-c", program, DRAWING.parent, tmp_path / "facts.json"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    shown = json.loads(done.stdout)
    (above, east) = shown["axes"]
    assert above[:4] == ["east [m]", "north [m]", 1.0, pytest.approx([-13.5, 19.0])]
    assert east[:4] == ["north [m]", "up [m]", 1.0, pytest.approx([-14.0, 33.0])]
    assert sorted(above[4]) == ["ball, 2 m", "pole, 5 m", "ridge, 3 m", "shed, 2 m"]
    assert shown["legend"] == ["kite, from its start", "kite: hit shed at 3 m/s", "level ground, z = 0"]


@pytest.mark.parametrize("text, said", [(None, "No such file"), ("{", "Expecting"), ('{"title": "t"}', "found no 'paths', which the picture")])
def test_bad_facts_are_one_line_and_exit_code_2(text, said, plotting, tmp_path):
    file = tmp_path / "facts.json"
    if text is not None:
        file.write_text(text)
    done = subprocess.run([PYTHON, DRAWING, file, tmp_path / "world.png"], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and said in done.stderr and not (tmp_path / "world.png").exists()


def test_the_page_shows_every_picture():
    page = (project.ROOT / "docs/simulation/README.md").read_text()
    for name in worlds_pictures.PICTURES:
        assert f"](../img/{name}.png)" in page and (worlds_pictures.IMAGES / f"{name}.png").is_file()


def test_a_flight_that_is_refused_is_one_line(monkeypatch, tmp_path):
    monkeypatch.setattr(bench_programs, "program", lambda *words: sys.executable)
    with pytest.raises(RuntimeError, match="^fly --world x: .*fly"):
        worlds_pictures.fly(tmp_path, "--world", "x")
