# SPDX-License-Identifier: BSD-3-Clause
"""./rosflight campaign: the same rows however it is flown, killed and gone on with; reports, comparison, and what it refuses."""

import json
import os
import random
import re
import resource
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from rosflight import campaign
from rosflight.campaign.__main__ import main

ROOT = Path(__file__).resolve().parents[2]
TEXT = textwrap.dedent("""
    flights: 12
    seed: 40
    vehicle: {grid: [multirotor, quad_plus]}
    mission: hop
    wind: {speed_m_s: {uniform: [0, 6]}, from_deg: {uniform: [0, 360]}, w20_m_s: 3}
    set: {body.mass_kg: {normal: [3.5, 0.05]}}
    faults:
      - {fault: motor0_dead, at_s: {uniform: [7, 9]}, probability: 0.3}
    criteria: {tracking_max_m: {at_most: 5}}
    """)


class Command:
    """The command in a folder of its own, which ends with the test, and its workers with it."""

    def __init__(self, folder: Path):
        self.folder = folder
        (folder / "c.yaml").write_text(TEXT)
        self._started: list[subprocess.Popen] = []

    def start(self, *words: object, **options) -> subprocess.Popen:
        process = subprocess.Popen([sys.executable, "-m", "rosflight.campaign", *map(str, words)], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, start_new_session=True, **options)
        self._started.append(process)
        return process

    def run(self, *words: object, **options) -> tuple[int, str, str]:
        process = self.start(*words, **options)
        said, complaint = process.communicate(timeout=400)
        return process.returncode, said, complaint

    def end(self) -> None:
        for process in self._started:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.communicate()


@pytest.fixture
def command(tmp_path):
    made = Command(tmp_path)
    try:
        yield made
    finally:
        made.end()


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """The campaign flown by one worker without an interruption."""
    made = Command(tmp_path_factory.mktemp("whole"))
    try:
        status, said, complaint = made.run("c.yaml", "--workers", 1, "--out", "out", "--worst", 3)
    finally:
        made.end()
    assert (status, complaint) == (0, ""), said + complaint
    return made.folder / "out"


def rows(folder: Path) -> bytes:
    return (folder / "rows.parquet").read_bytes()


def workers_of(pid: int) -> list[int]:
    try:
        return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def end(pid, number):
    """Whether it was still there."""
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        return False
    return True


def test_all_flights_are_there_with_what_they_were_flown_under(whole):
    table = pq.read_table(whole / "rows.parquet").to_pydict()
    assert table["seed"] == list(range(40, 52)) and set(table["vehicle"]) == {"multirotor", "quad_plus"}
    assert table["passed"] == [text == "" for text in table["broken"]]
    failed = [faults for faults, passed in zip(table["faults"], table["passed"]) if not passed]
    assert 0 < len(failed) < 12 and all(faults.startswith("motor0_dead@") for faults in failed)
    assert sorted(path.name for path in whole.iterdir()) == ["campaign.json", "campaign.yaml", "report.html", "rows", "rows.parquet", "worst"]
    assert list((whole / "rows").iterdir()) == []


@pytest.mark.parametrize("count", [2, 3])
def test_the_rows_do_not_depend_on_the_number_of_workers(count, whole, command):
    assert command.run("c.yaml", "--workers", count, "--out", "out", "--no-report")[0] == 0
    assert rows(command.folder / "out") == rows(whole)


def test_a_campaign_that_is_killed_at_random_moments_has_the_same_rows(whole, command):
    """SIGKILL of the campaign with its workers, until it ends by itself. Rows on the disk are never fewer than before."""
    chance, kept, kills = random.Random(19), 0, 0
    while kills < 6:
        process = command.start("c.yaml", "--workers", 2, "--out", "out", "--no-report")
        began = time.monotonic()
        wait_s = chance.uniform(0, 0.07 * (kills + 1))  # a fast machine must not be done before the first
        while process.poll() is None and not (command.folder / "out/rows").exists():
            time.sleep(0.01)  # it imports
        time.sleep(wait_s)
        assert time.monotonic() - began < 400
        if process.poll() is not None:
            break
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        kills += 1
        seeds = [seed for part in (command.folder / "out").glob("**/*.parquet") for seed in pq.read_table(part).column("seed").to_pylist()]
        assert len(set(seeds)) >= kept
        kept = len(set(seeds))
    assert kills > 0
    assert command.run("c.yaml", "--workers", 2, "--out", "out", "--no-report")[0] == 0
    assert rows(command.folder / "out") == rows(whole)


