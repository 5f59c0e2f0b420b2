"""Who does the work: this process, a pool of processes, or any executor, a Dask cluster's for instance."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from typing import Any, TypeVar

from maps import GeomsimError

__all__ = ["Workforce", "dask_executor"]

_T = TypeVar("_T")

#: a pool whose processes die so often in a row, without one task done, is given up
_PATIENCE = 3


class Workforce:
    """Does tasks that depend on nothing but their arguments, in any order.

    Parameters
    ----------
    executor : Executor, optional
        Any; it is the caller's and stays open. Without it a pool of processes, or this process if there is but one
        worker.
    workers : int, optional
        Size of the pool; by default as many as there are cores for this process.

    Raises
    ------
    GeomsimError
        If there is to be less than one worker.
    """

    def __init__(self, executor: Executor | None = None, workers: int | None = None) -> None:
        if workers is not None and workers < 1:
            raise GeomsimError(f"There must be at least one worker, but {workers} were asked for.")
        self.workers = workers or _cores()
        self._theirs = executor
        self._pool: ProcessPoolExecutor | None = None

    def __enter__(self) -> Workforce:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if self._pool is not None:
            _close(self._pool, at_once=kind is not None)

    def do(self, function: Callable[..., _T], tasks: Sequence[tuple[Any, ...]]) -> Iterator[_T]:
        """Yield ``function(*task)`` for each task as it is done.

        A worker that dies is replaced and what it had not finished is done again; each result comes once.

        Raises
        ------
        GeomsimError
            If workers keep dying.
        """
        if self._theirs is None and self.workers == 1:
            for task in tasks:
                yield function(*task)
            return
        left, failures = dict(enumerate(tasks)), 0
        while left:
            try:
                executor = self._executor()
                futures: dict[Future[_T], int] = {}
                for number, task in left.items():
                    futures[executor.submit(function, *task)] = number
                for future in as_completed(futures):
                    result = future.result()
                    del left[futures[future]]
                    failures = 0
                    yield result
            except BrokenExecutor as exc:
                failures += 1
                if self._theirs is not None or failures >= _PATIENCE:
                    raise GeomsimError(f"The workers died and their work is lost: {exc}") from exc
                self._drop()

    def _executor(self) -> Executor:
        if self._theirs is not None:
            return self._theirs
        if self._pool is None:
            # forked processes need no guard around a user's program, and share what is compiled already
            method = "fork" if sys.platform == "linux" else None
            context = multiprocessing.get_context(method)
            self._pool = ProcessPoolExecutor(self.workers, context, _prepare, (os.getpid(),))
        return self._pool

    def _drop(self) -> None:
        if self._pool is not None:
            _close(self._pool, at_once=True)
            self._pool = None


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _close(pool: ProcessPoolExecutor, *, at_once: bool) -> None:
    processes = list((getattr(pool, "_processes", None) or {}).values()) if at_once else []
    pool.shutdown(wait=not at_once, cancel_futures=True)
    for process in processes:
        process.terminate()


def _prepare(parent: int) -> None:
    """Make a worker leave interruption to its parent, and end when that is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)


@contextmanager
def dask_executor(address: str, timeout: float = 10.0) -> Iterator[Executor]:
    """Give the executor of a Dask cluster.

    Parameters
    ----------
    address : str
        Of its scheduler, like ``tcp://10.0.0.7:8786``.
    timeout : float
        How long to wait for an answer, seconds.

    Raises
    ------
    GeomsimError
        If Dask is not installed or nobody answers.
    """
    try:
        from distributed import Client
    except ImportError as exc:
        raise GeomsimError("A Dask cluster needs the package 'distributed': pip install 'geomsim[cluster]'.") from exc
    try:
        client = Client(address, timeout=timeout)
    except (OSError, ValueError) as exc:
        raise GeomsimError(f"No Dask scheduler answers at {address!r}: {exc}".rstrip(".") + ".") from exc
    with client:
        yield client.get_executor()
