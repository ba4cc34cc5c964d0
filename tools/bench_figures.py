# SPDX-License-Identifier: BSD-3-Clause
"""The figures of ./rosflight bench: the function that measures each, and what it should be. A new one is one more row in all_figures()."""

import functools
from dataclasses import dataclass, replace
from typing import Callable

import bench_build
import bench_web
import bench_worlds
import driver_coverage
import h7_figures
import m7_figures
import stages
from bench_programs import (
    cluster, counted, dart_realtime_factor, estimation_figure, faults, firmware_pass, fly_runs, fly_wall_s, fuzz_runs, fuzz_target,
    inference, link_rate, load, log_share, loop_factor, loop_steps, mission_figure, number, properties, random_faults, ros_factor,
    round_trip, scale, seeds_failed, setup_share, size, wind_limit, worst_learned, worst_over_mean)


@dataclass(frozen=True)
class Figure:
    name: str
    unit: str
    target: str  # "<= 2500", or "report" when there is nothing to meet
    measure: Callable[[], float]
    preset: str = "release"  # the build it needs, or "none"
    on_request: bool = False  # takes long: only measured when named, or with --all
    by: str = ""  # a name that chooses it must have this in it: its group takes minutes, it an hour


def all_figures() -> list[Figure]:
    return [
        Figure("firmware.instructions_full", "instructions", "<= 4200",
               lambda: firmware_pass(load="full")),
        Figure("firmware.worst_over_mean", "x", "<= 4", worst_over_mean),
        Figure("firmware.instructions", "instructions", "<= 2500", firmware_pass),
        Figure("firmware.instructions_no_link", "instructions", "<= 2000",
               lambda: firmware_pass("none")),
        Figure("inference.instructions", "instructions", "report", inference),
        Figure("lean.instructions", "instructions", "report", lambda: firmware_pass("lean")),
        Figure("mavlink.bytes_per_s", "B/s", "report", lambda: link_rate("mavlink")),
        Figure("lean.bytes_per_s", "B/s", "report", lambda: link_rate("lean")),
        Figure("loop.realtime_factor", "s/s", ">= 1000", lambda: loop_factor("realtime_factor")),
        Figure("loop.realtime_factor_log", "s/s", "report",
               lambda: loop_factor("realtime_factor_log")),
        Figure("loop.log_share", "x", ">= 0.45", log_share),
        Figure("loop.realtime_factor_ekf", "s/s", ">= 500",
               lambda: loop_factor("realtime_factor_ekf")),
        Figure("loop.realtime_factor_fixedwing", "s/s", ">= 500",
               lambda: loop_factor("realtime_factor_fixedwing")),
        Figure("loop.instructions_per_step", "instructions", "<= 9000", lambda: loop_steps("truth")),
        Figure("loop.instructions_per_step_ekf", "instructions", "<= 13000", lambda: loop_steps("estimate")),
        Figure("loop.instructions_per_step_unlinked", "instructions", "report", lambda: loop_steps("unlinked")),
        Figure("loop.setup_share", "x", "<= 0.05", setup_share),
        Figure("worlds.dart_realtime_factor", "s/s", ">= 100", dart_realtime_factor, "gazebo", on_request=True),
        *worlds(),
        Figure("firmware.object_bytes", "B", "<= 14000", lambda: size("firmware.object_bytes")),
        Figure("firmware.heap_allocations", "allocations", "= 0",
               lambda: size("firmware.heap_allocations")),
        Figure("fly.wall_s", "s", "< 5", fly_wall_s),
        Figure("firmware.frames_dropped", "frames", "= 0", lambda: counted("frames_dropped", "tx_dropped")),
        Figure("firmware.texts_lost", "texts", "= 0", lambda: counted("texts_lost")),
        Figure("firmware.samples_rejected", "samples", "= 0", lambda: counted("rejected")),
        Figure("firmware.gyro_latency_ms", "ms", "report", lambda: number(fly_runs()[0][1], "gyro_latency_ms")),
        *(Figure(f"estimation.{noise}.{quantity}", unit, estimation_target(noise, quantity),
                 functools.partial(estimation_figure, noise, quantity))
          for noise in ("shipped", "modelled") for quantity, unit in [*ESTIMATION, ("nis_range", "1")]),
        *(Figure(f"estimation.{air}.{quantity}", unit, estimation_target(air, quantity),
                 functools.partial(estimation_figure, air, quantity))
          for air in ("fixedwing_calm", "fixedwing", "fixedwing_gusts") for quantity, unit in ESTIMATION + AIR),
        *(Figure(f"missions.{name}.{quantity}", unit, target,
                 functools.partial(mission_figure, name, quantity))
          for name, quantity, unit, target in MISSIONS + FIXEDWING_MISSIONS),
        *(Figure(f"wind.{vehicle}_m_s", "m/s", f">= {limit}", functools.partial(wind_limit, vehicle), on_request=True)
          for vehicle, limit in WIND_LIMITS.items()),
        Figure("property.passes", "passes", ">= 100000000", lambda: properties()["passes"], "sanitizers",
               on_request=True),
        Figure("property.violations", "flights", "= 0", lambda: properties()["violations"], "sanitizers",
               on_request=True),
        Figure("build.flight_cpu_s", "s", "report", bench_build.flight_cpu_s, "none", on_request=True),
        Figure("web.bundle_kB", "kB", "<= 300", bench_web.bundle_kb, "none", on_request=True),
        *(Figure(f"web.{name}", unit, target, lambda name=name: bench_web.measured()[name], "none", on_request=True)
          for name, unit, target in bench_web.FIGURES),
        *(Figure(f"scale.{name}", unit, target, lambda name=name: number(scale(), name), "none", on_request=True)
          for name, unit, target in SCALE),
        *(Figure(f"scale.{name}", unit, target, lambda name=name: number(cluster("efficiency"), name), "none", on_request=True)
          for name, unit, target in [("dask_efficiency", "x", ">= 0.9"), ("dask_flights_per_minute", "1/min", "report")]),
        *(Figure(f"scale.{name}", "flights", target, lambda name=name: number(cluster("endurance"), name), "none", on_request=True, by="scale.rows")
          for name, target in [("rows_lost", "= 0"), ("rows_double", "= 0"), ("rows_differing", "= 0"), ("rows_kills", "report")]),
        *learning(),
        Figure("faults.flights", "flights", "report", lambda: faults()["flights"], on_request=True),
        Figure("faults.single_unexplained", "flights", "= 0", lambda: faults()["single_unexplained"], on_request=True),
        Figure("faults.pairs_unexplained", "flights", "= 0", lambda: faults()["pairs_unexplained"], on_request=True),
        *(Figure(f"faults.{name}", unit, target, lambda name=name: faults()[name], on_request=True) for name, unit, target in WITH_FAULTS),
        Figure("faults.random_flights", "flights", "report", lambda: random_faults()["flights"], on_request=True),
        Figure("faults.random_unexplained", "flights", "= 0",
               lambda: sum(random_faults()[f"{name}_unexplained"] for name in ("single", "pairs")), on_request=True),
        Figure("faults.seeds_failed", "flights", "= 0", seeds_failed, on_request=True),
        *m7(),
        *h7(),
        *(replace(figure, on_request=True) for figure in ros_figures()),
        *(Figure(f"fuzz.{name.removeprefix('fuzz_')}_runs", "inputs", f">= {fuzz_target(name)}",
                 functools.partial(fuzz_runs, name), preset="none", on_request=True) for name in stages.fuzzers()),
    ]


