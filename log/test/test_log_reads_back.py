# SPDX-License-Identifier: BSD-3-Clause
"""Reads a log of log_sample with the mcap and mcap-ros2-support packages (Foxglove's own readers) and compares
every field of every channel with the literals of expected_log.py.

ROSFLIGHT_BUILD names the build directory (default: build/release).
"""

import math
import os
import pathlib
import subprocess
import sys

import pytest
from mcap.reader import NonSeekingReader, make_reader
from mcap_ros2._dynamic import serialize_dynamic
from mcap_ros2.decoder import DecoderFactory

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from expected_log import EPOCH_S, EXPECTED  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / os.environ.get("ROSFLIGHT_BUILD", "build/release")
SAMPLE = BUILD / "log" / "log_sample"


def plain(message):
    """A decoded message as dictionaries and lists."""
    if hasattr(message, "__slots__"):
        return {name: plain(getattr(message, name)) for name in message.__slots__}
    if isinstance(message, (list, tuple)):
        return [plain(item) for item in message]
    return message


def same(found, expected):
    if isinstance(expected, dict):
        return found.keys() == expected.keys() and all(same(found[k], expected[k]) for k in expected)
    if isinstance(expected, list):
        return len(found) == len(expected) and all(map(same, found, expected))
    if isinstance(expected, float) and not math.isnan(expected):
        # Sums such as specific force + gravity may differ from ours in the last bits.
        return math.isclose(found, expected, rel_tol=1e-15, abs_tol=1e-15)
    return found == expected or (found != found and expected != expected)


def write(path, *arguments):
    return subprocess.run([SAMPLE, path, *arguments], check=True, capture_output=True, text=True).stdout.split()


def identity(path):
    done = subprocess.run([sys.executable, ROOT / "tools" / "log_identity.py", path], check=True, capture_output=True,
                          text=True)
    return done.stdout.split()[0]


@pytest.fixture(scope="module")
def sample(tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "sample.mcap"
    printed = write(path)
    return path, printed


READERS = [make_reader, NonSeekingReader]


@pytest.mark.parametrize("reader", READERS)
def test_every_field_of_every_channel(sample, reader):
    found = {}
    with open(sample[0], "rb") as stream:
        messages = reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, message, decoded in messages.iter_decoded_messages():
            assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
            assert message.publish_time == message.log_time
            of_topic = found.setdefault(channel.topic, (schema.name, []))
            assert message.sequence == len(of_topic[1])
            of_topic[1].append((message.log_time, plain(decoded)))
    assert found.keys() == EXPECTED.keys()
    for topic, (schema_name, expected) in EXPECTED.items():
        assert found[topic][0] == schema_name
        assert len(found[topic][1]) == len(expected), topic
        for (log_time, message), (seconds, wanted) in zip(found[topic][1], expected):
            assert log_time == EPOCH_S * 10**9 + round(seconds * 1000) * 10**6, topic
            assert same(message, wanted), f"{topic}:\n{message}\n{wanted}"


def test_every_message_has_exactly_the_bytes_of_its_schema(sample):
    """Decoders do not mind bytes left over; writing the decoded message again does."""
    with open(sample[0], "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            encode = serialize_dynamic(schema.name, schema.data.decode())[schema.name]
            assert encode(decoded) == message.data, channel.topic


def test_attachment_metadata_and_statistics(sample):
    path, printed = sample
    with open(path, "rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        attachments = list(reader.iter_attachments())
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        summary = reader.get_summary()
    assert [(a.name, a.media_type, a.data) for a in attachments] == [
        ("vehicle.yaml", "application/yaml", "mass_kg: 3.5  # ä\n".encode())]
    assert metadata == {
        "flight": {"vehicle": "quadrotor", "seed": "42"},
        "parameters": {"BATT_VOLT_MAX": "23.5", "RC_ATT_OVRD_CHN": "5"},
    }
    statistics = summary.statistics
    count = sum(len(messages) for _, messages in EXPECTED.values())
    assert statistics.message_count == count
    assert statistics.channel_count == len(EXPECTED)
    assert statistics.schema_count == len({name for name, _ in EXPECTED.values()})
    assert (statistics.attachment_count, statistics.metadata_count) == (1, 2)
    assert statistics.message_start_time == (EPOCH_S + 1) * 10**9
    assert statistics.message_end_time == EPOCH_S * 10**9 + 3_004_000_000
    by_topic = {channel.topic: statistics.channel_message_counts[id] for id, channel in summary.channels.items()}
    assert by_topic == {topic: len(messages) for topic, (_, messages) in EXPECTED.items()}
    assert printed == [str(path), identity(path), str(count), str(path.stat().st_size)]


@pytest.mark.parametrize("compression", ["none", "zstd"])
def test_many_chunks_can_be_searched_by_time_and_topic(tmp_path, compression):
    path = tmp_path / "long.mcap"
    steps = 8000  # 20 s at 400 Hz, some 7 MB.
    write(path, compression, str(steps))
    with open(path, "rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        assert len(summary.chunk_indexes) > 3
        assert summary.statistics.chunk_count == len(summary.chunk_indexes)
        start = (EPOCH_S + 10) * 10**9
        window = [
            message.log_time
            for _, channel, message in reader.iter_messages(
                topics=["/sim/truth_vehicle"], start_time=start, end_time=start + 10**9)
        ]
    assert window == [start + 2_500_000 * k for k in range(400)]


def test_the_same_flight_gives_the_same_bytes(tmp_path):
    first = write(tmp_path / "a.mcap", "none", "500")
    second = write(tmp_path / "b.mcap", "none", "500")
    assert first[1:] == second[1:]
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


def test_the_identity_does_not_depend_on_the_compression(tmp_path):
    plain = write(tmp_path / "a.mcap", "none", "8000")
    packed = write(tmp_path / "b.mcap", "zstd", "8000")
    assert plain[1] == packed[1] == identity(tmp_path / "a.mcap") == identity(tmp_path / "b.mcap")
    assert int(packed[3]) < int(plain[3]) / 3


def test_a_place_that_cannot_be_written_is_one_line(tmp_path):
    path = tmp_path / "missing" / "x.mcap"
    done = subprocess.run([SAMPLE, path], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == f"{path}.part: cannot create: No such file or directory\n"
