# SPDX-License-Identifier: BSD-3-Clause
"""Compares flight logs by value: a change that shall not alter behaviour leaves every message the same to the bit.

Usage: compare_logs.py OLD NEW           two logs, or two folders with one log per flight
       compare_logs.py --fly PROGRAM DIR flies the flights of FLIGHTS with a built `rosflight` program into DIR

Every message of both logs is decoded; time, topic, field and value are compared bit by bit, in the order of the file.
Schema text, compression and chunks may differ. So may what TEXTS and RENAMED name: the wording of a text (its time,
its severity and the number of texts stay), and fields that have another name today.
Exit code 0 when equal, 1 when not, 2 when a log cannot be read.
"""

import re
import struct
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from mcap.exceptions import McapError
from mcap.records import Channel, Schema
from mcap.records import Message as Record
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory

# Fields that hold words for people: type -> fields whose wording may differ.
TEXTS = {
    "rcl_interfaces/msg/Log": {"msg"},
    "rosflight_msgs/msg/Error": {"error_message"},
    "rosflight_log_msgs/msg/CheckResult": {"name", "reason"},
    "std_msgs/msg/String": {"data"},
}
# Renamed fields: (type, name in the old log) -> name in the new log; dots separate the levels of nested fields.
RENAMED: dict[tuple[str, str], str] = {}

RAW_FRAME = "rosflight_log_msgs/msg/RawFrame"
STATUSTEXT, FIRMWARE_VERSION, CHECK_RESULT = 253, 192, 238  # MAVLink 1 ids of the messages that carry words
MAVLINK_1_START, MAVLINK_1_HEADER, MAVLINK_CHECKSUM = 0xFE, 6, 2

FLIGHTS = {
    "multirotor": [],
    "multirotor_truth": ["--state", "truth", "--seed", "2"],
    "multirotor_gusts": ["--seed", "3", "--wind", "6,270,4"],
    "multirotor_lean_link": ["--seed", "4", "--link-protocol", "lean", "--mission", "hop"],
    "multirotor_faults": ["--seed", "5", "--fault", "gnss@15:20", "--fault", "crash@40", "--fault", "baro_step=3@25"],
    "multirotor_link_cut": ["--seed", "6", "--fault", "link_cut@20:3", "--mission", "square"],
    "wing": ["--vehicle", "anaconda"],
    "wing_gusts": ["--vehicle", "anaconda", "--seed", "8", "--wind", "5,200,6", "--mission", "hourglass_dubins"],
    "wing_faults": ["--vehicle", "xflr5_anaconda", "--seed", "9", "--fault", "pitot_blocked@30:20", "--fault", "rc_silence@50:4"],
}


@dataclass(frozen=True)
class Message:
    topic: str
    type: str
    layout: str  # the schema without comments and constants
    log_time_ns: int
    publish_time_ns: int
    data: bytes
    schema: object

    @property
    def where(self) -> str:
        return f"{self.topic} at {self.log_time_ns} ns"


class LogReader:
    """Messages of one log in the order of the file, decoded on request."""

    def __init__(self, path: Path):
        self.path = path
        self._decoders = {}
        self._layouts = {}

    def __iter__(self):
        schemas, channels = {}, {}
        with self.path.open("rb") as file:
            for record in StreamReader(file).records:
                if isinstance(record, Schema):
                    schemas[record.id] = record
                    self._layouts[record.id] = layout_of(record.data.decode())
                elif isinstance(record, Channel):
                    channels[record.id] = record
                elif isinstance(record, Record):
                    channel = channels[record.channel_id]
                    schema = schemas[channel.schema_id]
                    yield Message(channel.topic, schema.name, self._layouts[schema.id], record.log_time, record.publish_time,
                                  record.data, schema)

    def fields(self, message: Message) -> dict[str, object]:
        """Every number and text of a message by its path, such as "header.stamp.sec" or "values[3]"."""
        if message.schema.id not in self._decoders:
            self._decoders[message.schema.id] = DecoderFactory().decoder_for("cdr", message.schema)
        return dict(flattened(self._decoders[message.schema.id](message.data)))


def layout_of(schema: str) -> str:
    """What of a schema decides how bytes are read: no comments, no constants, no blank space."""
    lines = (re.sub(r"#.*", "", line).split() for line in schema.splitlines())
    return "\n".join(" ".join(words) for words in lines if words and not any("=" in word for word in words[1:]))


def flattened(value, path: str = ""):
    if hasattr(value, "__slots__"):
        for name in value.__slots__:
            yield from flattened(getattr(value, name), f"{path}.{name}" if path else name)
    elif isinstance(value, (list, tuple)):
        yield f"{path}.size", len(value)
        for index, entry in enumerate(value):
            yield from flattened(entry, f"{path}[{index}]")
    else:
        yield path, value


