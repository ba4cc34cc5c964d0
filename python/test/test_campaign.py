# SPDX-License-Identifier: BSD-3-Clause
"""rosflight.campaign: what a file stands for, its draws and statistics against numbers from outside, and bad input."""

import re
import subprocess
import sys
import textwrap
from importlib import metadata
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import rosflight
from rosflight import campaign
from rosflight.campaign import _compare, _draws, _statistics
from rosflight.campaign._configuration import Configuration
from scipy import stats
from scipy.stats import qmc


def configuration(folder: Path, text: str) -> Configuration:
    file = folder / "campaign.yaml"
    file.write_text(textwrap.dedent(text))
    return Configuration(file)


@pytest.mark.parametrize("missing", ["pyarrow", "scipy", "yaml"])
def test_without_its_libraries_the_package_is_imported_and_campaigns_are_one_line(missing):
    script = f"""
import sys
sys.modules[{missing!r}] = None
import rosflight
try:
    import rosflight.campaign
except ImportError as error:
    print(error)
"""
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert said.stdout == f"rosflight.campaign: found no {missing}, allowed with pip install '.[campaign]'\n", said.stderr


def test_a_plain_install_needs_numpy_alone():
    needed = [line for line in metadata.requires("rosflight") or [] if "extra ==" not in line]
    assert [re.match(r"\w+", line)[0] for line in needed] == ["numpy"]


# ---- statistics ----


@pytest.mark.parametrize("passed, flights, low, high", [
    # Tables of exact 95 % limits, as Clopper and Pearson's charts and most textbooks have them.
    (0, 10, 0.0, 0.3085), (1, 20, 0.0013, 0.2487), (5, 10, 0.1871, 0.8129), (8, 10, 0.4439, 0.9748), (10, 20, 0.2720, 0.7280),
    (10, 10, 0.6915, 1.0)])
def test_clopper_pearson_against_the_tables(passed, flights, low, high):
    assert campaign.clopper_pearson(passed, flights) == pytest.approx((low, high), abs=5e-5)


@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.99])
def test_clopper_pearson_is_where_the_binomial_tails_have_half_of_the_rest(confidence):
    low, high = campaign.clopper_pearson(37, 40, confidence)
    assert stats.binom.sf(36, 40, low) == pytest.approx((1 - confidence) / 2)
    assert stats.binom.cdf(37, 40, high) == pytest.approx((1 - confidence) / 2)
    assert campaign.clopper_pearson(0, 40, confidence)[1] == pytest.approx(1 - ((1 - confidence) / 2)**(1 / 40))


@pytest.mark.parametrize("worse, better, p", [
    # 2 (1 + 10 + 45) / 2^10, 2 / 2^9, 2 / 2^6, 2 / 2^5, and an even division.
    (8, 2, 0.109375), (0, 9, 0.00390625), (6, 0, 0.03125), (5, 0, 0.0625), (4, 4, 1.0), (0, 0, 1.0)])
def test_mcnemar_by_hand(worse, better, p):
    before = np.array([True] * worse + [False] * better + [True] * 7 + [False] * 3)
    after = np.array([False] * worse + [True] * better + [True] * 7 + [False] * 3)
    found = _statistics.mcnemar(before, after)
    assert (found.worse, found.better) == (worse, better) and found.p == pytest.approx(p)


def test_the_sign_test_leaves_out_what_is_equal_or_missing():
    nan = float("nan")
    found = _statistics.sign_test(np.array([1, 2, 3, nan, 5, 6]), np.array([2, 3, 3, 1, nan, 5]))
    assert (found.worse, found.better, found.p) == (2, 1, 1.0)


class Rows:
    """A campaign of two columns."""

    folder = Path("rows")
    configuration = SimpleNamespace(required=SimpleNamespace(confidence=0.95))

    def __init__(self, **columns):
        self._columns = {name: np.array(values) for name, values in columns.items()}
        self.table = self

    column_names = ["seed", "passed", "tracking_rms_m"]

    def __getitem__(self, name):
        return self._columns[name]