def test_workers_that_are_killed_lose_no_row(whole, command):
    chance, killed = random.Random(4), 0
    process = command.start("c.yaml", "--workers", 2, "--out", "out", "--no-report")
    while process.poll() is None:
        mine = workers_of(process.pid)
        if len(mine) == 2 and killed < 5:
            time.sleep(chance.uniform(0, 0.14 * (killed + 1)))
            killed += end(chance.choice(mine), signal.SIGKILL)
        time.sleep(0.02)
    assert process.returncode == 0 and killed > 0
    assert rows(command.folder / "out") == rows(whole)


def test_a_flight_that_ends_its_worker_again_and_again_ends_the_campaign(command):
    process = command.start("c.yaml", "--workers", 1, "--out", "out")
    while process.poll() is None:
        for pid in workers_of(process.pid):
            end(pid, signal.SIGSEGV)
        time.sleep(0.01)
    assert process.returncode == 2
    assert process.stderr.read() == "rosflight: seed 40: the process that flies it ended 3 times, the last time by signal 11\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_ends_it_with_its_rows_kept(number, whole, command):
    (command.folder / "long.yaml").write_text(TEXT.replace("flights: 12", "flights: 4000"))
    process = command.start("long.yaml", "--workers", 2, "--out", "out")
    while process.poll() is None and not list(command.folder.glob("out/rows/*.parquet")):
        time.sleep(0.01)
    process.send_signal(number)
    _, complaint = process.communicate(timeout=100)
    assert process.returncode == 128 + number
    assert complaint == "rosflight: stopped; the rows are kept, the same command goes on\n"
    kept = campaign.read(command.folder / "out")
    assert 0 < len(kept) < 4000 and len(set(kept["seed"])) == len(kept)
    table = pq.read_table(whole / "rows.parquet").to_pydict()
    first = dict(zip(table["seed"], table["motion_sha256"]))
    assert all(first.get(seed, motion) == motion for seed, motion in zip(kept["seed"], kept["motion_sha256"]))


def test_a_row_is_the_flight_of_its_command(whole, tmp_path):
    """The printed command flies it again by the program: every number of the row, and the log of the report to the bit."""
    table = pq.read_table(whole / "rows.parquet").to_pylist()
    for seed in (int(folder.name) for folder in sorted((whole / "worst").iterdir())[:2]):
        row = table[seed - 40]
        words = shlex.split(row["command"])
        assert words[:2] == ["./rosflight", "fly"]
        done = subprocess.run([ROOT / "build/release/apps/rosflight", *words[1:], "--json", "--out", tmp_path / str(seed)], capture_output=True, text=True)
        summary = json.loads(done.stdout)
        same = {name for name in row if name in summary and name not in ("vehicle", "mission", "faults")}
        assert len(same) >= 16
        none = float("nan")
        assert {name: repr(row[name]) for name in same} == {name: repr(none if summary[name] is None else summary[name]) for name in same}
        assert summary["log_sha256"] == json.loads((whole / f"worst/{seed}/summary.json").read_text())["log_sha256"]


def test_the_report_has_the_interval_and_the_worst_flights(whole):
    page = (whole / "report.html").read_text()
    table = pq.read_table(whole / "rows.parquet").to_pydict()
    passed = sum(table["passed"])
    low, high = campaign.clopper_pearson(passed, 12)
    assert f"{passed} of 12 flights passed: {100 * passed / 12:.2f} %, 95 % confidence {100 * low:.2f} to {100 * high:.2f} %" in page
    worst = [int(seed) for seed in re.findall(r"<h3>Seed (\d+):", page)]
    failed = [seed for seed, good in zip(table["seed"], table["passed"]) if not good]
    assert set(worst[:len(failed)]) == set(failed[:3]) and len(worst) == 3
    assert page.count('alt="path of seed') == 3 and "http" not in re.sub(r'src="data:[^"]*"', "", page)