# Errors of the estimate in the default flights: rms and what 95 of 100 samples stay below.
ESTIMATION = [(f"{name}_{kind}", unit)
              for name, unit in (("horizontal_m", "m"), ("vertical_m", "m"), ("velocity_m_s", "m/s"),
                                 ("tilt_deg", "deg"), ("heading_deg", "deg")) for kind in ("rms", "p95")]
# Squared errors and innovations over their covariance: 1 is right; above, the filter is too sure of itself, below too careful.
CONSISTENT = {f"nees_{block}": "0.7..1.3" for block in ("attitude", "velocity", "position")}
CONSISTENT |= {f"nis_{aid}": "0.7..1.3"
               for aid in ("gnss_horizontal", "gnss_altitude", "gnss_velocity", "baro", "heading", "air_force")}
CONSISTENT |= {"unreliable_samples": "= 0"}
ESTIMATION += [("nees", "1")] + [(name, "1") for name in CONSISTENT]
CONSISTENT |= {"nis_pitot": "0.7..1.3", "nis_range": "0.7..1.3"}  # on its path a fixed wing is above the reach of its range sensor
# What the horizontal position was good to before the filter's covariances were consistent: consistency at its cost does not count.
NO_WORSE_THAN = {"shipped": "<= 0.174", "fixedwing_calm": "<= 0.241", "fixedwing": "<= 0.241", "fixedwing_gusts": "<= 0.241"}


