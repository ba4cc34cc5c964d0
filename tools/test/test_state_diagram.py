# SPDX-License-Identifier: BSD-3-Clause
"""The picture of the state machine follows its table."""

import project
import pytest
import state_diagram as diagram

TABLE = (project.ROOT / diagram.TABLE).read_text()


def test_the_document_is_up_to_date():
    made = diagram.document(diagram.read(TABLE))
    assert (project.ROOT / diagram.DOCUMENT).read_text() == made, "run tools/state_diagram.py"


def test_every_row_is_drawn_or_listed():
    rows = diagram.read(TABLE)
    made = diagram.document(rows).splitlines()
    arrows = [line for line in made if "-->" in line and "[*]" not in line]
    listed = [line for line in made if line.startswith("| ") and not line.startswith("| state")]
    assert len(arrows) + len(listed) == len(rows) == 45
    assert "    Armed --> Failsafe: RC lost / failsafe on, set RC lost" in arrows


def test_a_row_that_is_not_understood_ends_in_one_line():
    with pytest.raises(SystemExit, match="44 rows that can be read, the table has 45"):
        diagram.read(TABLE.replace("State::kInit,  ", "State::kInit+0,", 1))
    with pytest.raises(SystemExit, match="found 'Nonsense', allowed "):
        diagram.read(TABLE.replace("Event::kRcFound, ", "Event::kNonsense, ", 1))
