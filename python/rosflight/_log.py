# SPDX-License-Identifier: BSD-3-Clause
"""Logs of flights as arrays."""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pandas

Array = np.ndarray[Any, Any]


class Topic(Mapping[str, Array]):
    """The messages of a topic: an array for each field, with a row for each message. Fields of fields have names such as
    `pose.position.x`; arrays of a fixed length are a second dimension. What has no fixed shape is an array of objects."""

    def __init__(self, name: str, t_s: Array, columns: dict[str, Array]):
        self.name = name
        self.t_s = t_s  #: Time of the log, seconds since the start of the flight.
        self._columns = columns

    def __getitem__(self, field: str) -> Array:
        return self._columns[field]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        return f"<{self.name}: {len(self.t_s)} messages of {', '.join(self._columns)}>"

    def to_pandas(self) -> pandas.DataFrame:
        """A table indexed by time; elements of arrays are columns such as `position[0]`. Needs pandas."""
        import pandas

        table: dict[str, Any] = {}
        for name, values in self._columns.items():
            if values.ndim == 2:
                table |= {f"{name}[{k}]": values[:, k] for k in range(values.shape[1])}
            else:
                table[name] = values
        return pandas.DataFrame(table, index=pandas.Index(self.t_s, name="t_s"))


class Log(Mapping[str, Topic]):
    """A log by its topics: `log["/imu/data"]["angular_velocity.z"]`. A topic is decoded when it is asked for first."""

    def __init__(self, path: Path, summary: dict[str, Any] | None, reader: Any, topics: dict[str, int], start_ns: int):
        self.path = path
        self.summary = summary  #: summary.json of the flight folder; None for a file alone.
        self._reader = reader
        self._counts = topics
        self._start_ns = start_ns
        self._topics: dict[str, Topic] = {}

    def __getitem__(self, name: str) -> Topic:
        if name not in self._counts:
            raise KeyError(f"{name}: not in {self.path}, which has {', '.join(self._counts)}")
        if name not in self._topics:
            self._topics[name] = self._decode(name)
        return self._topics[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._counts)

    def __len__(self) -> int:
        return len(self._counts)

    def __repr__(self) -> str:
        return f"<{self.path}: {sum(self._counts.values())} messages in {len(self)} topics>"

    def _decode(self, name: str) -> Topic:
        times, messages = [], []
        with _readable(self.path), self.path.open("rb") as file:
            for _, _, record, message in self._reader(file).iter_decoded_messages(topics=[name]):
                times.append(record.log_time - self._start_ns)
                messages.append(message)
        return Topic(name, np.array(times) / 1e9, dict(_columns(messages, "")))


def _columns(values: list[Any], name: str) -> Iterator[tuple[str, Array]]:
    first: Any = values[0] if values else None
    if hasattr(first, "__slots__"):
        for field in first.__slots__:
            yield from _columns([getattr(value, field) for value in values], f"{name}.{field}" if name else field)
    elif isinstance(first, (list, tuple, bytes, bytearray)):
        lengths = {len(value) for value in values}
        if len(lengths) == 1 and all(isinstance(one, (bool, int, float)) for one in values[0]):
            yield name, np.array([list(value) for value in values])
        else:
            ragged = np.empty(len(values), dtype=object)
            ragged[:] = [list(value) for value in values]
            yield name, ragged
    elif isinstance(first, str):
        yield name, np.array(values, dtype=object)
    else:
        yield name, np.array(values)


class _readable:
    """What a damaged file raises in the packages that read it becomes one line."""

    def __init__(self, path: Path):
        self.path = path

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, _traceback: object) -> None:
        from mcap.exceptions import McapError
        from zstandard import ZstdError

        damaged = (McapError, ZstdError, struct.error, ValueError, EOFError, IndexError, KeyError, AssertionError)
        if isinstance(error, damaged):
            said = " ".join(str(error).split()) or type(error).__name__
            raise ValueError(f"{self.path}: cannot read the log, it is damaged or not MCAP: {said}") from None


def read(flight: str | os.PathLike[str]) -> Log:
    """Opens the log of a flight folder, or an MCAP file. Needs mcap and mcap-ros2-support (pip install '.[read]')."""
    try:
        from mcap.reader import make_reader
        from mcap_ros2.decoder import DecoderFactory
    except ImportError as error:
        raise ImportError(f"rosflight.read: found no {error.name}, allowed with mcap and mcap-ros2-support installed") from None
    folder = Path(flight)
    path = folder / "flight.mcap" if folder.is_dir() else folder
    if not path.is_file():
        raise FileNotFoundError(f"{path}: found no log, allowed a flight folder or an MCAP file")
    with _readable(path), path.open("rb") as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
        if summary is None or summary.statistics is None:
            raise ValueError("it has no summary")
        counts = summary.statistics.channel_message_counts
        topics = {channel.topic: counts.get(key, 0) for key, channel in summary.channels.items()}
        # Files of a flight are attached to its start.
        start_ns = min((one.log_time for one in summary.attachment_indexes), default=summary.statistics.message_start_time)
    said = path.with_name("summary.json")
    return Log(
        path,
        json.loads(said.read_text(encoding="utf-8")) if folder.is_dir() and said.is_file() else None,
        lambda file: make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()]),
        {name: topics[name] for name in sorted(topics) if topics[name]},
        start_ns,
    )