def estimation_target(flown: str, quantity: str) -> str:
    if quantity == "horizontal_m_rms":
        return NO_WORSE_THAN.get(flown, "report")
    return CONSISTENT.get(quantity, "report")


AIR = [(f"{name}_{kind}", "m/s") for name in ("airspeed_m_s", "wind_m_s") for kind in ("rms", "p95")] + [("nis_pitot", "1")]

# Over the flights of the fault campaign, from the begin of the fault on: the share of time in which a state is outside its own
# 3 sigma, the largest of the nine; flights whose position was off by more than 15 m, in how many the estimate reported it within
# 10 s, and flights without a fault in which it did.
WITH_FAULTS = [("outside_worst", "1", "<= 0.01"), ("far", "flights", "report"), ("said_in_time_share", "1", ">= 0.95"),
               ("nominal_said", "flights", "= 0")]


# What bench/scale.py prints. Rates by the clock are for two cores that do nothing else. Of Crazyflow the fastest dynamics count.
SCALE = [("steps_per_s", "1/s", ">= 700000"), ("steps_per_core_s", "1/s", "report"), ("over_crazyflow", "x", ">= 0.9"),
         *((f"{name}{peer}{of}", unit, "report") for peer in ("crazyflow", "crazyflow_rotors", "l2f")
           for name, of, unit in (("", "_steps_per_s", "1/s"), ("", "_steps_per_core_s", "1/s"), ("over_", "", "x"), ("over_", "_two_cores", "x"))
           if (name, peer, of) != ("over_", "crazyflow", "")),
         ("steps_link_per_s", "1/s", ">= 500000"), ("steps_link_per_core_s", "1/s", "report"), ("thread_efficiency", "x", ">= 0.95"),
         ("flights_per_minute", "1/min", ">= 3000"), ("flights_per_core_minute", "1/min", "report"), ("flights_failed", "flights", "= 0"),
         ("memory_kB", "kB", "<= 200"), ("memory_equal_kB", "kB", "<= 200"), ("overhead_us", "us", "<= 15"), ("row_bytes", "B", "report"), ("log_bytes", "B", "report")]


# What python/examples/ppo.py is held to, from nothing and on two cores that do nothing else: task, successes of 100, seconds.
LEARNING = [("hover", 95, 180), ("gates", 80, 1800)]


def learning() -> list[Figure]:
    def row(task: str, name: str, unit: str, target: str, worst: Callable, quantity: str) -> Figure:
        return Figure(f"learn.{task}_{name}", unit, target, functools.partial(worst_learned, worst, task, quantity), "none", on_request=True)

    return [figure for task, successes, limit_s in LEARNING for figure in (
        row(task, "successes", "of 100", f">= {successes}", min, "successes"),
        row(task, "clock_s", "s", f"<= {limit_s}", max, "clock_s"), row(task, "processor_s", "s", "report", max, "processor_s"))]


def mission_rows() -> list[tuple[str, str, str, str]]:
    """Name, quantity, unit, target: what the flights of bench/missions.cpp are held to."""
    rows = []
    for name, limit in (("default", 1.0), ("figure_eight", 1.0), ("survey", 1.0), ("hover", 0.7)):
        rows += [(name, "horizontal_rms_m", "m", f"<= {limit}"), (name, "total_rms_m", "m", "report"),
                 (name, "completed", "flights", "= 1")]
    for name in ("gnss_loss", "gnss_loss_fast", "gnss_loss_wind"):
        rows += [(name, "horizontal_max_m", "m", "<= 30"), (name, "max_tilt_deg", "deg", "<= 45"),
                 (name, "landed", "flights", "= 1")]
    for name in ("baro_step", "mag_turned", "accel_step_x", "accel_step_y", "accel_step_z",
                 "gyro_step_x", "gyro_step_y", "gyro_step_z"):
        rows += [(name, "horizontal_max_m", "m", "report"), (name, "max_tilt_deg", "deg", "<= 45"),
                 (name, "landed", "flights", "= 1")]
    rows += [("default_gusts", "completed", "flights", "= 100"),
             ("default_gusts", "worst_horizontal_rms_m", "m", "report")]
    return rows


MISSIONS = mission_rows()


