# SPDX-License-Identifier: BSD-3-Clause
"""compare_logs.py sees one bit, and passes over what may differ. The logs are written with mcap_ros2, not with our writer."""

import math
from types import SimpleNamespace

import compare_logs
import pytest
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer

IMU = "# of a gyro\nuint8 MODE=1\nfloat64 rate\nfloat32[2] field\nstring frame"
LOG = "uint8 level\nstring msg"
FRAME = "uint8 direction\nuint8[] data"
HEADER = "\n".join(("=" * 80, "MSG: std_msgs/Header", "builtin_interfaces/Time stamp", "=" * 80, "MSG: builtin_interfaces/Time",
                    "int32 sec", "uint32 nanosec"))
FRAMES = "std_msgs/Header header\nuint32[] delay_us\nuint8[] direction\nuint16[] length\nuint8[] data\n" + HEADER
PULSES = "uint16[2] values"
STATUSTEXT = bytes([0xFE, 51, 0, 1, 1, 253, 6]) + b"Armed".ljust(50, b"\0") + b"\x12\x34"


def write(path, messages, imu=IMU, **options):
    """Messages are (type, time in ns, fields)."""
    path.parent.mkdir(exist_ok=True)
    with path.open("wb") as file:
        writer = Writer(file, **options)
        schemas = {"imu": writer.register_msgdef("a/msg/Imu", imu), "log": writer.register_msgdef("rcl_interfaces/msg/Log", LOG),
                   "raw": writer.register_msgdef("rosflight_log_msgs/msg/RawFrame", FRAME),
                   "raws": writer.register_msgdef("rosflight_log_msgs/msg/RawFrames", FRAMES),
                   "pwm": writer.register_msgdef("rosflight_msgs/msg/PwmOutput", PULSES)}
        for kind, time_ns, fields in messages:
            writer.write_message(f"/{kind}", schemas[kind], fields, log_time=time_ns, publish_time=time_ns)
        writer.finish()
    return path


def imu(time_ns=5, **fields):
    return "imu", time_ns, {"rate": 1.5, "field": [0.0, math.nan], "frame": "body", **fields}


def text(words, level=20, time_ns=7):
    return "log", time_ns, {"level": level, "msg": words}


def raw(frame):
    return "raw", 8, {"direction": 0, "data": list(frame)}


def raws(*frames, time_ns=8):
    """Frames are (delay in us, bytes)."""
    return "raws", 99, {"header": {"stamp": {"sec": 0, "nanosec": time_ns}},
                        "delay_us": [delay for delay, _ in frames], "direction": [0] * len(frames),
                             "length": [len(data) for _, data in frames], "data": [byte for _, data in frames for byte in data]}


def pwm(*values):
    return "pwm", 9, SimpleNamespace(values=list(values))  # a dictionary has a method of this name


def compared(tmp_path, before, after, **options):
    return compare_logs.compare(write(tmp_path / "a.mcap", before), write(tmp_path / "b.mcap", after, **options))


@pytest.mark.parametrize("before, after", [
    ([imu()], [imu()]),
    ([text("armed")], [text("Armed.")]),
    ([raw(STATUSTEXT)], [raw(STATUSTEXT.replace(b"Armed", b"ARMED")[:-2] + b"\x56\x78")]),
    ([pwm(1560, 1561)], [pwm(1559, 1561)]),
])
def test_equal_logs_are_equal(tmp_path, before, after):
    assert compared(tmp_path, before, after) == (1, None)


def test_schema_text_compression_and_chunks_may_differ(tmp_path):
    other = "float64 rate  # rad/s\nfloat32[2] field\nuint8 MODE=1\nstring frame"
    assert compared(tmp_path, [imu(), imu(6)], [imu(), imu(6)], imu=other, compression=CompressionType.NONE, chunk_size=10) == (2, None)


@pytest.mark.parametrize("before, after, said", [
    (imu(), imu(rate=math.nextafter(1.5, 2.0)), "/imu at 5 ns: rate was 1.5, is 1.5000000000000002"),
    (imu(), imu(field=[-0.0, math.nan]), "field[0] was 0.0, is -0.0"),
    (imu(), imu(frame="Body"), "frame was 'body', is 'Body'"),
    (imu(), imu(6), "log_time_ns was 5, is 6"),
    (imu(), text("armed", time_ns=5), "topic was /imu, is /log"),
    (text("armed"), text("armed", level=30), "level was 20, is 30"),
    (pwm(1560, 1561), pwm(1561, 1561), "values[0] was 1560, is 1561"),
    (pwm(1560, 1561), pwm(1560, 1559), "values[1] was 1561, is 1559"),
    (raw(STATUSTEXT), raw(STATUSTEXT[:6] + b"\x04" + STATUSTEXT[7:]), "was (0, b'\\xfe3"),
    (raw(b"\xfe\x01\x00\x01\x01\x00\x07\x00\x00"), raw(b"\xfe\x01\x00\x01\x01\x00\x08\x00\x00"), "was (0, b'\\xfe\\x01"),
    (raw(b"ab"), raws((0, b"ac")), "was (0, b'ab'), is (0, b'ac')"),
    (raw(b"ab"), raws((1, b"ab")), "frame on the link at 8 ns"),
])
def test_a_difference_is_told_with_its_place(tmp_path, before, after, said):
    count, found = compared(tmp_path, [imu(1), before], [imu(1), after])
    assert count == 1 and said in found


def test_frames_of_one_message_each_equal_frames_in_one_message(tmp_path):
    before = [raw(b"ab"), imu(), ("raw", 5008, {"direction": 0, "data": list(b"c")})]
    assert compared(tmp_path, before, [imu(), raws((0, b"ab"), (5, b"c"))]) == (3, None)
    assert compared(tmp_path, before, [imu(), raws((0, b"ab"))]) == (2, "one log ends after 1 frames, the other goes on")


