# SPDX-License-Identifier: BSD-3-Clause
"""pymavlink, which nobody here wrote, at the other end of the link.

It encodes random messages, our codec reads them and encodes them again, and pymavlink reads those.
"""

import importlib.util
import os
import random
import re
import struct
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("ROSFLIGHT_BUILD", ROOT / "build" / "release"))
FLOATS = {"float": ("<f", "<I"), "double": ("<d", "<Q")}
INTEGERS = {"int8_t": (-(2**7), 2**7), "uint8_t": (0, 2**8), "int16_t": (-(2**15), 2**15),
            "uint16_t": (0, 2**16), "int32_t": (-(2**31), 2**31), "uint32_t": (0, 2**32),
            "int64_t": (-(2**63), 2**63), "uint64_t": (0, 2**64)}
# What our structs do not carry, and what the codec therefore always sends.
CONSTANT = {"HEARTBEAT": {"autopilot": 0, "base_mode": 0, "custom_mode": 0, "system_status": 0,
                          "mavlink_version": 2},
            "PARAM_REQUEST_READ": {"target_component": 0},
            "PARAM_REQUEST_LIST": {"target_component": 0},
            "PARAM_SET": {"target_component": 0}}
OURS = {228, 229, 236, 237, 238, 239}
BOOLEAN = {("ROSFLIGHT_CMD_ACK", "success"), ("ROSFLIGHT_STATUS", "armed"),
           ("ROSFLIGHT_STATUS", "failsafe"), ("ROSFLIGHT_STATUS", "offboard")}


@pytest.fixture(scope="module")
def dialect():
    path = BUILD / "link" / "mavlink" / "mavlink_python" / "rosflight.py"
    spec = importlib.util.spec_from_file_location("rosflight_dialect", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def random_value(rng, message, field, kind, length):
    if (message, field) in BOOLEAN:
        return rng.randrange(2)
    if kind == "char":
        size = rng.randrange(0, 17 if length == 16 else length)
        return bytes(rng.randrange(33, 127) for _ in range(size))
    if kind in FLOATS:
        draw = lambda: struct.unpack("<f", struct.pack("<f", rng.gauss(0.0, 1e3)))[0]
    else:
        draw = lambda: rng.randrange(*INTEGERS[kind])
    return [draw() for _ in range(length)] if length else draw()


def as_text(kind, value):
    """The value as link/test/fields.hpp writes it."""
    if kind == "char":
        return value.hex()
    if isinstance(value, list):
        return ",".join(as_text(kind, one) for one in value)
    if kind in FLOATS:
        form, bits = FLOATS[kind]
        return str(struct.unpack(bits, struct.pack(form, value))[0])
    return str(value)


def field_types(kind):
    """Name to (type, array length); pymavlink lists types as declared, lengths in wire order."""
    types = dict(zip(kind.fieldnames, kind.fieldtypes))
    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths))
    return {name: (types[name], lengths[name]) for name in kind.fieldnames}


def random_messages(dialect, rounds):
    rng = random.Random(1)
    for _ in range(rounds):
        for kind in dialect.mavlink_map.values():
            fields = {}
            types = field_types(kind)
            for name in kind.fieldnames:
                constant = CONSTANT.get(kind.msgname, {}).get(name)
                fields[name] = constant if constant is not None else random_value(
                    rng, kind.msgname, name, *types[name])
            yield kind, types, fields


@pytest.fixture(scope="module")
def exchange(dialect):
    sender = dialect.MAVLink(None, srcSystem=1, srcComponent=50)
    sent = []
    for kind, types, fields in random_messages(dialect, 20):
        frame = kind(**fields).pack(sender, force_mavlink1=True)
        sender.seq = (sender.seq + 1) % 256
        sent.append((kind, types, fields, bytes(frame)))
    program = BUILD / "link" / "test" / "link_codec_peer"
    result = subprocess.run([program, "mavlink"], input="\n".join(f.hex() for *_, f in sent) + "\n", text=True,
                            capture_output=True, check=True, timeout=60)
    answers = [line.split(" | ") for line in result.stdout.splitlines()]
    assert len(answers) == len(sent)
    return list(zip(sent, answers))


def test_the_dialect_has_25_messages_of_rosflight_and_six_of_ours(dialect):
    assert len(dialect.mavlink_map) == 25 + 6
    assert [dialect.mavlink_map[number].msgname for number in sorted(OURS)] == [
        "RECORD_REQUEST", "RECORD_PART", "MOTOR_TEST", "REPORT_REQUEST", "CHECK_RESULT", "COUNTERS"]
    public = importlib.import_module("pymavlink.dialects.v20.all").mavlink_map
    assert not OURS & public.keys()  # no public dialect means something else by them


def test_we_read_what_pymavlink_wrote(exchange):
    for (kind, types, fields, _), (ours, _) in exchange:
        carried = [n for n in kind.fieldnames if n not in CONSTANT.get(kind.msgname, {})]
        expected = [f"{name}={as_text(types[name][0], fields[name])}" for name in carried]
        assert ours.split()[1:] == expected, kind.msgname


def test_pymavlink_reads_what_we_wrote(exchange, dialect):
    parser = dialect.MAVLink(None)
    for (kind, types, fields, frame), (_, ours) in exchange:
        again = bytes.fromhex(ours)
        message = parser.parse_buffer(again)[0]
        assert message.get_type() == kind.msgname
        assert message.get_srcComponent() == (0 if kind.msgname == "PARAM_VALUE" else 250)
        for name in kind.fieldnames:
            expected = fields[name]
            got = getattr(message, name)
            if types[name][0] == "char":
                got = got.encode("ascii")
            assert got == expected, f"{kind.msgname}.{name}"
        assert again[6:-2] == frame[6:-2], kind.msgname


@pytest.fixture(scope="module")
def dialect_of_release_2(tmp_path_factory):
    """What a ground tool of ROSflight 2.x has: the dialect without our messages."""
    folder = tmp_path_factory.mktemp("dialect")
    text = (ROOT / "link" / "mavlink" / "rosflight.xml").read_text()
    for number in OURS:
        text, count = re.subn(rf'    <message id="{number}".*?</message>\n', "", text, flags=re.S)
        assert count == 1
    (folder / "release_2.xml").write_text(text)
    subprocess.run([sys.executable, ROOT / "link" / "mavlink" / "generate.py", "Python3",
                    folder / "release_2.xml", folder / "release_2.py"], check=True, timeout=60)
    spec = importlib.util.spec_from_file_location("release_2", folder / "release_2.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    assert len(module.mavlink_map) == 25
    return module


def test_a_tool_without_our_messages_ignores_them_and_loses_nothing_else(dialect, dialect_of_release_2):
    sender = dialect.MAVLink(None, srcSystem=1, srcComponent=250)
    stream, others = b"", []
    for kind, _, fields in random_messages(dialect, 20):
        stream += bytes(kind(**fields).pack(sender, force_mavlink1=True))
        sender.seq = (sender.seq + 1) % 256
        if kind.id not in OURS:
            others.append(kind.msgname)
    parser = dialect_of_release_2.MAVLink(None)
    parser.robust_parsing = True
    got = [message.get_type() for message in parser.parse_buffer(stream)]
    assert [name for name in got if name in others] == others
    assert all(name in others or name == "BAD_DATA" or name.startswith("UNKNOWN") for name in got)