def test_the_exit_code_is_whether_what_is_required_is_met(command):
    """The lower limit of two of two is 0.025^(1/2). The documents' example meets what it requires."""
    (command.folder / "c.yaml").write_text("flights: 2\nmission: hop\nrequired: {success_rate: 0.9}\n")
    ended, said, _ = command.run("c.yaml", "--no-report")
    assert ended == 1 and "2 of 2 flights passed: 100.00 %, 95 % confidence 15.81 to 100.00 %" in said


def test_a_folder_of_another_campaign_is_refused(whole, command):
    before = {path: path.stat().st_mtime_ns for path in whole.rglob("*")}
    (command.folder / "c.yaml").write_text(TEXT + "# changed\n")
    status, _, complaint = command.run("c.yaml", "--out", whole)
    assert status == 2 and complaint == (f"rosflight: --out: found {whole} with flights of another campaign; allowed the same, or another "
                                         "folder by --out\n")
    other = command.folder / "other"
    other.mkdir()
    (other / "campaign.json").write_text(json.dumps(json.loads((whole / "campaign.json").read_text()) | {"program": "rosflight 1.0"}))
    (command.folder / "c.yaml").write_text(TEXT)
    with pytest.raises(campaign.CampaignError, match="other with flights of rosflight 1.0, allowed rosflight .*; allowed the same, or another folder"):
        campaign.fly(command.folder / "c.yaml", other)
    (command.folder / "mine").mkdir()
    (command.folder / "mine/letter").write_text("kept")
    with pytest.raises(campaign.CampaignError, match="mine with something else in it, allowed a new folder, or one of this campaign"):
        campaign.fly(command.folder / "c.yaml", command.folder / "mine")
    assert before == {path: path.stat().st_mtime_ns for path in whole.rglob("*")}


def test_a_second_process_is_refused(command):
    (command.folder / "long.yaml").write_text(TEXT.replace("flights: 12", "flights: 4000"))
    process = command.start("long.yaml", "--workers", 1, "--out", "out")
    while process.poll() is None and not (command.folder / "out/campaign.json").exists():
        time.sleep(0.01)
    status, _, complaint = command.run("long.yaml", "--out", "out")
    assert (status, complaint) == (2, "rosflight: --out: found out in use by another process, allowed one at a time\n")


def test_a_full_disk_is_one_line_and_the_campaign_goes_on_later(whole, command):
    """A limit of the size of files stands for the disk: no file of rows fits, and none is left in part."""
    status, said, complaint = command.run("c.yaml", "--workers", 1, "--out", "out", "--no-report",
                                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000)))
    assert status == 2 and complaint == "rosflight: out/rows/000001.parquet: File too large; rows on the disk are kept, the same command goes on\n"
    assert list((command.folder / "out/rows").iterdir()) == []
    assert command.run("c.yaml", "--workers", 1, "--out", "out", "--no-report")[0] == 0
    assert rows(command.folder / "out") == rows(whole)


def test_damaged_rows_are_one_line(whole, command):
    out = shutil.copytree(whole, command.folder / "out")
    (out / "rows.parquet").write_bytes(rows(whole)[:500])
    with pytest.raises(campaign.CampaignError, match="rows.parquet: found no whole Parquet file .*; allowed without it") as raised:
        campaign.fly(command.folder / "c.yaml", out)
    assert "\n" not in str(raised.value)


