# SPDX-License-Identifier: BSD-3-Clause
"""./rosflight bench worlds: pictures of the worlds, with flights in them and what sensors measured there, for docs/simulation/README.md.

By hand, without the table: .venv/bin/python3 tools/worlds_pictures.py

Each flight is made by ./rosflight fly. This file collects its facts in build/worlds/NAME.json, tools/worlds_drawing.py draws them.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import bench_programs
import log_table
import numpy
import project
import world_shapes
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

FIELD = "flight/gazebo/test/worlds/field.sdf"
WALL = "examples/new_sensor/wall.sdf"
FACTS = project.ROOT / "build/worlds"
IMAGES = project.ROOT / "docs/img"
STANDIN = project.ROOT / "viewer/holoocean/test/standin_engine.py"
REACH_M = 40  # of lidar and depth camera
SENSORS = ["--set", f"world_sensors={{scan: {{type: lidar, noise_sigma_m: 0.02, max_m: {REACH_M}}}, "
           f"depth: {{type: depth_camera, width_px: 160, height_px: 120, max_m: {REACH_M}}}}}"]
# Moments of the default mission, since power-up: above the start, and at the first waypoint, 8 m north. The vehicle faces north.
ABOVE_THE_START_S, FIRST_WAYPOINT_S = 9.5, 13.7
SCENARIO = {"package_name": "Land", "ticks_per_sec": 30, "frames_per_sec": False, "agents": [{"agent_type": "UavAgent", "sensors": [
    {"sensor_type": "RGBCamera", "sensor_name": "rgb", "Hz": 2, "configuration": {"CaptureWidth": 96, "CaptureHeight": 72}},
    {"sensor_type": "DepthCamera", "sensor_name": "depth", "Hz": 2, "configuration": {"CaptureWidth": 96, "CaptureHeight": 72}},
    {"sensor_type": "LocationSensor", "sensor_name": "location"}, {"sensor_type": "RotationSensor", "sensor_name": "rotation"},
    {"sensor_type": "RangeFinderSensor", "sensor_name": "below", "configuration": {"LaserMaxDistance": 100, "LaserAngle": -90}}]}]}
PICTURES = ("world_plain", "world_field", "world_field_sensors", "world_wall_sensors", "world_holoocean")


def fly(folder: Path, *words: str, environment: dict | None = None):
    """A mission that fails is a flight too: exit code 1, and a log."""
    done = subprocess.run([bench_programs.program("rosflight", "apps"), "fly", *words, "--out", str(folder)], cwd=project.ROOT,
                          env=environment, capture_output=True, text=True)
    if done.returncode not in (0, 1) or not (folder / "flight.mcap").is_file():
        raise RuntimeError(f"fly {' '.join(words)}: {(done.stderr.strip().splitlines() or ['it printed nothing'])[-1]}")


def messages(flight: Path, *topics: str) -> dict[str, list]:
    """Of each topic its messages with their times since the start of the flight."""
    path = log_table.log_of(flight)
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        summary = log_table.summary_of(reader, path)
        start_ns = min([each.log_time for each in summary.attachment_indexes], default=summary.statistics.message_start_time)
        found: dict[str, list] = {topic: [] for topic in topics}
        for _, channel, record, message in reader.iter_decoded_messages(topics=list(topics)):
            found[channel.topic].append(((record.log_time - start_ns) / 1e9, message))
    missing = [topic for topic, rows in found.items() if not rows]
    if missing:
        raise RuntimeError(f"{path}: found no message of {', '.join(missing)}")
    return found


class Track:
    """The true motion of a flight: east, north, up."""

    def __init__(self, rows: list):
        self.times_s = numpy.array([time_s for time_s, _ in rows])
        poses = [message.pose for _, message in rows]
        self.positions_m = numpy.array([(pose.position.y, pose.position.x, -pose.position.z) for pose in poses])
        self.attitudes = numpy.array([(pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z) for pose in poses])

    def position_m(self, time_s: float) -> numpy.ndarray:
        return numpy.array([numpy.interp(time_s, self.times_s, axis) for axis in self.positions_m.T])

    def rotation(self, time_s: float) -> numpy.ndarray:
        """From forward, left, up of the body to east, north, up."""
        w, x, y, z = self.attitudes[numpy.abs(self.times_s - time_s).argmin()]
        to_ned = numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                              [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                              [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
        return to_ned[[1, 0, 2]] * [[1], [1], [-1]] * [1, -1, -1]


def path(flight: Path, label: str) -> dict:
    """The true path, and what the world has reported: contacts, or a crash."""
    found = messages(flight, "/sim/truth_state", "/rosout")
    track = Track(found["/sim/truth_state"])
    marks = [{"text": message.msg, "crash": message.level >= 40, "point_m": track.position_m(time_s).tolist()}
             for time_s, message in found["/rosout"] if message.name == "world"]
    return {"label": label, "points_m": track.positions_m[::5].round(3).tolist(), "marks": marks}


def shapes(file: str) -> list[dict]:
    return [{"name": shape.name, "kind": shape.kind, "vertices_m": shape.vertices_m.tolist(), "triangles": shape.triangles}
            for shape in world_shapes.read(project.ROOT / file)]


def sensed(flight: Path, file: str, label: str, wanted_s: float) -> dict:
    """All points of the lidar from take-off to landing, one scan and the depth picture of the same moment."""
    found = messages(flight, "/sim/truth_state", "/scan/scan", "/depth/image_raw")
    track = Track(found["/sim/truth_state"])
    scans = {time_s: lidar_points(track, time_s, scan) for time_s, scan in found["/scan/scan"] if track.position_m(time_s)[2] > 0.5}
    at_s = min(scans, key=lambda time_s: abs(time_s - wanted_s))
    _, image = min(found["/depth/image_raw"], key=lambda row: abs(row[0] - at_s))
    depths_m = numpy.frombuffer(bytes(image.data), "<f4").reshape(image.height, image.width)
    return {"shapes": shapes(file), "title": label, "at_s": at_s, "reach_m": REACH_M, "paths": [path(flight, "true path")],
            "sensor_m": track.position_m(at_s).tolist(), "scan_m": scans[at_s].round(3).tolist(),
            "scans_m": numpy.concatenate(list(scans.values())).round(2).tolist(),
            "depths_m": [[float(depth) if numpy.isfinite(depth) else None for depth in row] for row in depths_m.round(3)]}


def lidar_points(track: Track, time_s: float, scan) -> numpy.ndarray:
    """Where the beams ended that met something."""
    ranges_m = numpy.array(scan.ranges)
    angles = scan.angle_min + scan.angle_increment * numpy.arange(len(ranges_m))
    met = numpy.isfinite(ranges_m)
    beams_m = ranges_m[met, None] * numpy.stack([numpy.cos(angles), numpy.sin(angles), 0 * angles], axis=1)[met]
    return track.position_m(time_s) + beams_m @ track.rotation(time_s).T


def holoocean(scratch: Path) -> dict:
    """A flight shown by the stand-in engine: what its sensors gave, from its record."""
    land, record, scenario = scratch / "packages/2.3.0/worlds/Land", scratch / "record.jsonl", scratch / "scenario.json"
    land.mkdir(parents=True)
    (land / "config.json").write_text(json.dumps({"name": "Land", "path": "engine", "worlds": [{"name": "Meadow", "pre_start_steps": 1}]}))
    (land / "engine").write_text(f'#!/bin/sh\nexec "{sys.executable}" "{STANDIN}" --record "{record}" --measured -- "$@"\n')
    (land / "engine").chmod(0o755)
    scenario.write_text(json.dumps(SCENARIO))
    fly(scratch / "flight", "--viewer", "holoocean", "--viewer-offscreen", "--viewer-scenario", str(scenario),
        environment=os.environ | {"HOLODECKPATH": str(scratch / "packages")})
    return stand_in_facts([json.loads(line) for line in record.read_text().splitlines()]) | {
        "paths": [path(scratch / "flight", "true path of the flight")]}


def stand_in_facts(events: list[dict]) -> dict:
    first = next(event["tick"] for event in events if event["event"] == "state")
    measured: dict[str, dict[int, bytes]] = {}
    for event in events:
        if event["event"] == "measured" and event["tick"] >= first:
            measured.setdefault(event["sensor"], {})[event["tick"]] = bytes.fromhex(event["bytes"])
    light = {name: {tick: numpy.frombuffer(raw, "<f4").astype(float) for tick, raw in measured[name].items()}
             for name in ("location", "rotation", "below")}
    ground_m = [ground(light["location"][tick], light["rotation"][tick], distance_m)
                for tick, (distance_m,) in light["below"].items() if distance_m > 0]
    tick = max(measured["rgb"], key=lambda each: each & 255)  # the reddest
    size = SCENARIO["agents"][0]["sensors"][0]["configuration"]
    pixels = {name: numpy.frombuffer(measured[name][tick], numpy.uint8).reshape(size["CaptureHeight"], size["CaptureWidth"], 4).astype(int)
              for name in ("rgb", "depth")}
    codes = pixels["depth"] @ [65536, 256, 1, 0]  # blue has the high byte; all of it is 1000 m
    return {"tick": tick, "rgb": pixels["rgb"][:, :, [2, 1, 0]].tolist(), "depths_m": (codes / (2 ** 24 - 1) * 1000.0).round(2).tolist(),
            "places_m": [[-west, north, up] for north, west, up in light["location"].values()], "ground_m": ground_m}


def ground(place_m: numpy.ndarray, angles_deg: numpy.ndarray, distance_m: float) -> list[float]:
    """North and up of where a beam along the agent's z axis ends, downwards; roll, pitch and yaw of axes forward, left, up."""
    roll, pitch, yaw = numpy.radians(angles_deg)
    return [place_m[0] - distance_m * (numpy.cos(yaw) * numpy.sin(pitch) * numpy.cos(roll) + numpy.sin(yaw) * numpy.sin(roll)),
            place_m[2] - distance_m * numpy.cos(pitch) * numpy.cos(roll)]


