# SPDX-License-Identifier: BSD-3-Clause
"""What both kinds of workers are given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._yaml import CampaignError

Task = dict[str, Any]  #: The arguments of _worker.fly.
Result = dict[str, Any]
MAX_TRIES = 3  #: Processes that may end while they fly one flight, before it is taken for the cause.
MAX_KILLS = 20  #: The same where they were killed.


@dataclass
class Flight:
    """A flight that has no result yet."""

    seed: int
    task: Task
    tries: int = 0


class FlightRefused(CampaignError):
    """The simulation refused what was drawn for a flight."""

    def __init__(self, seed: int, text: str):
        super().__init__(f"seed {seed}: {text}")
