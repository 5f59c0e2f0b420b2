"""Workers die, and nothing is lost or counted twice."""

import os
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from discretize import CellMap
from geomsim import GeomsimError, Random, Stationary, Timing
from geomsim.trials import dask_executor, run_trials
from geomsim.trials.workforce import Workforce

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill -9 here")


def square(number: int) -> int:
    return number * number


def square_or_die(number: int, folder: str) -> int:
    """Die the first time that the number 3 comes."""
    mark = Path(folder) / "died"
    if number == 3 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def die(_: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return 0


@pytest.mark.parametrize("workers", [1, 3])
def test_every_task_is_done_once(workers: int) -> None:
    with Workforce(workers=workers) as workforce:
        for count in (0, 1, 50):
            done = workforce.do(square, [(n,) for n in range(count)])
            assert sorted(done) == [n * n for n in range(count)]


def test_a_worker_that_dies_is_replaced(tmp_path: Path) -> None:
    with Workforce(workers=2) as workforce:
        done = list(workforce.do(square_or_die, [(n, str(tmp_path)) for n in range(30)]))
    assert (tmp_path / "died").exists()
    assert sorted(done) == [n * n for n in range(30)]


def test_workers_that_keep_dying_are_given_up() -> None:
    with Workforce(workers=2) as workforce, pytest.raises(GeomsimError, match="workers died"):
        list(workforce.do(die, [(1,), (2,)]))


def test_an_executor_of_the_caller_stays_open() -> None:
    with ThreadPoolExecutor(1) as pool:
        with Workforce(pool) as workforce:
            assert list(workforce.do(square, [(4,)])) == [16]
        assert pool.submit(square, 3).result() == 9


def test_an_error_is_not_hidden() -> None:
    with Workforce(workers=2) as workforce, pytest.raises(TypeError):
        list(workforce.do(square, [("x",)]))


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense::"])
def test_an_address_at_which_nobody_answers(address: str) -> None:
    pytest.importorskip("distributed")
    expected = pytest.raises(GeomsimError, match=f"No Dask scheduler answers at {address!r}")
    with expected, dask_executor(address, timeout=1.0):
        pass


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_cluster_of_which_a_process_is_killed(house: CellMap) -> None:
    """Two processes, one killed in mid-run: the same table as here."""
    distributed = pytest.importorskip("distributed")
    options = {"cells": house, "trials": 200, "timing": Timing(limit=900.0), "capture": "cell"}
    methods = {"still": Stationary(), "random": Random()}
    here = run_trials(house.plan, methods, workers=1, **options)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        victim = next(iter(cluster.workers.values())).pid
        killed: list[float] = []

        def kill() -> None:
            killed.append(time.monotonic())
            os.kill(victim, signal.SIGKILL)

        def progress(name: str, done: int, total: int) -> None:
            if 0 < done < total and not killed:
                kill()

        with dask_executor(cluster.scheduler_address) as executor:
            there = run_trials(house.plan, methods, executor=executor, workers=4, progress=progress, **options)
    assert killed
    assert there.rows == here.rows
