"""Do all jobs of a sweep: answers in the order of the jobs, each kept when it is there, none lost to another's failure."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from contextlib import ExitStack, suppress
from dataclasses import dataclass

from jobs.code import code_digest
from jobs.crew import Crew, Hands
from jobs.job import Done, Job
from jobs.keep import Keep
from jobs.work import Outcome, work
from records.errors import BadInput

AHEAD = 2  # jobs handed out for each that is worked on, so that no worker waits for the next
DIED = "the worker process died in the middle of it (killed, or out of memory); see whether it fits into memory alone"
LOOK_s = 30.0  # without an answer until it is looked whether anybody is left; nobody at two looks in a row is the end
Watch = Callable[[Done], None]


@dataclass(eq=False)
class _Place:
    """A job's place in the order, empty until it is done."""

    job: Job
    key: str
    done: Done | None = None
    alone: bool = False  # tried with no other job out, so that it is the culprit if its worker dies


def run(jobs: Iterable[Job], crew: Crew, keep: Keep, watch: Watch = lambda _: None) -> Iterator[Done]:
    """Do `jobs`, which are asked for as there is room, and yield their ends in their order; `watch` is told of each as it comes.

    An answer that `keep` has is taken from there. A job that fails is told as such and the others go on; when a worker process dies, the
    jobs that were out are done again one by one, and the one at which it dies once more has failed. Raises BadInput where a cluster is
    lost or an answer cannot be kept. Closed or interrupted it stops its workers at once.
    """
    with _Shift(crew, keep, watch) as shift:
        source, order, exhausted = iter(jobs), deque[_Place](), False
        while order or not exhausted:
            if shift.room and not exhausted:
                job = next(source, None)
                exhausted = job is None
                if job is not None:
                    order.append(shift.begin(job))
            elif shift.busy:
                shift.wait()
            while order and (done := order[0].done) is not None:
                order.popleft()
                yield done


class _Shift:
    """The jobs that are out at the moment, and the executor that they are with."""

    def __init__(self, crew: Crew, keep: Keep, watch: Watch) -> None:
        self._crew, self._keep, self._watch = crew, keep, watch
        self._code = code_digest()
        self._stack = ExitStack()
        self._hands: Hands | None = None
        self._deserted = 0  # looks in a row that found nobody
        self.out: dict[Future[Outcome], _Place] = {}
        self._suspects = deque[_Place]()  # with each of which, and others, worker after worker has died

    def __enter__(self) -> "_Shift":
        return self

    def __exit__(self, *raised: object) -> None:
        self._stack.__exit__(*raised)  # type: ignore[arg-type]

    @property
    def room(self) -> bool:
        """Whether another job can go out."""
        if self._suspects or any(place.alone for place in self.out.values()):
            return False
        return self._hands is None or len(self.out) < AHEAD * self._hands.width

    @property
    def busy(self) -> bool:
        """Whether there is anything to wait for."""
        return bool(self.out or self._suspects)

    def begin(self, job: Job) -> _Place:
        """Take the kept answer, or hand the job out."""
        place = _Place(job, job.key(self._code))
        kept = self._keep.load(job.name, place.key)
        if kept is not None:
            self._end(place, Done(job.name, kept, None, 0.0, kept=True))
        else:
            self._hand_out(place)
        return place

    def wait(self) -> None:
        """Until at least one job is done or suspected; raises BadInput where nobody is left to do one."""
        if not self.out:
            place = self._suspects.popleft()
            place.alone = True
            self._hand_out(place)
        finished, _ = wait(self.out, LOOK_s, return_when=FIRST_COMPLETED)
        self._deserted = 0 if finished or self._hands is None or self._hands.manned() else self._deserted + 1
        if self._deserted > 1:
            raise _lost("its last worker gone", "a worker until the end")
        try:
            for future in sorted(finished, key=list(self.out).index):
                outcome = _outcome(future)
                place = self.out.pop(future)
                if outcome.failure == DIED and not place.alone:
                    self._suspects.append(place)
                else:
                    self._settle(place, outcome)
        except BrokenExecutor:
            self._mend()

    def _hand_out(self, place: _Place) -> None:
        if self._hands is None:
            self._hands = self._stack.enter_context(self._crew())
        try:
            future = self._hands.executor.submit(work, place.job.function, place.job.record, self._code)
        except BrokenExecutor:
            self._mend()
            self._hand_out(place)
            return
        self.out[future] = place

    def _mend(self) -> None:
        """A process died and took the executor with it: what was out is done again, each job alone, so that the culprit shows itself."""
        suspects = list(self.out.values())
        self.out.clear()
        for place in suspects:
            self._renew()
            try:
                self._hand_out(place)
                self._settle(place, _outcome(next(iter(self.out))))
            except BrokenExecutor:
                self._end(place, Done(place.job.name, None, DIED, 0.0))
                self._renew()
            self.out.clear()

    def _renew(self) -> None:
        """Another crew for one of which somebody has died: who is left of it is ended, as one that was just begun may wait for ever."""
        with suppress(BrokenExecutor), self._stack.pop_all():
            raise BrokenExecutor
        self._hands = None

    def _settle(self, place: _Place, outcome: Outcome) -> None:
        if outcome.failure is None:
            self._keep.save(place.job.name, place.key, outcome.answer, outcome.time_s)
        self._end(place, Done(place.job.name, outcome.answer, outcome.failure, outcome.time_s))

    def _end(self, place: _Place, done: Done) -> None:
        place.done = done
        self._watch(done)


def _outcome(future: Future[Outcome]) -> Outcome:
    """What came back; a worker that could not even begin is a failure of that job. Raises BadInput where the cluster was lost."""
    try:
        return future.result()
    except BrokenExecutor:
        raise
    except CancelledError as error:
        raise _lost("the connection lost", "a scheduler until the end") from error
    except Exception as error:
        if type(error).__name__ == "KilledWorker":  # Dask's, after it has tried the job on one worker after another
            return Outcome(None, DIED, 0.0)
        return Outcome(None, f"{type(error).__name__}: {' '.join(str(error).split())[:200]}", 0.0)


def _lost(got: str, expected: str) -> BadInput:
    remedy = "look after it, and give the same command: it goes on from what is kept"
    return BadInput("Dask cluster", "--cluster", got, expected, remedy)
