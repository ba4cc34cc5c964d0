# SPDX-License-Identifier: BSD-3-Clause
"""./rosflight log: the list of topics and the table of one. The logs are written with mcap_ros2, not with our writer."""

import csv
import math
import subprocess
import sys
from pathlib import Path

import log_table
import pytest
from mcap_ros2.writer import Writer

TOOL = Path(log_table.__file__)
POSE = "a/Point at\nfloat32[2] field\nfloat64[] more\nbool armed\nstring name\nuint8[] bytes\na/Point[] path\n" + \
    "=" * 80 + "\nMSG: a/Point\nfloat64 x\nfloat64 y"


def message(x, more, armed, name, path=()):
    return {"at": {"x": x, "y": -x}, "field": [0.5, 0.25], "more": more, "armed": armed, "name": name, "bytes": [7],
            "path": [{"x": p, "y": 0.0} for p in path]}


@pytest.fixture
def flight(tmp_path):
    folder = tmp_path / "flight"
    folder.mkdir()
    with (folder / "flight.mcap").open("wb") as file:
        writer = Writer(file)
        writer._writer.add_attachment(0, 10_000_000_000, "vehicle.yaml", "text/plain", b"a: 1")
        schema = writer.register_msgdef("a/msg/Pose", POSE)
        for k, one in enumerate([message(0.1, [1.0], True, 'say "a", b'), message(1e-300, [], False, "ä", [3.0]),
                                 message(math.nan, [1.0, 2.0, *range(9)], True, "")]):
            writer.write_message("/sim/pose", schema, one, log_time=11_000_000_000 + k * 500_000_000, publish_time=0)
        writer.write_message("/baro", schema, message(1.0, [], True, "b"), log_time=12_000_000_000, publish_time=0)
        writer.finish()
    return folder


def run(*arguments, code=0):
    done = subprocess.run([sys.executable, TOOL, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    assert (done.stderr.count("\n"), done.stdout == "") == ((1, True) if code else (0, done.stdout == ""))
    return done.stderr if code else done.stdout


def test_without_an_option_it_lists_the_topics(flight):
    lines = run(flight).splitlines()
    assert lines[0].split() == ["topic", "type", "messages", "rate", "[Hz]"]
    assert [line.split() for line in lines[1:3]] == [["/baro", "a/msg/Pose", "1", "-"], ["/sim/pose", "a/msg/Pose", "3", "3.0"]]
    assert lines[3] == "4 messages, 1.00 s"
    assert run(flight / "flight.mcap") == run(flight)


def test_a_topic_becomes_a_table(flight):
    rows = list(csv.reader(run(flight, "--csv", "/sim/pose").splitlines()))
    more = [f"more[{k}]" for k in range(11)]
    assert rows[0] == ["time_s", "at.x", "at.y", "field[0]", "field[1]", *more, "armed", "name", "bytes[0]", "path[0].x", "path[0].y"]
    assert rows[1] == ["1.0", "0.1", "-0.1", "0.5", "0.25", "1.0", *[""] * 10, "1", 'say "a", b', "7", "", ""]
    assert rows[2] == ["1.5", "1e-300", "-1e-300", "0.5", "0.25", *[""] * 11, "0", "ä", "7", "3.0", "0.0"]
    assert rows[3][:3] == ["2.0", "nan", "nan"] and rows[3][5:16] == ["1.0", "2.0", *(f"{k}.0" for k in range(9))]


def test_a_file_appears_complete_and_replaces_none(flight, tmp_path):
    out = tmp_path / "pose.csv"
    assert run(flight, "--csv", "/sim/pose", "--out", out) == ""
    assert out.read_text() == run(flight, "--csv=/sim/pose")
    assert run(flight, "--csv", "/baro", f"--out={out}", code=2) == f"rosflight: {out}: exists; use --force to replace it\n"
    run(flight, "--csv", "/baro", "--out", out, "--force")
    assert out.read_text() == run(flight, "--csv", "/baro")
    assert "cannot write" in run(flight, "--csv", "/baro", "--out", tmp_path / "no" / "a.csv", code=2)
    assert not list(tmp_path.glob("**/*.part"))


def test_an_unknown_topic_names_those_near_it(flight):
    said = run(flight, "--csv", "/sim/poses", code=2)
    assert said == f"rosflight: {flight}/flight.mcap: found no topic '/sim/poses', near it: /sim/pose\n"
    assert run(flight, "--csv", "xyz", code=2).endswith("near it: /baro, /sim/pose\n")


@pytest.mark.parametrize("arguments, words", [
    ([], "found 0 flights, allowed one"), (["a", "b"], "found 2 flights"), (["a", "--csv"], "--csv needs a topic"),
    (["a", "--out", "b"], "--out needs --csv"), (["a", "--cvs", "/b"], "unknown option '--cvs'; allowed: --csv TOPIC"),
    (["/nowhere"], "/nowhere: found no log, allowed a flight folder or an MCAP file")])
def test_what_makes_no_sense_is_one_line(arguments, words):
    assert words in run(*arguments, code=2)


@pytest.mark.parametrize("keep", [0, 5, 100, 0.5, 0.9])
def test_a_damaged_log_is_one_line(flight, keep):
    file = flight / "flight.mcap"
    data = file.read_bytes()
    file.write_bytes(data[:keep if isinstance(keep, int) else int(keep * len(data))])
    for arguments in ([], ["--csv", "/sim/pose"]):
        assert str(file) in run(flight, *arguments, code=2)


def test_bytes_that_changed_are_found(flight):
    file = flight / "flight.mcap"
    data = bytearray(file.read_bytes())
    at = data.index(b"\x28\xb5\x2f\xfd") + 40  # inside the first frame of zstd
    data[at:at + 20] = bytes(20)
    file.write_bytes(data)
    assert "cannot read the log" in run(flight, "--csv", "/sim/pose", code=2)


def test_a_reader_that_ends_early_is_no_error(flight):
    done = subprocess.run(f"{sys.executable} {TOOL} {flight} --csv /sim/pose | head -1", shell=True, capture_output=True, text=True)
    assert done.stdout.startswith("time_s,") and done.stderr == ""