def fixedwing_rows() -> list[tuple[str, str, str, str]]:
    """The same for bench/missions_fixedwing.cpp. Faults are held to docs/faults.md."""
    rows = []
    for name in ("line", "fillet", "dubins", "racetrack_wind", "energy", "loops"):
        rows += [(name, "straight_rms_m", "m", "<= 3"), (name, "straight_total_rms_m", "m", "report"),
                 (name, "arc_rms_m", "m", "<= 5"), (name, "arc_total_rms_m", "m", "report"),
                 (name, "height_rms_m", "m", "<= 2"), (name, "airspeed_rms_m_s", "m/s", "<= 1"),
                 (name, "completed", "flights", "= 1")]
    # Where a path has corners without arcs no fixed wing can follow; these three radii behind each are not in the rows above.
    rows += [("line", "corner_rms_m", "m", "report"), ("line", "corner_max_m", "m", "report")]
    for name, limit in (("landing_range", 15), ("landing_no_range", 40), ("landing_wind", 15)):
        rows += [(name, "touchdown_distance_m", "m", f"<= {limit}"),
                 (name, "touchdown_sink_m_s", "m/s", "<= 1.5"), (name, "completed", "flights", "= 1")]
    rows += [("pitot_blocked", "min_airspeed_m_s", "m/s", ">= 11"),
             ("pitot_blocked", "completed", "flights", "= 1"),
             ("gnss_loss", "straight_total_rms_m", "m", "<= 15"),
             ("gnss_loss", "completed", "flights", "= 1"),
             ("motor_off", "min_airspeed_m_s", "m/s", ">= 11"),
             ("motor_off", "touchdown_sink_m_s", "m/s", "<= 2"),
             ("motor_off", "touchdown_distance_m", "m", "<= 30"),
             ("motor_off", "landed", "flights", "= 1")]
    rows += [(name, "max_bank_deg", "deg", "<= 60")
             for name in ("pitot_blocked", "gnss_loss", "motor_off", "gusts")]
    rows += [("gusts", "completed", "flights", "= 100"), ("gusts", "straight_rms_m", "m", "report"),
             ("gusts", "touchdown_distance_m", "m", "report"),
             ("gusts", "touchdown_sink_m_s", "m/s", "report")]
    return [(f"fixedwing_{name}", *rest) for name, *rest in rows]


FIXEDWING_MISSIONS = fixedwing_rows()

# Strongest wind in which a vehicle flew, as vehicles/README.md states it [m/s].
WIND_LIMITS = {"multirotor": 9, "anaconda": 5, "openvsp_anaconda": 5, "xflr5_anaconda": 6, "aerosonde": 6}


def m7() -> list[Figure]:
    """The emulated Cortex-M7; what the names mean stands in bench/m7/README.md."""
    def counted(name: str, key: str, unit: str, target: str) -> Figure:
        return Figure(f"m7.{name}", unit, target, lambda: m7_figures.passes()[key], "cortex-m7")

    def by_uart(name: str, unit: str) -> Figure:
        return Figure(f"m7.{name}", unit, "report", lambda: m7_figures.uart_flight()[name],
                      "cortex-m7")

    return [
        Figure("m7.text_bytes", "B", "<= 90000", m7_figures.text_bytes, "cortex-m7"),
        counted("object_bytes", "object_bytes", "B", "<= 12000"),
        counted("instructions", "instructions", "instructions", "report"),
        *(Figure(f"m7.instructions.{name}", "instructions", "report",
                 lambda name=name: m7_figures.by_module()[name], "cortex-m7")
          for name in m7_figures.MODULES),
        Figure("m7.load_percent", "% of 400 MHz", "report", m7_figures.load_percent, "cortex-m7"),
        counted("instructions_worst", "instructions_worst", "instructions", "report"),
        Figure("m7.worst_over_mean", "x", "<= 2", lambda: m7_figures.passes()["instructions_worst"]
               / m7_figures.passes()["instructions"], "cortex-m7"),
        Figure("m7.policy_pass_instructions", "instructions", "<= 40000", lambda: m7_figures.policy_passes()["instructions"], "cortex-m7"),
        Figure("m7.policy_load_percent", "% of 400 MHz", "<= 6",
               lambda: m7_figures.load_percent(m7_figures.policy_passes()["instructions"]), "cortex-m7"),
        Figure("m7.policy_text_bytes", "B", "<= 24000", m7_figures.policy_text_bytes, "cortex-m7"),
        Figure("m7.policy_ram_bytes", "B", "<= 1024", m7_figures.policy_ram_bytes, "cortex-m7"),
        Figure("m7.stack_bytes", "B", "<= 8192", m7_figures.stack_bytes, "cortex-m7"),
        Figure("m7.realtime_factor", "s/s", ">= 1",
               lambda: m7_figures.flights()[0]["realtime_factor"], "cortex-m7"),
        Figure("m7.uart_flights", "flights", ">= 1",
               lambda: float(m7_figures.uart_flight()["success"]), "cortex-m7"),
        by_uart("uart_sent_bytes_per_s", "B/s"),
        by_uart("uart_received_bytes_per_s", "B/s"),
        by_uart("uart_lost", "bytes, frames"),
        *(Figure(f"m7.{name}", unit, "report", lambda name=name: float(m7_figures.uart_flight()["counters"][name]),
                 "cortex-m7") for name, unit in (("longest_pass_us", "us"), ("passes_over_budget", "passes"))),
    ]


