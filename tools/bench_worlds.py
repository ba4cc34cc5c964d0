# SPDX-License-Identifier: BSD-3-Clause
"""./rosflight bench worlds: every engine moves vehicles through their missions, beside our integrator and under the same noise and wind.

The table goes to the terminal and, with pictures, to docs/simulation/README.md. Each flight is judged by the true state.
"""

import csv
import functools
import math
import subprocess
from pathlib import Path

import bench_programs
import project

PAGE = project.ROOT / "docs/simulation/README.md"
PICTURE = project.ROOT / "docs/img/engines.png"
DISTANCES = project.ROOT / "build/worlds"  # CSV files, distance of the true positions against time
ENGINES = ("runge_kutta_held", "jsbsim", "gazebo")
GUSTS = "6,270,4"  # steady wind, from where, gusts, as of --wind
# Vehicle, mission, wind.
ROTORS = [("multirotor", "default", ""), ("multirotor", "default", GUSTS), ("multirotor", "hover", ""), ("quad_plus", "default", ""),
          ("tricopter", "default", ""), ("hexarotor", "default", ""), ("hexa_plus", "default", ""), ("y6", "default", ""),
          ("octorotor", "default", ""), ("octo_plus", "default", ""), ("x8", "default", "")]
WINGS = [("anaconda", "default", ""), ("anaconda", "default", GUSTS), ("openvsp_anaconda", "default", ""), ("xflr5_anaconda", "default", ""),
         ("fixedwing", "default", ""), ("flying_wing", "default", ""), ("aerosonde", "wide_circuit", ""), ("quadplane", "default", ""),
         ("quadplane", "default", GUSTS)]
FLIGHTS = ROTORS + WINGS
TITLES = ["engine", "vehicle, mission", "position m", "attitude deg", "tracking rms m, ours and its", "touchdown m/s, ours and its"]


def fly(engine: str, vehicle: str, mission: str, wind: str) -> dict:
    DISTANCES.mkdir(parents=True, exist_ok=True)
    words = ["--wind", wind] if wind else []
    return bench_programs.run_json([bench_programs.program("worlds"), engine, vehicle, mission, *words,
                                    "--csv", str(csv_file(engine, vehicle, mission, wind))])


def csv_file(*flight: str) -> Path:
    return DISTANCES / ("_".join(word.replace(",", "-") for word in flight if word) + ".csv")


def table(flown: dict[tuple[str, str, str, str], dict]) -> str:
    lines = [f"| {' | '.join(TITLES)} |", "|" + "---|" * len(TITLES)]
    for (engine, vehicle, mission, wind), found in flown.items():
        named = f"{vehicle}, {mission}" + (f", wind {wind}" if wind else "")
        named += "" if all(found["success"]) else ": **not a success**"
        pairs = [(found["position_rms_m"], found["position_max_m"]), (found["attitude_rms_deg"], found["attitude_max_deg"]),
                 found["tracking_rms_m"], found["touchdown_m_s"]]
        lines.append("| " + " | ".join([engine, named, *(", ".join(map(shown, pair)) for pair in pairs)]) + " |")
    return "\n".join(lines) + "\n"


def shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


BEGIN, END = "<!-- Written by ./rosflight bench worlds: do not edit. -->\n", "<!-- End of the table. -->\n"


def write_page(rows: str, page: Path = PAGE):
    """The table between its two marks; nothing else of the page is changed."""
    before, begin, rest = page.read_text().partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise RuntimeError(f"{page}: found no table, expected the lines {BEGIN.strip()} and {END.strip()}")
    page.write_text(before + begin + rows + end + after)


@functools.cache
def flights() -> dict[tuple[str, str, str, str], dict]:
    """All of them, flown once; written to the page and drawn, as are the worlds."""
    import worlds_pictures  # not above: worlds_plot.py imports this file in an environment that cannot read logs
    flown = {(engine, *flight): fly(engine, *flight) for flight in FLIGHTS for engine in ENGINES}
    rows = table(flown)
    print(rows, flush=True)
    write_page(rows)
    draw()
    worlds_pictures.make()
    return flown


def draw():
    """By matplotlib, in an environment of its own."""
    bench_programs.environment(".venv-plot", "tools/requirements-plot.txt")
    python = project.ROOT / ".venv-plot/bin/python3"
    subprocess.run([str(python), str(project.ROOT / "tools/worlds_plot.py"), str(PICTURE)], check=True)


def worst(engine: str, chosen: list[tuple[str, str, str]], quantity: str) -> float:
    return max(flights()[engine, *flight][quantity] for flight in chosen)


def worst_between(engine: str, chosen: list[tuple[str, str, str]], quantity: str) -> float:
    """The largest difference of the pair: ours and that of the engine."""
    pairs = (flights()[engine, *flight][quantity] for flight in chosen)
    return max(math.inf if None in pair else abs(pair[0] - pair[1]) for pair in pairs)


def failed() -> int:
    return sum(not all(found["success"]) for found in flights().values())


def distances(*flight: str) -> list[tuple[float, float]]:
    with csv_file(*flight).open() as lines:
        return [(float(row["time_s"]), float(row["distance_m"])) for row in csv.DictReader(lines)]
