# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a campaign: its rows, written whole.

    campaign.json     what the rows are a function of: program and configuration
    campaign.yaml     the file as it was read
    rows/             rows of a campaign that flies; a file for each second or so
    rows.parquet      all rows by their seeds, when it has ended
    worst/SEED/       flight folders of the worst flights
    report.html

Each file is written beside its place, brought to the disk and renamed, so that a process that is killed leaves no part of one.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import pyarrow as pa
import pyarrow.parquet as pq

from ._yaml import CampaignError

Row = dict[str, Any]
IDENTITY, YAML, ROWS, PARTS = "campaign.json", "campaign.yaml", "rows.parquet", "rows"


def write_whole(path: Path, content: bytes) -> None:
    """All of it or nothing, also if the machine stops."""
    aside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with aside.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        aside.rename(path)
    except OSError as error:
        aside.unlink(missing_ok=True)
        raise OSError(error.errno, error.strerror, str(path)) from None
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def read_table(path: Path) -> pa.Table:
    try:
        return pq.read_table(path)
    except (pa.ArrowException, OSError) as error:
        raise CampaignError(f"{path}: found no whole Parquet file ({' '.join(str(error).split())[:120]}); allowed without it, its flights "
                            "are then flown again") from None


@dataclass
class _Part:
    """Rows that become one file."""

    number: int
    rows: list[Row] = field(default_factory=list)


class Store:
    """The folder of a campaign that is flown by this process, and by no other."""

    def __init__(self, folder: Path, identity: dict[str, Any], text: str, schema: pa.Schema):
        self.folder = folder
        self._schema = schema
        self._lock = -1
        self._open(identity, text)
        last = _parts(folder)[-1:]
        self._part = _Part(int(last[0].stem) + 1 if last else 1)
        try:
            self.done = {int(seed) for seed in self.table().column("seed").to_numpy()}
        except CampaignError:
            self.close()
            raise

    def _open(self, identity: dict[str, Any], text: str) -> None:
        found = read_identity(self.folder)
        if found is None and _holds_something_else(self.folder):
            raise CampaignError(f"--out: found {self.folder} with something else in it, allowed a new folder, or one of this campaign")
        if found is not None and found != identity:
            _refuse(self.folder, found, identity)
        (self.folder / PARTS).mkdir(parents=True, exist_ok=True)
        self._lock = os.open(self.folder / PARTS, os.O_RDONLY)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise CampaignError(f"--out: found {self.folder} in use by another process, allowed one at a time") from None
        for left in self.folder.glob(f"{PARTS}/.*"):  # of a process that was killed
            left.unlink()
        if found is None:
            write_whole(self.folder / YAML, text.encode())
            write_whole(self.folder / IDENTITY, json.dumps(identity, indent=1, sort_keys=True).encode() + b"\n")

    def table(self) -> pa.Table:
        """All rows on the disk."""
        return rows_of(self.folder) or self._schema.empty_table()

    def add(self, row: Row) -> None:
        self._part.rows.append(row)
        self.done.add(int(row["seed"]))

    def flush(self) -> None:
        """Brings the rows added since to the disk. Where a signal stops it, the next call writes the same file again."""
        part = self._part
        if part.rows:
            write_whole(self.folder / PARTS / f"{part.number:06d}.parquet", to_parquet(pa.Table.from_pylist(part.rows, schema=self._schema)))
            self._part = _Part(part.number + 1)

    def finish(self) -> pa.Table:
        """Makes one file of all. What it holds does not depend on the order in which rows came."""
        self.flush()
        table = self.table().combine_chunks()
        if not (self.folder / ROWS).exists():
            write_whole(self.folder / ROWS, to_parquet(table))
        for part in _parts(self.folder):
            part.unlink()
        return table

    def close(self) -> None:
        if self._lock >= 0:
            os.close(self._lock)
            self._lock = -1


def _parts(folder: Path) -> list[Path]:
    return sorted((folder / PARTS).glob("*.parquet"))


def rows_of(folder: Path) -> pa.Table | None:
    """All rows on the disk by their seeds, each once; None: there are none."""
    files = [folder / ROWS] if (folder / ROWS).exists() else _parts(folder)
    if not files:
        return None
    table = pa.concat_tables([read_table(path) for path in files]).sort_by("seed")
    seeds = table.column("seed").to_numpy()
    twice = seeds[1:][seeds[1:] == seeds[:-1]]
    if len(twice):
        raise CampaignError(f"{folder}: found seed {twice[0]} twice, allowed once")
    return table


def to_parquet(table: pa.Table) -> bytes:
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink)
    content: bytes = sink.getvalue().to_pybytes()
    return content


def _holds_something_else(folder: Path) -> bool:
    """True unless it is new, empty, or was left by a campaign that could not write its first files."""
    if not folder.is_dir():
        return folder.exists()
    names = {path.name for path in folder.iterdir() if not path.name.startswith(".")}
    return bool(names - {YAML, PARTS}) or any((folder / PARTS).glob("*.parquet"))


def read_identity(folder: Path) -> dict[str, Any] | None:
    """None: the folder is of no campaign."""
    try:
        found: dict[str, Any] = json.loads((folder / IDENTITY).read_text())
        return found
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError) as error:
        raise CampaignError(f"{folder / IDENTITY}: cannot read it: {' '.join(str(error).split())}") from None


def _refuse(folder: Path, found: dict[str, Any], wanted: dict[str, Any]) -> NoReturn:
    differing = sorted(key for key in {*found, *wanted} if found.get(key) != wanted.get(key))
    detail = f"{found.get('program')}, allowed {wanted.get('program')}" if "program" in differing else f"another {', '.join(differing)}"
    raise CampaignError(f"--out: found {folder} with flights of {detail}; allowed the same, or another folder by --out")


def schema(columns: Iterable[tuple[str, type]]) -> pa.Schema:
    """Types of rows from those of Python."""
    kinds = {int: pa.int64(), float: pa.float64(), str: pa.string(), bool: pa.bool_()}
    return pa.schema([(name, kinds[kind]) for name, kind in columns])
