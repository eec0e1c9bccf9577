"""Whether a rig stood for an experiment as its equations say: plant, mount and locks, as stated and as the motion shows."""

import math
from collections.abc import Mapping
from dataclasses import replace

from identification import thresholds
from identification.experiments.kind import Kind
from identification.experiments.table import kind_of
from identification.fit.belief import Belief
from identification.fit.ranges import Range
from identification.runs.run import Run, coefficient_names
from identification.stages.estimate import Estimate, estimate
from records.errors import BadInput
from records.experiment import Experiment
from sim.bind import BoundPlant


def check_setup(experiment: Experiment, bound: BoundPlant) -> None:
    """Refuse a record of another plant, or of a rig that stood otherwise than the experiment's equations say; raises BadInput."""
    where = f"experiment {experiment.kind}"
    if experiment.plant != bound.model.name:
        raise BadInput(
            "plant", where, repr(experiment.plant), repr(bound.model.name), "give the record and the plant of one rig"
        )
    kind = kind_of(experiment)
    informs = ", ".join(kind.own)
    if experiment.mount != kind.mount:
        raise BadInput("mount", where, repr(experiment.mount), repr(kind.mount),
                       f"run it again on that mount: gravity acts differently on this one, and {informs} would come out wrong")  # fmt: skip
    if set(experiment.locked) != set(kind.locked):
        raise BadInput("locked axes", where, repr(list(experiment.locked)), repr(list(kind.locked)),
                       f"lock these and run it again: {informs} follow from the equations of the other axis alone")  # fmt: skip


def check_mount(run: Run, kind: Kind, result: Estimate, ranges: Mapping[str, Range], before: Belief) -> None:
    """Raise BadInput where the motion is badly predicted on the stated mount and far better on the other."""
    poor = any(test.floor > 0.0 and test.rms > thresholds.POOR * test.floor for test in result.residuals)
    other = _on_other_mount(run)
    if not poor or other is None:
        return
    there = estimate([other], result.own, ranges, before)
    own_rms, other_rms = (max(test.rms for test in found.residuals) for found in (result, there))
    if other_rms < own_rms / thresholds.POOR:
        moved = {"turned": "upright", "upright": "turned"}[kind.mount]
        raise BadInput(
            "mount", f"experiment {run.name}", f"a motion as on the mount {moved!r} (residuals {other_rms:.2g} there, {own_rms:.2g} here)",
            f"one as on the mount {kind.mount!r}", f"run it again on that mount: {', '.join(kind.own)} cannot come from this record",
        )  # fmt: skip


def _on_other_mount(run: Run) -> Run | None:
    """The run as it would be with gravity in the other direction; None where no axis moves."""
    names, p = list(coefficient_names(run.bound.model)), run.bound.p.copy()
    if "mount_rad" in names:
        place = names.index("mount_rad")
        p[place] = 0.0 if p[place] else -math.pi / 2
    elif "turned" in names:
        place = names.index("turned")
        p[place] = 1.0 - p[place]
    else:
        return None
    return replace(run, bound=replace(run.bound, p=p))