def test_a_worst_flight_that_moves_otherwise_than_its_row_is_one_line(whole, command):
    """Rows of another processor or library, which would not be what the printed command flies."""
    out = shutil.copytree(whole, command.folder / "out", ignore=shutil.ignore_patterns("worst"))
    table = pq.read_table(out / "rows.parquet")
    column = table.column_names.index("motion_sha256")
    pq.write_table(table.set_column(column, "motion_sha256", [["0" * 64] * len(table)]), out / "rows.parquet")
    with pytest.raises(campaign.CampaignError, match=r"^seed \d+: flown again it moves otherwise than in its row"):
        campaign.report(campaign.read(out), worst=1, workers=1)
    assert list((out / "worst").iterdir()) == []


@pytest.mark.parametrize("words, said", [
    ([], "campaign: found neither or both, allowed one of FILE and --compare BEFORE AFTER"),
    (["c.yaml", "--workers", "0"], "--workers: found 0, allowed at least 1"),
    (["c.yaml", "--workers", "2", "--dask", "tcp://x"], "--dask: found with --workers, allowed one of them"),
    (["c.yaml", "--worst", "-1"], "--worst: found -1, allowed at least 0"),
    (["c.yaml", "--worker", "2"], "unrecognized arguments: --worker 2"),
    (["c.yaml", "--metric", "errors"], "--metric: found without --compare, allowed with it"),
    (["--compare", "a", "b", "--worst", "3"], "--worst: found with --compare, allowed without it"),
    (["nothing.yaml"], "nothing.yaml: cannot read it: No such file or directory"),
    (["--compare", "a", "b"], "a: found no campaign, allowed a folder with campaign.json"),
])
def test_bad_options_are_one_line(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        assert main(words) == 2
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    assert capsys.readouterr() == ("", f"rosflight: {said}\n") and list(tmp_path.iterdir()) == []


def test_a_scheduler_that_does_not_answer_is_one_line_and_nothing_is_written(command):
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{closed.getsockname()[1]}"
        status, _, complaint = command.run("c.yaml", "--dask", address, "--out", "out")
    assert status == 2 and complaint.startswith(f"rosflight: --dask: found no scheduler at '{address}'") and complaint.count("\n") == 1
    assert not (command.folder / "out").exists()


def test_two_campaigns_compared(whole, command):
    """A vehicle whose motor is weaker in all flights is worse; the campaign beside itself is not."""
    status, said, complaint = command.run("--compare", whole, whole, "--metric", "tracking_rms_m", "--out", "same.html")
    assert status == 0 and "after the change: no difference shown" in said, complaint
    (command.folder / "c.yaml").write_text(TEXT.replace("probability: 0.3", "probability: 1"))
    assert command.run("c.yaml", "--out", "out", "--no-report")[0] == 0
    status, said, complaint = command.run("--compare", whole, "out")
    failed = 12 - campaign.read(whole).passed
    assert status == 1 and f"passed {12 - failed} before and 0 after, of 12; {12 - failed} failed that had passed" in said, said + complaint
    assert f"p {2 / 2**(12 - failed):.3g}" in said and "conditions differ: faults in" in said and "after the change: worse" in said
    assert "Failed that had passed" in (command.folder / "out/compared.html").read_text()


def documented() -> list[str]:
    texts = [(ROOT / name).read_text() for name in ("docs/campaigns.md", "python/examples/README.md")]
    lines = {line for text in texts for line in re.findall(r"(?:^    |`)(\./rosflight campaign [^`\n]+)", text, re.M)}
    return sorted(line for line in lines if not re.search(r"\b[A-Z]{3,}\b", line))


@pytest.mark.parametrize("line", documented())
def test_commands_of_the_documents_run(line, command):
    words = [str(ROOT / word) if word.startswith("python/") else word for word in shlex.split(line)[2:]]
    status, said, complaint = command.run(*words)
    assert status == 0 and complaint == "", said + complaint
    assert list(command.folder.glob("campaigns/gusts-*/report.html"))


def test_the_help_has_the_options():
    text = (ROOT / "apps/help/campaign.txt").read_text()
    source = (ROOT / "python/rosflight/campaign/__main__.py").read_text()
    options = set(re.findall(r'add_argument\("(--[a-z-]+)"', source))
    assert options == set(re.findall(r"^  (--[a-z-]+)", text, re.M)) and len(options) > 6
