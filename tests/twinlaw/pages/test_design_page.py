"""The page of a design: the coefficients of loops that are of different orders."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from records.loops import LOOPS, Loop
from twinlaw.pages.run.design_page import coefficient_plot

POINTS = np.linspace(-0.5, 0.5, 3)


def _axis(name: str, states: int) -> Any:
    """A loop as the report has it, with `states` + 1 coefficients of either kind, of which only p_0 vanishes."""
    q = [(1.0, 0.5)] * (states + 1)
    p = [(0.0, 0.0), *[(1.0, 0.5)] * states]
    design = SimpleNamespace(q=[1.0] * (states + 1), p=[0.0, *[1.0] * states])
    schedule = SimpleNamespace(q=q, p=p)
    return SimpleNamespace(
        axis=name, schedule=schedule, designs=[design] * 3, operating_V=np.ones(3), feedforward_V=(1.0,)
    )


@pytest.mark.parametrize("states", [(3, 2), (2, 3)])
def test_a_loop_of_fewer_states_leaves_the_others_coefficients_whole(states: tuple[int, int]) -> None:
    # Truth: n + 1 of q, n of p, of which p_0 is left out, and u_ff, for a loop of n states: 8 panels of three, 6 of two.
    loops = {loop.axis: loop for loop in LOOPS}
    axes = [_axis(loop.axis, count) for loop, count in zip(LOOPS, states, strict=True)]
    report: Any = SimpleNamespace(
        axes=axes, points_rad=POINTS, angle=LOOPS[0].axis, loop=loops.__getitem__, scheduled_by=LOOPS[0].output
    )
    drawn = coefficient_plot(cast(Any, report))
    assert drawn.count(">q_3 [") == 1
    assert drawn.count(">q_2 [") == drawn.count(">u_ff [") == 2
    assert drawn.count(" [V/deg]</text>") + drawn.count(" [V/rad]</text>") == 7


def test_an_axis_called_as_its_angle_is_written_once_along_the_schedule() -> None:
    # Truth: of axis and output "nod", "nod_rad", the abscissa is nod [deg]; of the helicopter's it is elevation psi [deg].
    nod = Loop("nod", "nod_rad", "u_V", "motor")
    for loop, label in ((nod, ">nod [deg]"), (LOOPS[0], ">elevation psi [deg]")):
        report: Any = SimpleNamespace(
            axes=[_axis(loop.axis, 2)], points_rad=POINTS, angle=loop.axis, loop=lambda _, one=loop: one,
            scheduled_by=loop.output,
        )  # fmt: skip
        assert label in coefficient_plot(cast(Any, report))