def test_a_log_that_ends_early_differs(tmp_path):
    assert compared(tmp_path, [imu(), imu(6)], [imu()]) == (1, "one log ends after 1 messages, the other goes on")


def test_a_renamed_field_is_the_same_field_only_when_listed(tmp_path, monkeypatch):
    renamed = IMU.replace("rate", "angular_rate")
    fields = imu()[2]
    after = ("imu", 5, {"angular_rate": fields["rate"], "field": fields["field"], "frame": "body"})
    assert "field angular_rate is in the new log only" in compared(tmp_path, [imu()], [after], imu=renamed)[1]
    monkeypatch.setattr(compare_logs, "RENAMED", {("a/msg/Imu", "rate"): "angular_rate"})
    assert compared(tmp_path, [imu()], [after], imu=renamed) == (1, None)


def test_of_topics_that_repeat_others_the_first_of_each_interval_counts(tmp_path, monkeypatch):
    monkeypatch.setattr(compare_logs, "REPEATS", {"/imu": 10_000_000})
    before = [imu(10_000_000), imu(12_500_000, rate=2.0), imu(20_000_000)]
    assert compared(tmp_path, before, [before[0], before[2]]) == (2, None)
    assert "log_time_ns was 10000000, is 12500000" in compared(tmp_path, before, before[1:])[1]


def test_a_field_of_one_time_is_left_out_only_when_listed(tmp_path, monkeypatch):
    after = ("imu", 5, {"rate": 1.5, "field": [0.0, math.nan]})
    shorter = IMU.replace("string frame", "")
    assert "field frame is in the old log only" in compared(tmp_path, [imu()], [after], imu=shorter)[1]
    monkeypatch.setattr(compare_logs, "ONE_SIDED", {("a/msg/Imu", "frame"): True})
    assert compared(tmp_path, [imu()], [after], imu=shorter) == (1, None)
    assert "rate was" in compared(tmp_path, [imu(rate=2.0)], [after], imu=shorter)[1]


@pytest.mark.parametrize("today, said", [
    ("/imu 0 .x 0x1.0p+0\n/imu 1 .x 0x1.0p+1\n", "2 fields equal"),
    ("/imu 0 .x 0x1.0p+0\n/imu 1 .x 0x1.8p+1\n", "line 2 was '/imu 1 .x 0x1.0p+1', is '/imu 1 .x 0x1.8p+1'"),
    ("/imu 0 .x 0x1.0p+0\n", "2 lines, now 1"),
])
def test_recordings_of_a_ros_node_are_compared_line_by_line(tmp_path, capsys, today, said):
    old, new = tmp_path / "old.txt", tmp_path / "new.txt"
    old.write_text("/imu 0 .x 0x1.0p+0\n/imu 1 .x 0x1.0p+1\n")
    new.write_text(today)
    assert compare_logs.main([str(old), str(new)]) == ("equal" not in said)
    assert said in capsys.readouterr().out


def test_frames_are_those_that_the_firmware_sent(tmp_path, capsys):
    back = ("raw", 9, {"direction": 1, "data": [1]})
    log = write(tmp_path / "a" / "flight.mcap", [raw(b"\xfe\x01"), back, raw(b"\xab")])
    assert compare_logs.main(["--frames", str(log)]) == 0
    assert capsys.readouterr().out.split() == ["fe01", "ab"]


def test_folders_are_compared_flight_by_flight(tmp_path, capsys):
    for folder, flights in (("old", "xy"), ("new", "xz")):
        (tmp_path / folder).mkdir()
        for flight in flights:
            write(tmp_path / folder / flight / "flight.mcap", [imu()])
    assert compare_logs.main([str(tmp_path / "old"), str(tmp_path / "new")]) == 1
    said = capsys.readouterr().out
    assert "x: 1 messages equal\n" in said and f"y: only in {tmp_path / 'old'}" in said and f"z: only in {tmp_path / 'new'}" in said


@pytest.mark.parametrize("words", [["only_one"], ["no_such_log", "no_such_log"], []])
def test_nonsense_ends_with_2(words, capsys):
    assert compare_logs.main(words) == 2
    assert capsys.readouterr().err


def test_what_is_no_log_ends_with_2(tmp_path, capsys):
    (tmp_path / "a.mcap").write_bytes(b"nonsense")
    assert compare_logs.main([str(tmp_path / "a.mcap")] * 2) == 2
    assert capsys.readouterr().err.startswith("compare_logs: ")


def test_new_topics_and_filled_frames_are_passed_over(tmp_path):
    def pose(path, frame, *topics):
        with path.open("wb") as file:
            writer = Writer(file)
            schema = writer.register_msgdef("a/msg/Pose", "std_msgs/Header header\n" + HEADER.replace(
                "builtin_interfaces/Time stamp", "builtin_interfaces/Time stamp\nstring frame_id"))
            for topic in topics:
                header = {"stamp": {"sec": 0, "nanosec": 1}, "frame_id": frame}
                writer.write_message(topic, schema, {"header": header}, log_time=1, publish_time=1)
            writer.finish()
        return path

    old = pose(tmp_path / "old.mcap", "", "/baro")
    assert compare_logs.compare(old, pose(tmp_path / "new.mcap", "body", "/baro", "/sim/pose", "/gnss/fix")) == (1, None)
    _, found = compare_logs.compare(old, pose(tmp_path / "other.mcap", "NED", "/baro"))
    assert "header.frame_id was '', is 'NED'" in found