# Round trips of offboard commands at 400 Hz to an emulated board and back: the paper's measurement, on its boards.
BOARD_ROUND_TRIPS = [("usb", "usb", "mean_ms", "ms", "<= 0.42"), ("usb", "usb", "max_ms", "ms", "<= 2.4"),
                     ("usb", "usb", "fastest_hz", "Hz", "report"), ("usb", "usb", "idle_fraction", "-", ">= 0.93"), ("uart", "921600", "mean_ms", "ms", "<= 1.4"),
                     ("uart", "921600", "max_ms", "ms", "report"), ("3mbaud", "3000000", "mean_ms", "ms", "<= 0.6")]


# The paper's demonstration of pass-through at 400 Hz. The last row of a board: the firmware's filter without the companion's attitude, as
# in the paper; an accelerometer that shows no lateral force takes 2.0 deg of rms there (bench/passthrough/test).
BOARD_PASSTHROUGH = [("roll_rms_deg", "companion", "roll_rms_deg", "deg", "<= 1.5"), ("lag_ms", "companion", "lag_ms", "ms", "report"),
                     ("roll_estimated_rms_deg", "companion", "roll_estimated_rms_deg", "deg", "report"),
                     ("commands_hz", "companion", "commands_hz", "Hz", ">= 399"),
                     ("roll_rms_deg_without", "firmware", "roll_rms_deg", "deg", "report")]


def h7() -> list[Figure]:
    """The images of the boards with an STM32H7, emulated: sizes, round trips, and default flights; without a board's name, of the Pixracer Pro."""
    def flown(name: str, unit: str, target: str, board: str = h7_figures.BOARD) -> Figure:
        prefix = "" if board == h7_figures.BOARD else f"{board}_"
        return Figure(f"h7.{prefix}{name}", unit, target, lambda: float(h7_figures.flight(board)[name]), "cortex-m7")

    return [
        Figure("h7.text_bytes", "B", "<= 105000", h7_figures.text_bytes, "cortex-m7"),
        Figure("h7.ram_bytes", "B", "<= 96000", h7_figures.ram_bytes, "cortex-m7"),
        Figure("h7.record_bytes", "B", "report", h7_figures.record_bytes, "cortex-m7"),
        Figure("h7.varmint_text_bytes", "B", "<= 105000", lambda: h7_figures.text_bytes("varmint"), "cortex-m7"),
        Figure("h7.varmint_ram_bytes", "B", "<= 96000", lambda: h7_figures.ram_bytes("varmint"), "cortex-m7"),
        *(Figure(f"rtt.{board}_{name}_{quantity}", unit, target,
                 functools.partial(lambda *of, quantity: h7_figures.round_trips(*of)[quantity], board, link, quantity=quantity),
                 "cortex-m7", on_request=True)
          for board in h7_figures.BOARDS for name, link, quantity, unit, target in BOARD_ROUND_TRIPS),
        *(Figure(f"passthrough.{board}_{name}", unit, target,
                 functools.partial(lambda *of, quantity: float(h7_figures.passthrough(*of)[quantity]), board, attitude, quantity=quantity),
                 "cortex-m7", on_request=True)
          for board in h7_figures.BOARDS for name, attitude, quantity, unit, target in BOARD_PASSTHROUGH),
        Figure("h7.realtime_factor", "s/s", ">= 5", h7_figures.realtime_factor, "cortex-m7"),
        Figure("h7.varmint_realtime_factor", "s/s", ">= 5", lambda: h7_figures.realtime_factor("varmint"), "cortex-m7"),
        Figure("h7.driver_coverage", "% of lines", ">= 95", driver_coverage.total, "none", on_request=True),
        Figure("h7.driver_coverage_lowest", "% of lines", "report", driver_coverage.lowest, "none", on_request=True),
        *(Figure(f"h7.{prefix}idle_fraction", "-", ">= 0.93", lambda board=board: float(h7_figures.flight(board, "usb")["idle_fraction"]),
                 "cortex-m7") for prefix, board in (("", h7_figures.BOARD), ("varmint_", "varmint"))),
        flown("stack_bytes", "B", "<= 8192"),
        flown("tracking_rms_m", "m", "report"),
        flown("imu_to_output_us", "us", "<= 120"),
        flown("transfer_to_output_us", "us", "<= 60"),
        flown("transfer_to_output_us", "us", "<= 60", "varmint"),
        flown("stamp_error_us", "us", "<= 2"),
        flown("imu_to_output_us", "us", "<= 400", "varmint"),
        flown("stamp_error_us", "us", "<= 2", "varmint"),
    ]