def collect(scratch: Path) -> dict[str, dict]:
    fly(scratch / "plain")
    gazebo = ["--physics", "gazebo", "--world", FIELD]
    fly(scratch / "field", *gazebo, *SENSORS)
    fly(scratch / "crash", *gazebo, "--vehicle", "anaconda", "--mission", "circuit")
    fly(scratch / "wall", "--world", WALL, *SENSORS)
    return {
        "world_plain": {"title": "The plain field: level ground, without a world file, flown with our integrator", "shapes": [],
                        "paths": [path(scratch / "plain", "multirotor, mission default")]},
        "world_field": {"title": "field.sdf, flown with --physics gazebo", "shapes": shapes(FIELD), "paths": [
            path(scratch / "field", "multirotor, mission default"), path(scratch / "crash", "anaconda, mission circuit")]},
        "world_field_sensors": sensed(scratch / "field", FIELD, "field.sdf, measured by lidar and depth camera (--physics gazebo)", FIRST_WAYPOINT_S),
        "world_wall_sensors": sensed(scratch / "wall", WALL, "wall.sdf, measured by lidar and depth camera (our integrator)", ABOVE_THE_START_S),
        "world_holoocean": holoocean(scratch / "holoocean")}


def make():
    """Flies, writes the facts and draws them."""
    FACTS.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        for name, facts in collect(Path(scratch)).items():
            (FACTS / f"{name}.json").write_text(json.dumps(facts))
    draw([(FACTS / f"{name}.json", IMAGES / f"{name}.png") for name in PICTURES])


def draw(pairs: list[tuple[Path, Path]]):
    """By matplotlib, in an environment of its own."""
    bench_programs.environment(".venv-plot", "tools/requirements-plot.txt")
    python = project.ROOT / ".venv-plot/bin/python3"
    for facts, picture in pairs:
        subprocess.run([str(python), str(project.ROOT / "tools/worlds_drawing.py"), str(facts), str(picture)], check=True)


def main() -> int:
    bench_programs.prepare("gazebo")
    try:
        make()
    except (RuntimeError, log_table.Refused, world_shapes.Refused) as error:
        print(f"worlds_pictures: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
