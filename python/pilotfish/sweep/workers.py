"""Who simulates the runs: this process, processes of this machine, or a Dask cluster. All do the same, run by run.

A job goes to the workers as one compressed piece with every file's content in it. A worker needs the same versions of
Pilotfish and NumPy, and nothing else: no file, no setting.
"""

from __future__ import annotations

import logging
import os
import pickle
import platform
import queue
import signal
import threading
import time
import zlib
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from pilotfish import __version__
from pilotfish.errors import CampaignError, MissingPackageError
from pilotfish.extras import require
from pilotfish.sweep.metrics import DIED
from pilotfish.sweep.play import Job, Played, RunSpec, failed, play_all, seeds

Stopping = Callable[[], bool]
_POLL_S = 0.2
_GONE_S = 30.0
_CLOSE_S, _FETCH_S = 10.0, 10.0
_MOST_LOST = 200  # chunks that were lost with their workers; more, and there is something else
_AHEAD = 3  # chunks for each thread: enough that none waits for us


@dataclass(frozen=True)
class Where:
    """``scheduler``: a Dask cluster's address. Else so many processes on this machine; 0: this very process."""

    workers: int = 0
    scheduler: str | None = None
    wait_s: float = 30.0  # for the scheduler, and for a first worker


class OtherVersionsError(Exception):
    """Raised on a worker: results would not be the same."""


def versions() -> dict[str, str]:
    """What must be the same on all workers."""
    return {"pilotfish": __version__, "numpy": np.__version__, "machine": platform.machine()}


def pack(job: Job) -> bytes:
    """The job as one piece, some ten kilobytes."""
    return zlib.compress(pickle.dumps((versions(), job)))


@lru_cache(maxsize=4)
def _unpack(packed: bytes) -> tuple[dict[str, str], Job]:
    return pickle.loads(zlib.decompress(packed))


def play_packed(packed: bytes, specs: Sequence[RunSpec]) -> Played:
    """On a worker: the rows of some runs."""
    wanted, job = _unpack(packed)
    if versions() != wanted:
        raise OtherVersionsError(f"{platform.node()} has {versions()}, and not {wanted}")
    return play_all(job, specs)