# How much flights with another engine may differ from those with our integrator.
WORLDS = [("rotors", bench_worlds.ROTORS, 0.05), ("wings", bench_worlds.WINGS, 0.3)]


def worlds() -> list[Figure]:
    """Worst of all flights of an engine: distance of the true positions, attitude, error of tracking and touchdown."""
    def row(name: str, unit: str, target: str, worst: Callable[..., float], *of) -> Figure:
        return Figure(f"worlds.{name}", unit, target, functools.partial(worst, *of), "gazebo", on_request=True)

    figures = [row("failed", "flights", "= 0", bench_worlds.failed)]
    for engine in bench_worlds.ENGINES:
        for group, flown, allowed_m in WORLDS:
            figures += [
                row(f"{engine}_{group}_position_rms_m", "m", f"<= {allowed_m}", bench_worlds.worst, engine, flown, "position_rms_m"),
                row(f"{engine}_{group}_tracking_m", "m", f"<= {allowed_m}", bench_worlds.worst_between, engine, flown, "tracking_rms_m"),
                row(f"{engine}_{group}_attitude_rms_deg", "deg", "<= 1", bench_worlds.worst, engine, flown, "attitude_rms_deg"),
                row(f"{engine}_{group}_touchdown_m_s", "m/s", "<= 0.1", bench_worlds.worst_between, engine, flown, "touchdown_m_s")]
    return figures


def ros_figures() -> list[Figure]:
    """Round trips at 400 Hz over UDP with all streams running, the speed of simulated time, and ten minutes of everything."""
    return [
        Figure("rtt.ros_mean_ms", "ms", "<= 0.4", lambda: round_trip("ROS", "mean")),
        Figure("rtt.ros_max_ms", "ms", "report", lambda: round_trip("ROS", "max")),
        Figure("rtt.ros_max_rate_hz", "Hz", ">= 2000", lambda: round_trip("ROS", "rate_hz", fastest=True)),
        Figure("rtt.ros_over_dds", "-", "<= 1.6", lambda: round_trip("ROS", "median") / round_trip("bare DDS", "median")),
        Figure("rtt.link_mean_ms", "ms", "<= 0.1", lambda: round_trip("bare link", "mean")),
        Figure("rtt.link_p999_ms", "ms", "<= 1.0", lambda: round_trip("bare link", "99.9 %")),
        Figure("rtt.link_max_rate_hz", "Hz", ">= 10000",
               lambda: round_trip("bare link", "rate_hz", fastest=True)),
        Figure("ros.realtime_factor", "s/s", ">= 8", lambda: ros_factor("factor", composed=True)),
        Figure("ros.realtime_factor_processes", "s/s", ">= 1.5", lambda: ros_factor("factor", composed=False)),
        Figure("ros.wakeups_per_step", "-", "report", lambda: ros_factor("wakeups_per_step", composed=True)),
        Figure("ros.wakeups_per_step_processes", "-", "report", lambda: ros_factor("wakeups_per_step", composed=False)),
        Figure("load.missing", "messages", "= 0", lambda: load("missing")),
        Figure("load.sequence_gaps", "frames", "= 0", lambda: load("sequence_gaps")),
        Figure("load.memory_growth_kB", "kB", "< 1024", lambda: load("memory_growth_kB")),
        Figure("load.stamp_error_ms", "ms", "report", lambda: load("stamp_error_ms")["max"]),
    ]
