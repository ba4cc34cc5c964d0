# SPDX-License-Identifier: BSD-3-Clause
"""A campaign flown, or read from its folder."""

from __future__ import annotations

import hashlib
import json
import os
import shlex
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from .. import _arguments as arguments
from .. import _worker
from . import _cluster, _local, _store
from ._configuration import Configuration
from ._store import Store
from ._yaml import CampaignError

if TYPE_CHECKING:
    import pandas

Progress = Callable[[int, int], None]
FLUSH_S = 1.0  #: Rows that a killed campaign flies again.
CONDITIONS_END = "passed"  #: The column that follows the conditions.
#: Columns of results: name, type.
RESULTS: tuple[tuple[str, type], ...] = (
    (CONDITIONS_END, bool), ("broken", str), ("outcome", str), ("verdict", str), ("waypoints_reached", int), ("waypoints_total", int),
    ("worst_waypoint_m", float), ("tracking_rms_m", float), ("tracking_max_m", float), ("own_tracking_rms_m", float),
    ("own_tracking_max_m", float), ("touchdown_speed_m_s", float), ("touchdown_tilt_deg", float), ("touchdown_distance_m", float),
    ("flight_time_s", float), ("sim_time_s", float), ("warnings", int), ("errors", int), ("motion_sha256", str), ("command", str))


@dataclass(frozen=True)
class Campaign:
    """The rows of a campaign, one for each flight that has ended."""

    folder: Path
    configuration: Configuration
    identity: dict[str, Any]
    table: pa.Table

    def __getitem__(self, column: str) -> np.ndarray[Any, Any]:
        if column not in self.table.column_names:
            raise KeyError(f"{column}: not in {self.folder}, which has {', '.join(self.table.column_names)}")
        return np.asarray(self.table.column(column).to_numpy())

    def __len__(self) -> int:
        return int(self.table.num_rows)

    @property
    def flights(self) -> int:
        """How many it has when it has ended."""
        return self.configuration.flights

    @property
    def passed(self) -> int:
        return int(np.count_nonzero(self["passed"]))

    def to_pandas(self) -> pandas.DataFrame:
        """The rows, indexed by seed. Needs pandas."""
        import pandas

        return pandas.DataFrame({name: self[name] for name in self.table.column_names}).set_index("seed")


def identity_of(configuration: Configuration) -> dict[str, Any]:
    """What the rows are a function of."""
    import scipy

    return {"format": 1, "program": _worker.program(), "campaign": hashlib.sha256(configuration.text.encode()).hexdigest(),
            "files": configuration.files, "scipy": scipy.__version__ if configuration.plan.sobol else ""}


def default_folder(configuration: Configuration) -> Path:
    """Another one for each program and configuration, so that campaigns of different commits lie beside each other."""
    digest = hashlib.sha256(json.dumps(identity_of(configuration), sort_keys=True).encode()).hexdigest()
    return Path("campaigns") / f"{configuration.file.stem}-{digest[:8]}"


def _schema(configuration: Configuration) -> pa.Schema:
    columns: list[tuple[str, type]] = [("seed", int)]
    for name, values in configuration.values.items():
        if not name.startswith("faults["):
            columns.append((name, float if all(isinstance(value, float) for value in values) else str))
    return _store.schema([*columns, ("faults", str), *RESULTS])


def command(configuration: Configuration, seed: int) -> str:
    """The command that flies this seed again, equal to the bit."""
    chosen = configuration.arguments(seed)
    words = ["./rosflight", "fly", "--vehicle", chosen["vehicle"], "--mission", chosen["mission"], "--seed", str(seed)]
    for option, default in (("state", "estimate"), ("pilot", "hover")):
        if chosen[option] != default:
            words += [f"--{option}", chosen[option]]
    if chosen["wind"]:
        words += ["--wind", chosen["wind"]]
    for key, value in chosen["set"].items():
        words += ["--set", f"{key}={value}"]
    for fault in chosen["faults"]:
        words += ["--fault", fault]
    return shlex.join(words)