def chunk_size(job: Job, remaining: int, threads: int) -> int:
    """Runs that are handed out together: about a second of work, and at least four chunks for each thread."""
    by_time = 1 if job.rendered else int(np.clip(300.0 / job.duration_s, 1, 50))
    return max(1, min(by_time, remaining // (4 * max(1, threads))))


@contextmanager
def opened(where: Where) -> Iterator[tuple[Any, str | None]]:
    """(Dask's client, its dashboard's address); (None, None) if this process is to do it alone."""
    if where.scheduler is None and where.workers == 0:
        yield None, None
        return
    distributed = require("distributed", "sweep")
    with ExitStack() as stack:
        if where.scheduler is None:
            with _interrupts_ignored():
                cluster = distributed.LocalCluster(
                    n_workers=where.workers,
                    threads_per_worker=1,
                    processes=True,
                    memory_limit=None,
                    dashboard_address="127.0.0.1:0",
                    silence_logs=logging.CRITICAL,
                    preload=["pilotfish.sweep.local_worker"],
                )
            stack.callback(_close_cluster, cluster)
            client = distributed.Client(cluster, set_as_default=False)
        else:
            client = _connected(distributed, where)
        stack.callback(_close, client)
        yield client, client.dashboard_link if _has_bokeh() else None


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """A terminal sends Ctrl-C, and SIGHUP when it is closed, to all processes of a command; this one alone is to act on
    them, and end the others. What is ignored here is ignored by processes that are started meanwhile, from their first
    instruction on; local_worker sees to workers that are started again later. Until the workers are up, some seconds,
    both do nothing."""
    if threading.current_thread() is not threading.main_thread():  # has no say in signals
        yield
        return
    before = {number: signal.signal(number, signal.SIG_IGN) for number in (signal.SIGINT, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _close(what: Any) -> None:
    """A client or a cluster; what does not end in time is left to the end of this process. Rows are on the disk by now.
    The scheduler forgets what a client that is gone has asked for."""
    with suppress(TimeoutError, OSError):
        what.close(timeout=_CLOSE_S)


def _close_cluster(cluster: Any) -> None:
    """Also processes that do not end by themselves: one that is in the middle of a run, for instance."""
    processes = [nanny.process.process for nanny in cluster.workers.values() if nanny.process]
    _close(cluster)
    for process in processes:
        if process is not None and process.is_alive():
            os.kill(process.pid, signal.SIGKILL)


def _has_bokeh() -> bool:
    try:
        require("bokeh", "sweep")
    except MissingPackageError:
        return False
    return True


def _connected(distributed: Any, where: Where) -> Any:
    try:
        client = distributed.Client(where.scheduler, timeout=where.wait_s, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise CampaignError(
            f"no scheduler at {where.scheduler} ({error}); start one with `dask scheduler`, which prints its address, "
            "as tcp://HOST:8786"
        ) from error
    try:
        client.wait_for_workers(1, timeout=where.wait_s)
    except TimeoutError as error:
        client.close()
        raise CampaignError(
            f"{where.scheduler} has no worker; start one on each computer: `dask worker {where.scheduler} --nthreads 1 "
            "--nworkers auto`"
        ) from error
    return client


def played(client: Any, job: Job, specs: Sequence[RunSpec], stopping: Stopping) -> Iterator[Played]:
    """The rows, as they are ready: in any order. Ends early if ``stopping`` says so."""
    if client is None:
        for spec in specs:
            if stopping():
                return
            yield play_all(job, [spec])
    else:
        yield from _Handout(client, job, specs, stopping).played()


class _Handout:
    """Chunks that are on a cluster, and those that wait."""

    def __init__(self, client: Any, job: Job, specs: Sequence[RunSpec], stopping: Stopping) -> None:
        self.client, self.job, self.stopping = client, job, stopping
        self.packed = pack(job)
        self.threads = sum(client.nthreads().values())
        size = chunk_size(job, len(specs), self.threads)
        self.waiting = deque(specs[k : k + size] for k in range(0, len(specs), size))
        self.out: dict[str, tuple[Any, Sequence[RunSpec]]] = {}
        self.ready: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.lost = 0
        self.connected_s = self.counted_s = time.monotonic()

    def played(self) -> Iterator[Played]:
        while self.waiting or self.out:
            if self.stopping():
                return
            if not self._connected():  # whatever is asked of a scheduler that is gone may wait for ever
                time.sleep(_POLL_S)
                continue
            self._hand_out()
            try:
                key = self.ready.get(timeout=_POLL_S)
            except queue.Empty:
                continue
            if key in self.out:
                yield from self._answer(*self.out.pop(key))

    def _hand_out(self) -> None:
        now_s = time.monotonic()
        if now_s - self.counted_s > 5.0:  # workers come and go
            self.threads, self.counted_s = sum(self.client.nthreads().values()), now_s
        while self.waiting and len(self.out) < _AHEAD * max(1, self.threads):
            specs = self.waiting.popleft()
            future = self.client.submit(play_packed, self.packed, specs, pure=False)
            self.out[future.key] = (future, specs)
            future.add_done_callback(lambda done: self.ready.put(done.key))

    def _connected(self) -> bool:
        """Whether there is a scheduler just now. CampaignError if it does not come back."""
        now_s = time.monotonic()
        if self.client.status == "running":
            self.connected_s = now_s
            return True
        if self.client.status == "closed" or now_s - self.connected_s > _GONE_S:
            raise CampaignError(_GONE)
        return False

    def _answer(self, future: Any, specs: Sequence[RunSpec]) -> Iterator[Played]:
        """What is finished may be lost before it is here, with the worker that has it: then it is done once more. Only
        what is yielded counts, so no run has two rows."""
        if future.status == "error":
            yield from self._failed(future.exception(), specs)
            return
        answer = None
        if future.status == "finished":
            with suppress(Exception):  # of the way here: the run itself has ended well
                answer = future.result(timeout=_FETCH_S)
        if answer is not None:
            yield answer
            return
        self.lost += 1
        if self.lost > _MOST_LOST:
            raise CampaignError(_GONE)
        self.waiting.append(specs)

    def _failed(self, error: BaseException, specs: Sequence[RunSpec]) -> Iterator[Played]:
        killed = require("distributed.scheduler", "sweep").KilledWorker
        if isinstance(error, OtherVersionsError):
            raise CampaignError(f"a worker would give other results: {error}; install the same versions there")
        if not isinstance(error, killed):
            raise CampaignError(
                f"a worker cannot simulate: {type(error).__name__}: {error}; it needs the same Pilotfish: "
                "pip install 'pilotfish[sweep]'"
            )
        if len(specs) > 1:  # which of them was it?
            self.waiting.extend([spec] for spec in specs)
        else:
            yield Played([_died(self.job, specs[0])], 0.0)


_GONE = "the scheduler is gone; what is done is kept, and the same command goes on"


def _died(job: Job, spec: RunSpec) -> dict[str, Any]:
    world_seed, noise_seed = seeds(job, spec)
    row = {"run": spec.index, "point": spec.point, "repetition": spec.repetition, **spec.factors}
    reason = "the process that simulated it ended, each time it was tried: too little memory, or a crash"
    return failed(job, row | {"world_seed": world_seed, "noise_seed": noise_seed}, DIED, reason)
