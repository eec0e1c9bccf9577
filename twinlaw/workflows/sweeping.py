"""A sweep as a person starts it: who works, how far it is, how it ends early, and what could not be done."""

import argparse
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from jobs.crew import Crew, cluster, processes
from jobs.job import Answer, Done, Job
from jobs.keep import Answers, Keep
from jobs.run import run
from records.errors import BadInput
from twinlaw.cli import console, options

Each = Callable[[Callable[[Any], Answer], Sequence[Any]], Iterable[Answer]]


def workers(parser: argparse.ArgumentParser, when: str = "") -> None:
    """--workers N or --cluster ADDRESS, which count only `when` there is something to share out."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "--workers", type=options.count, metavar="N", help=f"{when}processes of this computer; default: one a processor"
    )
    group.add_argument(
        "--cluster",
        metavar="ADDRESS",
        help=f"{when}a Dask scheduler instead, as tcp://10.0.0.5:8786; needs the extra `cluster`",
    )


def crew_of(chosen: argparse.Namespace) -> Crew:
    """Who was asked for with `workers`."""
    return processes(chosen.workers) if chosen.cluster is None else cluster(chosen.cluster)


def swept(title: str, jobs: Iterable[Job], count: int, crew: Crew, keep: Keep) -> Iterator[Done]:
    """The ends of `count` jobs in their order; Ctrl-C says how many are kept."""
    finished = 0

    def watch(done: Done) -> None:
        nonlocal finished
        finished += done.failure is None
        tell(done.kept, done.failure is not None)

    try:
        with console.tally(title, count) as tell:
            yield from run(jobs, crew, keep, watch)
    except KeyboardInterrupt as error:
        told = f"{finished} of {count} done and kept, the same command goes on from there"
        raise KeyboardInterrupt(told) from error


def answers(title: str, jobs: Sequence[Job], crew: Crew, folder: Path) -> Iterator[Answer]:
    """Their answers, kept in `folder`; raises BadInput after all others are done where one failed."""
    failed = []
    for done in swept(title, jobs, len(jobs), crew, Answers(folder)):
        if done.failure is None:
            yield done.answer
        else:
            failed.append(done)
    if failed:
        what, remedy = f"{len(failed)} of {len(jobs)} failed, this first", "the others are kept for the same command"
        raise BadInput(what, failed[0].name, str(failed[0].failure), "an answer", remedy)


def each(title: str, crew: Crew, folder: Path, name: Callable[[Any], str]) -> Each:
    """A function like `map` for those who know nothing of workers; its jobs are called by the `name` of their record."""

    def mapped(function: Callable[[Any], Answer], records: Sequence[Any]) -> Iterator[Answer]:
        return answers(title, [Job(name(record), function, record) for record in records], crew, folder)

    return mapped


def failures(ends: Iterable[tuple[str, str | None]]) -> int:
    """A line on stderr for each (name, failure) that is one, and the exit status: 2 where there is any."""
    failed = [f"{name}: {failure}" for name, failure in ends if failure is not None]
    for line in failed:
        console.fail(line)
    return 2 if failed else 0