def _row(configuration: Configuration, schema: pa.Schema, seed: int, result: dict[str, Any]) -> dict[str, Any]:
    broken = configuration.criteria.broken(result)
    row = {"seed": seed, **configuration.conditions(seed), "passed": not broken, "broken": "; ".join(broken),
           "command": command(configuration, seed), **result}
    return {field.name: str(row[field.name]) if field.type == pa.string() else row[field.name] for field in schema}


def fly(file: str | os.PathLike[str], out: str | os.PathLike[str] | None = None, *, workers: int | None = None,
        dask: str | None = None, progress: Progress | None = None) -> Campaign:
    """Flies a campaign, or what is left of it, into a folder.

    file       the campaign, YAML (docs/campaigns.md)
    out        its folder: new, or one that the same campaign was flown into before. None: one in campaigns/
    workers    processes of this machine; None: one for each processor
    dask       address of a scheduler of Dask instead, such as tcp://host:8786
    progress   called after each flight with the number of flights done and wanted

    The rows do not depend on how many workers there are, nor on how often it was interrupted: Ctrl-C, a killed worker, a killed
    campaign. Raises CampaignError for bad input (nothing is written then), OSError where a file cannot be written.
    """
    count = processors() if workers is None else arguments.whole("workers", workers, 1)
    configuration = Configuration(Path(file))
    folder = default_folder(configuration) if out is None else Path(out)
    identity = identity_of(configuration)
    schema = _schema(configuration)
    with ExitStack() as stack:
        cluster = None if dask is None else stack.enter_context(closing(_cluster.Cluster(dask)))
        store = stack.enter_context(closing(Store(folder, identity, configuration.text, schema)))
        tasks = ((seed, {"arguments": configuration.arguments(seed)}) for seed in configuration.seeds if seed not in store.done)
        results = stack.enter_context(closing(cluster.results(tasks) if cluster else _local.results(tasks, count)))
        _fill(store, ((seed, _row(configuration, schema, seed, result)) for seed, result in results), configuration.flights, progress)
        return Campaign(folder, configuration, identity, store.finish())


def fly_again(campaign: Campaign, folders: dict[int, Path], workers: int | None = None) -> None:
    """Flies seeds again with their logs into flight folders, but those that have been."""
    missing = {seed: folder for seed, folder in folders.items() if not (folder / "summary.json").exists()}
    for folder in missing.values():
        folder.parent.mkdir(exist_ok=True)
    sums = dict(zip(campaign["seed"], campaign["motion_sha256"]))
    tasks = ((seed, {"arguments": campaign.configuration.arguments(seed), "folder": str(folder)}) for seed, folder in missing.items())
    with closing(_local.results(tasks, workers or processors())) as results:
        for seed, result in results:
            if result["motion_sha256"] != sums[seed]:
                shutil.rmtree(missing[seed])
                raise CampaignError(f"seed {seed}: flown again it moves otherwise than in its row, allowed the same motion: was it flown by "
                                    "another processor or with other libraries?")


def _fill(store: Store, rows: Iterator[tuple[int, dict[str, Any]]], wanted: int, progress: Progress | None) -> None:
    last = time.monotonic()
    try:
        for _, row in rows:
            store.add(row)
            if progress:
                progress(len(store.done), wanted)
            if time.monotonic() - last >= FLUSH_S:
                store.flush()
                last = time.monotonic()
    finally:
        store.flush()


def read(folder: str | os.PathLike[str]) -> Campaign:
    """A campaign from its folder, with the rows that it has."""
    place = Path(folder)
    identity = _store.read_identity(place)
    if identity is None:
        raise CampaignError(f"{place}: found no campaign, allowed a folder with {_store.IDENTITY}")
    table = _store.rows_of(place)
    if table is None:
        raise CampaignError(f"{place}: found no rows, allowed at least one flight that has ended")
    return Campaign(place, Configuration(place / _store.YAML, check=False), identity, table)


def processors() -> int:
    return len(os.sched_getaffinity(0))