def bits(value) -> object:
    """Equal only for equal bits: tells -0 from 0, and a NaN equals itself."""
    return struct.pack("<d", value) if isinstance(value, float) else (type(value), value)


def renamed(type_name: str, fields: dict[str, object]) -> dict[str, object]:
    def today(path: str) -> str:
        for (owner, before), name in RENAMED.items():
            if owner == type_name and re.match(re.escape(before) + r"(?![\w])", path):
                return name + path[len(before):]
        return path
    return {today(path): value for path, value in fields.items()}


def without_words(frame: bytes) -> bytes:
    """A MAVLink 1 frame with blanks for the words for people in it and for the checksum over them."""
    if len(frame) < MAVLINK_1_HEADER + MAVLINK_CHECKSUM or frame[0] != MAVLINK_1_START:
        return frame
    kept = {STATUSTEXT: 1, FIRMWARE_VERSION: 0, CHECK_RESULT: 3}.get(frame[5])  # bytes of the payload before the words
    if kept is None:
        return frame
    return frame[:MAVLINK_1_HEADER + kept] + b" " * (len(frame) - MAVLINK_1_HEADER - kept)


def difference(old: Message, new: Message, readers: tuple[LogReader, LogReader]) -> str | None:
    """The first thing two messages differ in, or None."""
    for name in ("topic", "type", "log_time_ns", "publish_time_ns"):
        if getattr(old, name) != getattr(new, name):
            return f"{old.where}: {name} was {getattr(old, name)}, is {getattr(new, name)} ({new.where})"
    if old.data == new.data and old.layout == new.layout:
        return None
    before, after = renamed(old.type, readers[0].fields(old)), readers[1].fields(new)
    if old.type == RAW_FRAME:
        before["data"], after["data"] = without_words(before["data"]), without_words(after["data"])
    if before.keys() != after.keys():
        odd = sorted(before.keys() ^ after.keys())[0]
        return f"{old.where}: field {odd} is in {'the old' if odd in before else 'the new'} log only"
    for path, value in before.items():
        if path not in TEXTS.get(old.type, ()) and bits(value) != bits(after[path]):
            return f"{old.where}: {path} was {value!r}, is {after[path]!r}"
    return None


def compare(old: Path, new: Path) -> tuple[int, str | None]:
    """Number of messages that were compared, and the first difference."""
    readers = LogReader(old), LogReader(new)
    count, ended = 0, object()
    first, second = iter(readers[0]), iter(readers[1])
    while True:
        one, other = next(first, ended), next(second, ended)
        if one is ended and other is ended:
            return count, None if count else "both logs are empty"
        if one is ended or other is ended:
            return count, f"one log ends after {count} messages, the other goes on"
        found = difference(one, other, readers)
        if found:
            return count, found
        count += 1


def logs_in(path: Path) -> dict[str, Path]:
    """The logs of a folder by the name of their flight; a file is one log without a name."""
    if path.is_file():
        return {"": path}
    found = {str(log.parent.relative_to(path)): log for log in sorted(path.glob("**/*.mcap"))}
    if not found:
        raise FileNotFoundError(f"{path}: found no log, allowed a .mcap file or a folder of flights")
    return found


def compare_all(old: Path, new: Path) -> bool:
    before, after = logs_in(old), logs_in(new)
    equal = True
    for name in sorted(before.keys() | after.keys()):
        if name in before and name in after:
            count, found = compare(before[name], after[name])
        else:
            count, found = 0, f"only in {old if name in before else new}"
        equal &= found is None
        print(f"{name or new}: {found or f'{count} messages equal'}", flush=True)
    return equal


def fly(program: Path, folder: Path):
    """Flies all flights with every step in the log. A mission that fails is a flight all the same."""
    full = ["--log", "full"] if "--log " in subprocess.run([program, "fly", "--help"], capture_output=True, text=True).stdout else []
    for name, options in FLIGHTS.items():
        done = subprocess.run([program, "fly", *options, *full, "--out", folder / name], capture_output=True, text=True)
        if done.returncode not in (0, 1):
            raise RuntimeError(f"{name}: {done.stderr.strip()}")
        print(f"{name}: {done.stdout.strip().splitlines()[0]}", flush=True)


def main(arguments: list[str]) -> int:
    try:
        if len(arguments) == 3 and arguments[0] == "--fly":
            fly(Path(arguments[1]).resolve(), Path(arguments[2]))
            return 0
        if len(arguments) == 2 and not arguments[0].startswith("-"):
            return 0 if compare_all(*map(Path, arguments)) else 1
    except (OSError, RuntimeError, McapError) as error:
        print(f"compare_logs: {error}", file=sys.stderr)
        return 2
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
