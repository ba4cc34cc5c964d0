# SPDX-License-Identifier: BSD-3-Clause
"""Compares flight logs by value: a change that shall not alter behaviour leaves every message the same to the bit.

Usage: compare_logs.py OLD NEW           two logs, two recordings of tools/record_ros.py (.txt), or two folders of them
       compare_logs.py --fly PROGRAM DIR flies the flights of FLIGHTS with a built `rosflight` program into DIR
       compare_logs.py --frames LOG      prints the frames that the firmware sent, in hexadecimal digits

Every message of both logs is decoded; time, topic, field and value are compared bit by bit, in the order of the
file; then the frames on the link.
Schema text, compression and chunks may differ. So may what TEXTS, RENAMED and CORRECTED name: the wording of a text (its
time, its severity and the number of texts stay), fields that have another name today, numbers that were put right.
Exit code 0 when equal, 1 when not, 2 when a log cannot be read.
"""

import re
import struct
import subprocess
import sys
from collections.abc import Iterator
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

# Numbers that were put right: (type, field) -> whether a value of the old log may be this value of the new one.
CORRECTED = {
    # Pulses are rounded down to whole microseconds, as in ROSflight 2.x and our ROS nodes; the old log rounded to the nearest.
    ("rosflight_msgs/msg/PwmOutput", "values"): lambda before, after: after in (before, before - 1),
    # Who says a text.
    ("rcl_interfaces/msg/Log", "name"): lambda before, after: before == after or (before, after) == ("director", "mission"),
}
# Fields of all types, in the same form. Every header names a frame since November 2026.
CORRECTED_EVERYWHERE = {"header.frame_id": lambda before, after: (before, after) == ("", "body")}

# Topics that repeat what others hold, and the interval of which all logs since November 2026 have the first message.
REPEATS = {"/attitude/euler": 50_000_000, "/sim/truth_wind": 50_000_000, "/sim/pwm_output": 50_000_000,
           "/imu/temperature": 50_000_000, "/external_attitude": 50_000_000}  # ns
# Fields that only logs before (True) or since November 2026 have: what they held stands elsewhere in both.
ONE_SIDED = {("rosflight_log_msgs/msg/TruthVehicle", "specific_force"): True,  # /sim/truth_state, without gravity
             ("rosflight_log_msgs/msg/TruthVehicle", "wind"): False}  # /sim/truth_wind

# Topics that only logs since November 2026 have.
NEW_TOPICS = {"/parameters", "/tf", "/tf_static", "/sim/pose", "/sim/odometry", "/autonomy/odometry", "/autonomy/path", "/gnss/fix",
              "/robot_description", "/board/inputs", "/settings"}

# Frames of the link: one message each in logs until November 2026, those of 50 ms in one message since.
RAW_FRAME, RAW_FRAMES = "rosflight_log_msgs/msg/RawFrame", "rosflight_log_msgs/msg/RawFrames"
STATUSTEXT, FIRMWARE_VERSION, CHECK_RESULT = 253, 192, 238  # MAVLink 1 ids of the messages that carry words
MAVLINK_1_START, MAVLINK_1_HEADER, MAVLINK_CHECKSUM = 0xFE, 6, 2