@pytest.mark.parametrize("failed_after, verdict", [(5, "no difference shown"), (6, "worse"), (9, "worse")])
def test_the_verdict_changes_where_the_hand_calculation_says(failed_after, verdict):
    """Five flights that fail now: p = 1/16; six: 1/32, below 0.05."""
    before = Rows(seed=range(30), passed=[True] * 30)
    after = Rows(seed=range(10, 40), passed=[False] * failed_after + [True] * (30 - failed_after))
    found = _compare.compare(before, after)
    assert list(found.seeds) == list(range(10, 30)) and found.verdict == verdict
    assert _compare.compare(after, before).verdict == ("better" if verdict == "worse" else verdict)


def test_the_level_is_shared_by_the_tests():
    """p = 1/32 is shown at 0.05 alone, and not beside a second test."""
    numbers = {"tracking_rms_m": np.ones(30)}
    before, after = Rows(seed=range(30), passed=[True] * 30, **numbers), Rows(seed=range(30), passed=[False] * 6 + [True] * 24, **numbers)
    assert _compare.compare(before, after).verdict == "worse"
    assert _compare.compare(before, after, ("tracking_rms_m",)).verdict == "no difference shown"


def test_a_number_that_grows_is_worse():
    before = Rows(seed=range(8), passed=[True] * 8, tracking_rms_m=np.arange(8) / 10)
    after = Rows(seed=range(8), passed=[True] * 8, tracking_rms_m=np.arange(8) / 10 + 0.1)
    found = _compare.compare(before, after, ("tracking_rms_m",))
    assert found.verdict == "worse" and found.tests[1].median_change == pytest.approx(0.1)
    assert found.tests[1].paired.p == pytest.approx(2 / 2**8)


# ---- pictures ----


def test_the_picture_of_success_has_the_intervals():
    some = Rows(seed=range(20), passed=[True] * 8 + [False] * 2 + [True] * 10, vehicle=["a"] * 10 + ["b"] * 10)
    axes = rosflight.plot.success(some, "vehicle").axes[0]
    ends = [bar.get_segments()[0][:, 1] for bar in axes.collections]
    assert np.allclose(ends, 100 * np.array([campaign.clopper_pearson(8, 10), campaign.clopper_pearson(10, 10)]))
    assert [text.get_text() for text in axes.get_xticklabels()] == ["a", "b"]


def test_faults_are_shown_by_their_names():
    some = Rows(seed=range(3), passed=[True] * 3, faults=["baro@3.25:5 mag@1", "baro_step=2@8", ""])
    axes = rosflight.plot.success(some, "faults").axes[0]
    assert sorted(text.get_text() for text in axes.get_xticklabels()) == ["baro mag", "baro_step", "none"]


def test_the_picture_of_a_number_has_every_flight_that_has_it():
    some = Rows(seed=range(6), passed=[True] * 4 + [False] * 2, tracking_rms_m=[0.1, 0.2, 0.3, 0.4, 2.0, float("nan")])
    axes = rosflight.plot.distribution(some, "tracking_rms_m").axes[0]
    assert sum(patch.get_height() for patch in axes.patches) == 5
    assert [line.get_xdata()[0] for line in axes.lines] == pytest.approx(list(np.quantile([0.1, 0.2, 0.3, 0.4, 2.0], (0.05, 0.5, 0.95))))


def test_pairs_are_of_equal_seeds():
    before = Rows(seed=[1, 2, 3], passed=[True] * 3, tracking_rms_m=[0.1, 0.2, 0.3])
    after = Rows(seed=[3, 2, 9], passed=[True] * 3, tracking_rms_m=[0.5, 0.4, 0.9])
    was, now = rosflight.plot.paired(before, after, "tracking_rms_m").axes[0].lines[0].get_data()
    assert list(was) == [0.2, 0.3] and list(now) == [0.4, 0.5]


