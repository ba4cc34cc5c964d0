# SPDX-License-Identifier: BSD-3-Clause
"""Usage: ./rosflight log FLIGHT [--csv TOPIC [--out FILE [--force]]]

Shows what the log of a flight contains. FLIGHT is a flight folder or an MCAP file.

Without an option: each topic with its type, its number of messages and its mean rate over the log.

--csv TOPIC    prints the messages of a topic as a table: a line of names, then a line for each message. The first
               column, time_s, is the time of the log in seconds since the start of the flight; the others are the
               fields, nested ones as pose.position.x, elements of arrays as values[3]. A cell is empty where an array
               is shorter than in another message. Numbers have all digits; true is 1, false is 0.
--out FILE     writes the table to FILE, which appears when it is complete. --force replaces an existing file.

Exit code 2 with one line for a topic that is not in the log and for a file that cannot be read.
"""

import csv
import difflib
import io
import os
import struct
import sys
from collections.abc import Iterator
from pathlib import Path

import zstandard
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

UNREADABLE = (McapError, struct.error, zstandard.ZstdError, ValueError, EOFError, IndexError, KeyError, AssertionError)


class Refused(Exception):
    """One line for the user."""


def log_of(flight: Path) -> Path:
    path = flight / "flight.mcap" if flight.is_dir() else flight
    if not path.is_file():
        raise Refused(f"{path}: found no log, allowed a flight folder or an MCAP file")
    return path


def summary_of(reader, path: Path):
    summary = reader.get_summary()
    if summary is None or summary.statistics is None:
        raise Refused(f"{path}: the log is not complete: it has no summary")
    return summary


def listing(path: Path) -> str:
    with path.open("rb") as file:
        summary = summary_of(make_reader(file), path)
    counts = summary.statistics
    seconds = (counts.message_end_time - counts.message_start_time) / 1e9
    rows = [(channel.topic, summary.schemas[channel.schema_id].name, counts.channel_message_counts.get(key, 0))
            for key, channel in summary.channels.items()]
    width = max([len(topic) for topic, _, _ in rows], default=5) + 2
    kind = max([len(name) for _, name, _ in rows], default=4) + 2
    lines = [f"{'topic':<{width}}{'type':<{kind}}{'messages':>9}{'rate [Hz]':>11}"]
    for topic, name, count in sorted(rows):
        rate = f"{count / seconds:.1f}" if seconds > 0 and count > 1 else "-"
        lines.append(f"{topic:<{width}}{name:<{kind}}{count:>9}{rate:>11}")
    return "\n".join([*lines, f"{counts.message_count} messages, {seconds:.2f} s"]) + "\n"


def flat(value, name: str) -> Iterator[tuple[str, object]]:
    if hasattr(value, "__slots__"):
        for field in value.__slots__:
            yield from flat(getattr(value, field), f"{name}.{field}" if name else field)
    elif isinstance(value, (list, tuple, bytes, bytearray)):
        for index, element in enumerate(value):
            yield from flat(element, f"{name}[{index}]")
    else:
        yield name, int(value) if isinstance(value, bool) else value


def ordered(columns: dict[str, tuple]) -> list[str]:
    return sorted(columns, key=columns.get)


def table(path: Path, topic: str) -> str:
    """The messages of `topic` as CSV."""
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        summary = summary_of(reader, path)
        topics = sorted({channel.topic for channel in summary.channels.values()})
        if topic not in topics:
            near = difflib.get_close_matches(topic, topics, n=5, cutoff=0.4) or topics
            raise Refused(f"{path}: found no topic '{topic}', near it: {', '.join(near)}")
        # Files of a flight are attached to its start.
        start_ns = min([a.log_time for a in summary.attachment_indexes], default=summary.statistics.message_start_time)
        rows: list[dict[str, object]] = []
        places: dict[str, tuple] = {}  # column -> where it stands in a message
        for _, _, record, message in reader.iter_decoded_messages(topics=[topic]):
            row = dict(flat(message, ""))
            if not row.keys() <= places.keys():
                places |= {name: place(name, message) for name in row.keys() - places.keys()}
            rows.append({"time_s": (record.log_time - start_ns) / 1e9} | row)
    out = io.StringIO()
    writer = csv.DictWriter(out, ["time_s", *ordered(places)], restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def place(name: str, message) -> tuple:
    """Sorts columns in the order of the fields, elements of an array by their number."""
    found: list[int] = []
    value = message
    for step in name.split("."):
        field, *indexes = step.replace("]", "").split("[")
        found.append(list(value.__slots__).index(field))
        value = getattr(value, field)
        for index in map(int, indexes):
            found.append(index)
            value = value[index]
    return tuple(found)


def write(file: Path, text: str, force: bool):
    if file.exists() and not force:
        raise Refused(f"{file}: exists; use --force to replace it")
    part = file.with_name(file.name + ".part")
    try:
        part.write_text(text)
        part.replace(file)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise Refused(f"{file}: cannot write: {error.strerror}") from None


def parse(arguments: list[str]) -> tuple[Path, str | None, Path | None, bool]:
    rest, flights, options, force = iter(arguments), [], {}, False
    for argument in rest:
        name, equals, value = argument.partition("=")
        if name in ("--csv", "--out"):
            options[name] = value if equals else next(rest, "")
            if not options[name]:
                raise Refused(f"{name} needs a {'topic' if name == '--csv' else 'file name'}")
        elif argument == "--force":
            force = True
        elif argument.startswith("-"):
            raise Refused(f"unknown option '{argument}'; allowed: --csv TOPIC, --out FILE, --force, --help")
        else:
            flights.append(argument)
    if len(flights) != 1:
        raise Refused(f"found {len(flights)} flights, allowed one: ./rosflight log FLIGHT [--csv TOPIC]")
    if "--out" in options and "--csv" not in options:
        raise Refused("--out needs --csv TOPIC")
    return Path(flights[0]), options.get("--csv"), Path(options["--out"]) if "--out" in options else None, force


def main(arguments: list[str]) -> int:
    if {"-h", "--help"} & set(arguments):
        print(__doc__)
        return 0
    try:
        flight, topic, out, force = parse(arguments)
        path = log_of(flight)
        try:
            text = table(path, topic) if topic else listing(path)
        except UNREADABLE as error:
            raise Refused(f"{path}: cannot read the log, it is damaged or not MCAP: {error or type(error).__name__}") from None
        except OSError as error:
            raise Refused(f"{path}: cannot read: {error.strerror}") from None
        if out:
            write(out, text, force)
        else:
            sys.stdout.write(text)
            sys.stdout.flush()
    except Refused as refused:
        print("rosflight: " + " ".join(str(refused).split("\n")), file=sys.stderr)
        return 2
    except BrokenPipeError:  # such as `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
