# SPDX-License-Identifier: BSD-3-Clause
"""A logged flight goes through the firmware again: the same firmware does the same to the bit, and one changed bit shows."""

import os
import subprocess
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = ROOT / os.environ.get("ROSFLIGHT_BUILD", "build/release") / "apps" / "rosflight"


def fly(folder, *arguments):
    run = subprocess.run([PROGRAM, "fly", "--out", folder, *arguments], capture_output=True, text=True, timeout=300)
    assert run.returncode in (0, 1), run.stderr
    return folder


def replay(*arguments):
    return subprocess.run([PROGRAM, "replay", *arguments], capture_output=True, text=True, timeout=300)


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    return fly(tmp_path_factory.mktemp("fly") / "flight", "--log", "full")


def copied(flight, to, change):
    """The log with other messages: change(topic, data, number of the message in its topic)."""
    with (flight / "flight.mcap").open("rb") as file, to.open("wb") as out:
        reader, writer = make_reader(file), Writer(out)
        writer.start()
        for attachment in reader.iter_attachments():
            writer.add_attachment(attachment.create_time, attachment.log_time, attachment.name, attachment.media_type, attachment.data)
        for metadata in reader.iter_metadata():
            writer.add_metadata(metadata.name, metadata.metadata)
        schemas, channels, counts = {}, {}, {}
        for schema, channel, message in reader.iter_messages(topics=["/board/inputs", "/link/raw", "/sim/truth_vehicle"]):
            if channel.id not in channels:
                schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, "cdr", schemas[schema.id])
            number = counts[channel.topic] = counts.get(channel.topic, -1) + 1
            writer.add_message(channels[channel.id], message.log_time, change(channel.topic, message.data, number), message.publish_time)
        writer.finish()
    return to


def with_bit(data, at):
    return data[:at] + bytes([data[at] ^ 1]) + data[at + 1:]


def test_the_default_flight_repeats_to_the_bit(flight):
    run = replay(flight)
    lines = run.stdout.splitlines()
    assert (run.returncode, run.stderr, lines[2]) == (0, "", "same")
    assert lines[0].startswith("frames sent: ") and int(lines[0].split()[2]) > 50_000
    assert lines[1].startswith("outputs: ") and int(lines[1].split()[1]) > 15_000
    assert replay(flight / "flight.mcap").stdout == run.stdout


@pytest.mark.parametrize("arguments", [
    ["--vehicle", "anaconda", "--seed", "7", "--wind", "4,200,5", "--mission", "racetrack"],
    ["--mission", "hop", "--link-protocol", "lean", "--fault", "imu_nan@12:0.5", "--fault", "rc_silence@14:1"],
    ["--mission", "hop", "--fault", "link_cut@12:1", "--fault", "mag@10"]], ids=["fixed_wing", "lean_faults", "link_cut"])
def test_other_flights_repeat_as_well(tmp_path, arguments):
    run = replay(fly(tmp_path / "f", "--log", "full", *arguments))
    assert (run.returncode, run.stdout.splitlines()[-1]) == (0, "same"), run.stdout


def test_a_copy_without_change_is_the_same(flight, tmp_path):
    assert replay(copied(flight, tmp_path / "same.mcap", lambda topic, data, number: data)).returncode == 0


@pytest.mark.parametrize("topic, at, words", [
    ("/board/inputs", -40, "frames sent: "), ("/link/raw", -40, "the first difference is frame"),
    ("/sim/truth_vehicle", 4 + 8 + 4 + 8, "outputs: ")])
def test_one_bit_shows(flight, tmp_path, topic, at, words):
    def change(name, data, number):
        return with_bit(data, at % len(data)) if name == topic and number == 60 else data

    run = replay(copied(flight, tmp_path / "other.mcap", change))
    assert (run.returncode, run.stdout.splitlines()[-1]) == (1, "DIFFERENT")
    assert words in run.stdout and "first difference" in run.stdout


@pytest.mark.parametrize("arguments, words", [
    (["--mission", "hop"], "found no samples of the sensors (/board/inputs); fly with --log full, firmware in process"),
    (["--mission", "hop", "--log", "full", "--fault", "crash@12"], "found the fault crash, which restarts the firmware")])
def test_what_a_log_lacks_is_one_line(tmp_path, arguments, words):
    run = replay(fly(tmp_path / "f", *arguments))
    assert (run.returncode, run.stdout, run.stderr.count("\n")) == (2, "", 1) and words in run.stderr


def test_bad_input_is_one_line(flight, tmp_path):
    data = (flight / "flight.mcap").read_bytes()
    short, spoilt, foreign = tmp_path / "short.mcap", tmp_path / "spoilt.mcap", tmp_path / "foreign.mcap"
    short.write_bytes(data[:len(data) // 2])
    spoilt.write_bytes(data[:len(data) // 2] + bytes(64) + data[len(data) // 2 + 64:])
    foreign.write_text("time_us\n1\n")
    for arguments, words in (([short], "damaged or not complete"), ([spoilt], "damaged or not complete"),
                             ([foreign], "not an MCAP file"), ([tmp_path], "cannot read"),
                             ([flight, "--compare"], "is a flight, found an option; allowed with a CSV file only")):
        run = replay(*arguments)
        assert (run.returncode, run.stdout, run.stderr.count("\n")) == (2, "", 1), run.stderr
        assert words in run.stderr