# ---- draws ----


def test_sobol_is_that_of_scipy(tmp_path):
    found = configuration(tmp_path, """
        flights: 16
        seed: 5
        wind: {speed_m_s: {sobol: [2, 6]}, from_deg: {sobol: [0, 360]}}
        """)
    points = qmc.scale(qmc.Sobol(2, scramble=True, rng=5).random_base2(4), [2, 0], [6, 360])
    assert np.allclose(np.transpose([found.values["wind.speed_m_s"], found.values["wind.from_deg"]]), points, rtol=1e-15)
    # Its defining property: each interval of a sixteenth has one point.
    assert sorted(np.floor((points[:, 0] - 2) * 4).astype(int)) == list(range(16))


def test_more_dimensions_than_sobol_has_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(_draws, "MAX_SOBOL", 1)
    with pytest.raises(campaign.CampaignError, match=r"campaign.yaml:2: wind.from_deg: found 2 values from sobol, allowed 1$"):
        configuration(tmp_path, "flights: 1\nwind: {speed_m_s: {sobol: [2, 6]}, from_deg: {sobol: [0, 360]}}")


def test_the_limit_of_dimensions_is_that_of_scipy():
    assert qmc.Sobol.MAXDIM == _draws.MAX_SOBOL


def test_a_draw_is_uniform_and_independent_of_the_next():
    u = np.array([_draws.unit("wind.speed_m_s", seed) for seed in range(4000)])
    other = np.array([_draws.unit("wind.from_deg", seed) for seed in range(4000)])
    assert stats.kstest(u, "uniform").pvalue > 0.01
    assert stats.kstest((u[1:] - u[:-1]) % 1, "uniform").pvalue > 0.01 and stats.kstest((u - other) % 1, "uniform").pvalue > 0.01


@pytest.mark.parametrize("u", [1e-12, 0.01, 0.3, 0.5, 0.99, 1 - 1e-12])
def test_normal_is_that_of_scipy(u):
    assert _draws.Normal(3, 0.5).at(u) == pytest.approx(stats.norm.ppf(u, 3, 0.5))
    assert _draws.Normal(3, 0.5, 2.9, 4).at(u) == pytest.approx(stats.truncnorm.ppf(u, -0.2, 2, 3, 0.5), rel=1e-9)


def test_choice_has_its_weights():
    choice = _draws.Choice(("a", "b", "c"), (1.0, 0.0, 3.0))
    drawn = [choice.at(_draws.unit("x", seed)) for seed in range(4000)]
    assert "b" not in drawn and stats.binomtest(drawn.count("c"), 4000, 0.75).pvalue > 0.01


def test_grids_have_every_combination_equally_often(tmp_path):
    found = configuration(tmp_path, """
        flights: 12
        vehicle: {grid: [multirotor, quad_plus]}
        mission: hop
        wind: {speed_m_s: {grid: [0, 3, 6]}}
        """)
    pairs = list(zip(found.values["vehicle"], found.values["wind.speed_m_s"]))
    assert {pair: pairs.count(pair) for pair in pairs} == {(v, s): 2 for v in ("multirotor", "quad_plus") for s in (0.0, 3.0, 6.0)}


def test_a_flight_depends_on_its_seed_alone(tmp_path):
    """Not on how many there are, not on the first seed, and its other draws not on keys that are added."""
    text = "flights: {}\nseed: {}\nwind: {{speed_m_s: {{uniform: [0, 8]}}}}\n"
    added = "set: {body.mass_kg: {normal: [3.5, 0.1]}}\nfaults: [{fault: baro, at_s: {uniform: [5, 9]}, probability: 0.5}]\n"
    few, many, late = (configuration(tmp_path, text.format(*numbers)) for numbers in ((4, 1), (400, 1), (2, 3)))
    more = configuration(tmp_path, text.format(4, 1) + added)
    assert few.arguments(3) == many.arguments(3) == late.arguments(3)
    assert more.arguments(3)["wind"] == few.arguments(3)["wind"] and more.arguments(3)["set"]


