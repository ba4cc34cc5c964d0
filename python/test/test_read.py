# SPDX-License-Identifier: BSD-3-Clause
"""rosflight.read and rosflight.plot: the log of a flight as arrays and pictures."""

import numpy as np
import pytest
import rosflight


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    return rosflight.fly(mission="hop", seed=7, out=tmp_path_factory.mktemp("flight") / "hop")


def test_topics_are_arrays_by_field(flight):
    log = rosflight.read(flight.folder)
    assert log.summary["seed"] == 7 and "/imu/data" in log and len(log) > 30
    imu = log["/imu/data"]
    assert np.diff(imu.t_s) == pytest.approx(0.0025, abs=2e-3)
    assert np.median(imu["linear_acceleration.z"]) == pytest.approx(-9.80665, abs=0.2)
    assert log["/autonomy/estimate"]["position"].shape[1] == 3


def test_the_log_and_the_series_of_a_flight_agree(flight):
    truth = rosflight.read(flight.folder / "flight.mcap")["/sim/truth_state"]
    for axis, name in enumerate("xyz"):
        series = np.interp(truth.t_s, flight.series["t_s"], flight.series["position_m"][:, axis])
        assert truth[f"pose.position.{name}"] == pytest.approx(series, abs=0.05)


def test_a_topic_is_a_table_of_pandas(flight):
    table = rosflight.read(flight.folder)["/autonomy/estimate"].to_pandas()
    assert table.index.name == "t_s" and {"position[0]", "innovation[8]", "course"} <= set(table.columns)


def test_what_is_not_there_is_one_line(flight, tmp_path):
    log = rosflight.read(flight.folder)
    with pytest.raises(KeyError, match="/imu/date: not in .*flight.mcap, which has /"):
        log["/imu/date"]
    with pytest.raises(FileNotFoundError, match="found no log, allowed a flight folder or an MCAP file"):
        rosflight.read(tmp_path)
    with pytest.raises(FileNotFoundError):
        rosflight.read(tmp_path / "nothing.mcap")


@pytest.mark.parametrize("spoil", [lambda b: b"no log at all", lambda b: b[: len(b) // 2], lambda b: b"",
                                   lambda b: b[:len(b) // 3] + bytes(2000) + b[len(b) // 3 + 2000:]])
def test_a_damaged_log_is_one_line(spoil, flight, tmp_path):
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(spoil((flight.folder / "flight.mcap").read_bytes()))
    with pytest.raises(ValueError, match="cannot read the log, it is damaged or not MCAP") as raised:
        log = rosflight.read(damaged)
        for topic in log:
            log[topic]
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("name", ["path", "tracking", "attitude", "innovations"])
def test_pictures(name, flight, tmp_path):
    figure = getattr(rosflight.plot, name)(flight)
    figure.savefig(tmp_path / f"{name}.png")
    assert (tmp_path / f"{name}.png").read_bytes()[:4] == b"\x89PNG"
    assert all(len(axis.lines) > 0 for axis in figure.axes)


def test_the_picture_of_tracking_shows_the_error_of_the_summary(flight):
    distance = rosflight.plot.tracking(rosflight.read(flight.folder)).axes[1].lines[0].get_ydata()
    # On the whole way, take-off and landing included, at 50 Hz: at least what the score has for the path alone.
    assert np.nanmax(distance) >= 0.8 * flight.tracking_max_m


def test_a_flight_without_a_log_has_no_pictures():
    with pytest.raises(ValueError, match="plot: found a flight without a log"):
        rosflight.plot.path(rosflight.fly(mission="hop", log="none"))