FLIGHTS = {
    "multirotor": [],
    "multirotor_truth": ["--state", "truth", "--seed", "2"],
    "multirotor_gusts": ["--seed", "3", "--wind", "6,270,4"],
    "multirotor_lean_link": ["--seed", "4", "--link-protocol", "lean", "--mission", "hop"],
    "multirotor_faults": ["--seed", "5", "--fault", "gnss@15:20", "--fault", "crash@40", "--fault", "baro_step=3@25"],
    "multirotor_link_cut": ["--seed", "6", "--fault", "link_cut@20:3", "--mission", "square"],
    "fixedwing": ["--vehicle", "anaconda"],
    "fixedwing_gusts": ["--vehicle", "anaconda", "--seed", "8", "--wind", "5,200,6", "--mission", "hourglass_dubins"],
    "fixedwing_faults": ["--vehicle", "xflr5_anaconda", "--seed", "9", "--fault", "pitot_blocked@30:20", "--fault", "rc_silence@50:4"],
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
        return dict(flattened(self.decoded(message)))

    def decoded(self, message: Message):
        if message.schema.id not in self._decoders:
            self._decoders[message.schema.id] = DecoderFactory().decoder_for("cdr", message.schema)
        return self._decoders[message.schema.id](message.data)


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
    """Equal only for equal bits: -0 differs from 0, and a NaN equals itself."""
    return struct.pack("<d", value) if isinstance(value, float) else (type(value), value)


def renamed(type_name: str, fields: dict[str, object]) -> dict[str, object]:
    def today(path: str) -> str:
        for (owner, before), name in RENAMED.items():
            if owner == type_name and re.match(re.escape(before) + r"(?![\w])", path):
                return name + path[len(before):]
        return path
    return {today(path): value for path, value in fields.items()}


def common(type_name: str, fields: dict[str, object], old: bool) -> dict[str, object]:
    """Without the fields that logs of the other time do not have."""
    return {path: value for path, value in fields.items() if ONE_SIDED.get((type_name, path.split(".")[0])) is not old}


def first_of_repeats(messages: Iterator[Message]) -> Iterator[Message]:
    """From topics that repeat others, the first message of every interval; no frames of the link."""
    due_ns = dict.fromkeys(REPEATS, 0)
    for message in messages:
        if message.type in (RAW_FRAME, RAW_FRAMES) or message.topic in NEW_TOPICS:
            continue
        if message.topic in REPEATS:
            if message.log_time_ns < due_ns[message.topic]:
                continue
            due_ns[message.topic] = (message.log_time_ns // REPEATS[message.topic] + 1) * REPEATS[message.topic]
        yield message


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
    if old.layout != new.layout:
        before, after = common(old.type, before, old=True), common(new.type, after, old=False)
    if before.keys() != after.keys():
        odd = sorted(before.keys() ^ after.keys())[0]
        return f"{old.where}: field {odd} is in {'the old' if odd in before else 'the new'} log only"
    for path, value in before.items():
        corrected = CORRECTED.get((old.type, path.split("[")[0])) or CORRECTED_EVERYWHERE.get(path)
        if corrected and corrected(value, after[path]):
            continue
        if path not in TEXTS.get(old.type, ()) and bits(value) != bits(after[path]):
            return f"{old.where}: {path} was {value!r}, is {after[path]!r}"
    return None


def compare_recordings(old: Path, new: Path) -> tuple[int, str | None]:
    """The same for what a ROS node published: a line for each field."""
    before, after = old.read_text().splitlines(), new.read_text().splitlines()
    for number, (one, other) in enumerate(zip(before, after)):
        if one != other:
            return number, f"line {number + 1} was {one!r}, is {other!r}"
    if len(before) != len(after):
        return min(len(before), len(after)), f"{len(before)} lines, now {len(after)}"
    return len(before), None if before else "both recordings are empty"


def frames_of(reader: LogReader) -> Iterator[tuple[int, int, bytes]]:
    """Time in ns, direction and bytes of each frame on the link."""
    for message in reader:
        if message.type == RAW_FRAME:
            one = reader.decoded(message)
            yield message.log_time_ns, one.direction, bytes(one.data)
        elif message.type == RAW_FRAMES:
            many, start = reader.decoded(message), 0
            start_ns = many.header.stamp.sec * 1_000_000_000 + many.header.stamp.nanosec
            for delay_us, direction, length in zip(many.delay_us, many.direction, many.length, strict=True):
                yield start_ns + 1000 * delay_us, direction, bytes(many.data[start:start + length])
                start += length


def differing_frames(old: tuple[int, int, bytes], new: tuple[int, int, bytes]) -> str | None:
    if old[:2] != new[:2] or without_words(old[2]) != without_words(new[2]):
        return f"frame on the link at {old[0]} ns: was {old[1:]}, is {new[1:]} at {new[0]} ns"
    return None


def compare_streams(first: Iterator, second: Iterator, differs, what: str) -> tuple[int, str | None]:
    count, ended = 0, object()
    while True:
        one, other = next(first, ended), next(second, ended)
        if one is ended and other is ended:
            return count, None
        if one is ended or other is ended:
            return count, f"one log ends after {count} {what}, the other goes on"
        if found := differs(one, other):
            return count, found
        count += 1


def compare(old: Path, new: Path) -> tuple[int, str | None]:
    """Number of messages and frames that were compared, and the first difference."""
    if old.suffix == ".txt":
        return compare_recordings(old, new)
    readers = LogReader(old), LogReader(new)
    count, found = compare_streams(*map(first_of_repeats, readers), lambda one, other: difference(one, other, readers), "messages")
    if found:
        return count, found
    frames, found = compare_streams(*map(frames_of, readers), differing_frames, "frames")
    return count + frames, found or (None if count + frames else "both logs are empty")


def logs_in(path: Path) -> dict[str, Path]:
    """The logs of a folder by the name of their flight, ROS recordings by theirs; a file is one log without a name."""
    if path.is_file():
        return {"": path}
    found = {str(log.parent.relative_to(path)): log for log in sorted(path.glob("**/*.mcap"))}
    found |= {log.name: log for log in sorted(path.glob("*.txt"))}
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
        what = "fields" if before.get(name, new).suffix == ".txt" else "messages"
        print(f"{name or new}: {found or f'{count} {what} equal'}", flush=True)
    return equal


def fly(program: Path, folder: Path):
    """Flies all flights with every step in the log. A mission that fails is a flight all the same."""
    full = ["--log", "full"] if "--log " in subprocess.run([program, "fly", "--help"], capture_output=True, text=True).stdout else []
    for name, options in FLIGHTS.items():
        done = subprocess.run([program, "fly", *options, *full, "--out", folder / name], capture_output=True, text=True)
        if done.returncode not in (0, 1):
            raise RuntimeError(f"{name}: {done.stderr.strip()}")
        print(f"{name}: {done.stdout.strip().splitlines()[0]}", flush=True)


def print_frames(log: Path):
    for _, direction, frame in frames_of(LogReader(log)):
        if direction == 0:
            print(frame.hex())


def main(arguments: list[str]) -> int:
    try:
        if len(arguments) == 2 and arguments[0] == "--frames":
            print_frames(Path(arguments[1]))
            return 0
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