def test_faults_come_with_their_probability(tmp_path):
    found = configuration(tmp_path, "flights: 2000\nfaults: [{fault: baro, at_s: 9, for_s: 2, probability: 0.3}, {fault: mag, at_s: 5}]")
    texts = [tuple(found.arguments(seed)["faults"]) for seed in found.seeds]
    assert set(texts) == {("mag@5",), ("baro@9:2", "mag@5")}
    assert stats.binomtest(texts.count(("baro@9:2", "mag@5")), 2000, 0.3).pvalue > 0.01


# ---- bad input ----


@pytest.mark.parametrize("text, said", [
    ("", ": found nothing, allowed a map"),
    ("flights", ":1: found 'flights', allowed a map"),
    ("vehicle: multirotor", ":1: found no key 'flights', which is required"),
    ("flights: 0", ":1: flights: found '0', allowed a whole number from 1 to 10000000"),
    ("flights: -3", ":1: flights: found '-3', allowed a whole number"),
    ("flights: '8'", ":1: flights: found '8', allowed a whole number"),
    ("flights: 1.5", ":1: flights: found '1.5', allowed a whole number"),
    ("flights: 8\nflight: 3", ":2: found the key 'flight', allowed flights, seed, vehicle,"),
    ("flights: 8\nflights: 9", ":2: found the key 'flights' twice, allowed once"),
    ("flights: 8\nseed: -1", ":2: seed: found '-1', allowed a whole number from 0"),
    ("flights: 8\nvehicle: plane9", ":2: vehicle: found plane9, allowed aerosonde, anaconda,"),
    ("flights: 8\nvehicle: 7", ":2: vehicle: found 7, allowed aerosonde"),
    ("flights: 8\nvehicle: [multirotor]", ":2: vehicle: found a list of 1, allowed a text"),
    ("flights: 8\nvehicle: {uniform: [1, 2]}", ":2: vehicle.uniform: found uniform, allowed choice, grid"),
    ("flights: 8\nvehicle: {choice: []}", ":2: vehicle.choice: found an empty list, allowed at least one element"),
    ("flights: 8\nmission: nowhere", ":2: mission: found 'nowhere', allowed a file or circuit,"),
    ("flights: 8\nvehicle:\n  choice: [multirotor, x]", ":3: vehicle: found x, allowed aerosonde"),
    ("flights: 8\nmission: {choice: [hop, fixedwing]}", "this mission is for a fixed wing, the vehicle is a multirotor"),
    ("flights: 8\nwind: 5", ":2: wind: found '5', allowed a map"),
    ("flights: 8\nwind: {from_deg: 3}", ":2: wind: found no key 'speed_m_s', which is required"),
    ("flights: 8\nwind: {speed_m_s: {uniform: [0, 80]}}", ":2: wind.speed_m_s: found '"),
    ("flights: 8\nwind: {speed_m_s: {uniform: [8, 0]}}", "speed_m_s.uniform: found [8, 0], allowed [LOW, HIGH] with LOW below HIGH"),
    ("flights: 8\nwind: {speed_m_s: {uniform: [0]}}", "speed_m_s.uniform: found a list of 1, allowed [LOW, HIGH]"),
    ("flights: 8\nwind: {speed_m_s: {uniform: [0, .nan]}}", "speed_m_s.uniform[1]: found '.nan', allowed a number"),
    ("flights: 8\nwind: {speed_m_s: {uniform: [0, nan]}}", "speed_m_s.uniform[1]: found 'nan', allowed a number"),
    ("flights: 8\nwind: {speed_m_s: {}}", "found no distribution, allowed one of uniform, normal, choice, grid, sobol"),
    ("flights: 8\nwind: {speed_m_s: {uniform: [0, 1], grid: [1]}}", "found uniform and grid, allowed one of"),
    ("flights: 8\nwind: {speed_m_s: {normal: [3, 0]}}", "found the standard deviation 0, allowed above 0"),
    ("flights: 8\nwind: {speed_m_s: {normal: [3, 1], within: [90, 91]}}", "less than 1e-6 of its probability"),
    ("flights: 8\nwind: {speed_m_s: {uniform: [3, 4], within: [3, 4]}}", "within: found with uniform, allowed with normal"),
    ("flights: 8\nwind: {speed_m_s: {choice: [3, 4], weights: [1]}}", "weights: found 1 of sum 1, allowed 2 of a sum above 0"),
    ("flights: 8\nwind: {speed_m_s: {choice: [3, 4], weights: [1, -1]}}", "weights[1]: found '-1', allowed a number from 0"),
    ("flights: 8\nwind: {speed_m_s: {grid: [1, 1]}}", "found a value twice, allowed each once"),
    ("flights: 8\nwind: {speed_m_s: {grid: [1, 2, 3]}}", ":1: flights: found '8', allowed a multiple of 3, the combinations of the grids"),
    ("flights: 8\nset: {body.mas: 3}", ":2: set.body.mas: found an unknown key, allowed mass_kg,"),
    ("flights: 8\nset:\n  body.mass_kg: {normal: [0.1, 1]}", ":3: set.body.mass_kg: found -"),
    ("flights: 8\nset: {body.mass_kg: light}", ":2: set.body.mass_kg: found light"),
    ("flights: 8\nfaults: []", ":2: faults: found an empty list"),
    ("flights: 8\nfaults: [{fault: baro}]", ":2: faults[0]: found no key 'at_s', which is required"),
    ("flights: 8\nfaults: [{fault: wings, at_s: 3}]", ":2: faults[0].fault: found \"wings\", allowed imu, mag, baro"),
    ("flights: 8\nfaults: [{fault: baro, at_s: 3, probability: -0.1}]", "faults[0].probability: found '-0.1', allowed a number from 0 to 1"),
    ("flights: 8\nfaults: [{fault: baro, at_s: 3, probability: 1.1}]", "faults[0].probability: found '1.1', allowed a number from 0 to 1"),
    ("flights: 8\nfaults: [{fault: motor7_dead, at_s: 3}]", "faults[0].fault: found motor 7, allowed 0 to 3"),
    ("flights: 8\nstate: guess", ":2: state: found 'guess', allowed estimate, truth"),
    ("flights: 8\ncriteria: {speed: {at_most: 3}}", ":2: criteria: found the key 'speed', allowed outcome, waypoints_reached,"),
    ("flights: 8\ncriteria: {tracking_rms_m: 3}", ":2: criteria.tracking_rms_m: found '3', allowed a map"),
    ("flights: 8\ncriteria: {tracking_rms_m: {}}", "found no limit, allowed at_least, at_most"),
    ("flights: 8\ncriteria: {tracking_rms_m: {at_least: 3, at_most: 2}}", "found at_least 3 above at_most 2"),
    ("flights: 8\ncriteria: {outcome: interrupted}", "criteria.outcome: found 'interrupted', allowed mission_done, landed_elsewhere"),
    ("flights: 8\nrequired: {success_rate: 2}", "required.success_rate: found '2', allowed a number from 0 to 1"),
    ("flights: 8\nworst_by: looks", ":2: worst_by: found 'looks', allowed waypoints_reached"),
    ("flights: [", ":1: found "),
    ("flights: 8\n? [a]\n: 1", ":2: found a list of 1, allowed a name as key"),
])
def test_bad_input_is_one_line_and_nothing_is_written(text, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.yaml").write_text(text)
    with pytest.raises(campaign.CampaignError) as raised:
        campaign.fly("bad.yaml")
    assert str(raised.value).startswith("bad.yaml") and said in str(raised.value) and "\n" not in str(raised.value)
    assert [path.name for path in tmp_path.iterdir()] == ["bad.yaml"]
