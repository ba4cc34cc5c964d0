# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns on a Dask cluster: the rows of one machine, with workers killed, the scheduler restarted, and workers that cannot fly."""

import importlib.util
import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from rosflight import _worker, campaign
from rosflight.campaign import _cluster
from rosflight.campaign._tasks import Flight

ENDURANCE = Path(__file__).resolve().parents[2] / "bench/cluster.py"
TEXT = "flights: 24\nmission: hop\nwind: {speed_m_s: {uniform: [0, 6]}}\nfaults: [{fault: motor0_dead, at_s: 8, probability: 0.2}]\n"


class Processes:
    """Scheduler and workers of a cluster on this machine; they end with the test."""

    def __init__(self, folder: Path):
        self._folder = folder
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.started: list[subprocess.Popen] = []

    def _start(self, *words: str) -> subprocess.Popen:
        process = subprocess.Popen([sys.executable, "-m", *words], cwd=self._folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   start_new_session=True)
        self.started.append(process)
        return process

    def scheduler(self) -> subprocess.Popen:
        return self._start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard")

    def worker(self) -> subprocess.Popen:
        return self._start("distributed.cli.dask_worker", self.address, "--nthreads", "1", "--no-dashboard", "--no-nanny", "--death-timeout", "60")

    def end(self) -> None:
        for process in self.started:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()


@pytest.fixture
def processes(tmp_path):
    made = Processes(tmp_path)
    try:
        yield made
    finally:
        made.end()


def wait_for(address: str) -> None:
    until = time.monotonic() + 60
    while True:
        try:
            _cluster.Cluster(address).close()
            return
        except campaign.CampaignError:
            assert time.monotonic() < until
            time.sleep(0.2)


def test_killed_workers_and_a_restarted_scheduler_lose_no_row(processes, tmp_path):
    (tmp_path / "c.yaml").write_text(TEXT)
    alone = campaign.fly(tmp_path / "c.yaml", tmp_path / "alone", workers=2)
    schedulers = [processes.scheduler()]
    workers = [processes.worker(), processes.worker()]
    wait_for(processes.address)

    def break_it(done: int, wanted: int) -> None:
        if done in (4, 14):
            workers.pop(0).kill()
            workers.append(processes.worker())
        elif done == 9:
            schedulers.pop().kill()
            schedulers.append(processes.scheduler())
            for worker in workers:  # they lose their scheduler, and others take their place
                worker.kill()
            workers[:] = [processes.worker(), processes.worker()]

    together = campaign.fly(tmp_path / "c.yaml", tmp_path / "together", dask=processes.address, progress=break_it)
    assert len(together) == 24
    assert (tmp_path / "together/rows.parquet").read_bytes() == (tmp_path / "alone/rows.parquet").read_bytes()
    assert alone.passed == together.passed


def test_no_workers_and_workers_with_another_program_are_one_line(processes, tmp_path, monkeypatch):
    (tmp_path / "c.yaml").write_text(TEXT)
    processes.scheduler()
    wait_for(processes.address)
    monkeypatch.setattr(_cluster, "NO_WORKER_S", 0.5)
    with pytest.raises(campaign.CampaignError, match="--dask: found a scheduler without workers for 0.5 s, allowed at least one worker"):
        campaign.fly(tmp_path / "c.yaml", tmp_path / "out", dask=processes.address)
    monkeypatch.setattr(_cluster, "NO_WORKER_S", 60.0)
    monkeypatch.setattr(_worker, "program", lambda: "rosflight 9, commit 0")
    processes.worker()
    with pytest.raises(campaign.CampaignError, match="found a worker that cannot fly this .it has rosflight .*, the campaign rosflight 9, commit 0"):
        campaign.fly(tmp_path / "c.yaml", tmp_path / "other", dask=processes.address)
    assert not list(tmp_path.glob("o*/**/*.parquet"))


class Ended(SimpleNamespace):
    """A future of Dask that has ended."""

    def result(self, timeout):
        return self.answer

    def exception(self):
        return self.error


def test_a_task_takes_half_a_second_and_a_failure_is_blamed_on_a_flight_that_was_alone():
    cluster = object.__new__(_cluster.Cluster)
    cluster._distributed = SimpleNamespace(CancelledError=KeyError)
    for took_s, flown, size in ((0.8, 8, 5), (1e-9, 1, 64), (7.0, 4, 1)):
        answers = [{"result": {"k": k}} for k in range(flown)]
        ended = Ended(status="finished", answer=(took_s, answers))
        assert list(cluster._results(ended, [Flight(k, {}) for k in range(flown)])) == [answer["result"] for answer in answers]
        assert cluster._size == size
    killed = Ended(status="error", error=RuntimeError("its worker died"))
    together, alone = [Flight(1, {}), Flight(2, {})], [Flight(3, {})]
    for _ in range(5):
        assert list(cluster._results(killed, together)) == [None, None]
    assert [list(cluster._results(killed, alone)) for _ in range(2)] == [[None], [None]]
    with pytest.raises(campaign.CampaignError, match="seed 3: failed 3 times on the cluster: its worker died"):
        cluster._results(killed, alone)


def test_a_refused_flight_keeps_the_rows_before_it():
    cluster = object.__new__(_cluster.Cluster)
    ended = Ended(status="finished", answer=(0.1, [{"result": {"k": 0}}, {"refused": "wind: found 99"}]))
    results = iter(cluster._results(ended, [Flight(7, {}), Flight(8, {})]))
    assert next(results) == {"k": 0}
    with pytest.raises(campaign.CampaignError, match="seed 8: wind: found 99"):
        next(results)


def test_the_endurance_of_a_cluster_counts_what_is_lost_and_double():
    spec = importlib.util.spec_from_file_location("endurance", ENDURANCE)
    program = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(program)
    assert program.lost_and_double([1, 2, 2, 5], 5) == (2, 1)
    assert program.lost_and_double([3, 1, 2], 3) == (0, 0)
    done = subprocess.run([sys.executable, ENDURANCE, "endurance", "60", "--every", "0.5", "--kills", "2"], capture_output=True, text=True)
    found = json.loads(done.stdout)
    assert found.items() >= {"flights": 60, "rows_lost": 0, "rows_double": 0, "rows_differing": 0}.items() and found["rows_kills"] >= 1
    assert subprocess.run([sys.executable, ENDURANCE, "endurance", "0"], capture_output=True).returncode == 2
