"""Who does the jobs: processes of this computer, or the workers of a Dask cluster; either is an executor of `concurrent.futures`."""

import asyncio
import logging
import multiprocessing
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Any

from jobs.code import code_digest
from jobs.threads import cores, one_thread_each
from jobs.work import settle_in
from records.errors import BadInput

PATIENCE_S = 10.0  # for a cluster to answer
GRACE_S = 2.0  # for a process that was told to end


@dataclass(frozen=True)
class Hands:
    """An open executor, how many jobs it does at once, and whether anybody is left to do them (which may take seconds to find out)."""

    executor: Executor
    width: int
    manned: Callable[[], bool] = lambda: True


Crew = Callable[[], AbstractContextManager[Hands]]  # opened once, and once more where a process of it has died


def processes(workers: int | None = None) -> Crew:
    """So many processes of this computer, one a processor where `workers` is None; one also where there is but one."""

    @contextmanager
    def opened() -> Iterator[Hands]:
        width = workers or cores()
        others = set(multiprocessing.active_children())
        # Spawned, not forked: a fork of a process with threads may stand still, and every worker begins alike.
        context = multiprocessing.get_context("spawn")
        with one_thread_each():
            executor = ProcessPoolExecutor(width, mp_context=context, initializer=settle_in)
            finished = False
            try:
                yield Hands(executor, width)
                finished = True
            finally:
                if not finished:
                    _end(set(multiprocessing.active_children()) - others)
                executor.shutdown(wait=True, cancel_futures=True)

    return opened


def _end(children: Collection[BaseProcess]) -> None:
    """Terminate processes, and kill those that do not end: one that waits for a lock which a dead one holds takes its end for an error of
    its job, and waits on to tell it."""
    for child in children:
        child.terminate()
    for child in children:
        if not wait([child.sentinel], GRACE_S):
            child.kill()


def cluster(address: str) -> Crew:
    """The workers behind the Dask scheduler at `address`; opening it raises BadInput where there is none, or its workers differ from us."""

    @contextmanager
    def opened() -> Iterator[Hands]:
        try:
            from distributed import Client  # an extra
        except ImportError as error:
            got, remedy = "no library distributed", "pip install --editable '.[cluster]', or leave --cluster out"
            raise BadInput("Dask", f"--cluster {address}", got, "the extra `cluster`", remedy) from error
        for name in ("distributed", "distributed.client"):  # what it would tell in its words we tell in ours
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            client = Client(address, timeout=PATIENCE_S, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            remedy = "start one with `dask scheduler`, or correct the address"
            raise BadInput("Dask scheduler", address, _short(error), "one that answers", remedy) from error
        try:
            width, muster = _width(client, address), _Muster(client)
            muster.manned()  # who looks after whom is known from the beginning
            # Not pure: a job that is tried anew must not meet the end of its first trial under the same key.
            yield Hands(client.get_executor(pure=False), width, muster.manned)
        finally:
            client.close()

    return opened


def _width(client: object, address: str) -> int:
    """Threads of all workers, after each has shown that it computes by what we compute by."""
    threads: dict[str, int] = client.nthreads()  # type: ignore[attr-defined]
    if not threads:
        remedy = f"start some with `dask worker {address} --nthreads 1`"
        raise BadInput("Dask workers", address, "none", "at least one", remedy)
    try:
        codes: dict[str, str] = client.run(code_digest)  # type: ignore[attr-defined]
    except Exception as error:  # whatever the worker raised, a missing package most of all
        remedy = "start the workers with the Python and in the checkout that ask"
        raise BadInput("Dask workers", address, _short(error), "an installed twinlaw", remedy) from error
    others = sorted(name for name, code in codes.items() if code != code_digest())
    if others:
        remedy = "update them: the same sources, libraries and Python give the same answers"
        raise BadInput("Dask workers", others[0], "other sources or libraries", "those of this checkout", remedy)
    return sum(threads.values())


@dataclass
class _Muster:
    """Who is left on a cluster: registered workers, or else the nannies of those that were, each of which begins another worker."""

    client: Any
    nannies: set[str] = field(default_factory=set)

    def manned(self) -> bool:
        """Whether the scheduler knows a worker, busy or paused, or a nanny answers; nothing is concluded from how long that takes."""
        workers = self.client.sync(self.client.scheduler.identity)["workers"].values()
        self.nannies |= {worker["nanny"] for worker in workers if worker["nanny"]}
        return bool(workers) or bool(self.client.sync(self._answers))

    async def _answers(self) -> bool:
        met = await asyncio.gather(*map(self._meet, self.nannies), return_exceptions=True)
        return any(error is None for error in met)

    async def _meet(self, nanny: str) -> None:
        from distributed.comm import connect

        comm = await connect(nanny, timeout=PATIENCE_S, **self.client.connection_args)
        comm.abort()


def _short(error: Exception) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())[:120]}"
