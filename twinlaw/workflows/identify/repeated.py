"""Identification repeated on simulated rigs, each with a seed of its own: what is known after each is left as a file."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from jobs.crew import Crew
from jobs.job import Job
from records.files import write_atomic
from twinlaw.workflows import sweeping

R = TypeVar("R")


def repeated(
    title: str,
    jobs: Sequence[Job],
    crew: Crew,
    path: Path,
    read: Callable[..., R],
    facts: Callable[[Sequence[R]], dict[str, Any]],
) -> tuple[list[R], dict[str, Any]]:
    """The answers of all jobs, each made a record by `read`, and the facts on them; after each answer `path` holds those so far."""
    found, told = list[R](), dict[str, Any]()
    for answer in sweeping.answers(title, jobs, crew, path.parent / "jobs"):
        found.append(read(**answer))
        told = facts(found)
        write_atomic(path, json.dumps(told, indent=1) + "\n")
    return found, told
