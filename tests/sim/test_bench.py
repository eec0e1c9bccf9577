"""The comparison with other tools: that all fly the same flight, never how fast."""

from dataclasses import replace

import numpy as np
import pytest

from design.law import FloatLaw
from sim.bench import comparison, compiled_peers, peers, plain_law
from sim.manoeuvres import hop
from sim.simulate import Conditions, simulate


def test_the_peers_law_is_the_law(table):
    """On random references and angles that saturate both inputs; the order of sums differs, so not to the last bit."""
    random, law = np.random.default_rng(5), FloatLaw(table)
    law.reset(0.0, 0.0)
    state = [0.0] * (2 * plain_law.LAW_STATES)
    for reference, angle in zip(random.uniform(-0.5, 0.5, (200, 2)), random.uniform(-0.2, 0.2, (200, 2)), strict=True):
        state, u = plain_law.law_step(table, plain_law.PlainNumbers, state, reference.tolist(), angle.tolist())
        np.testing.assert_allclose(u, law.step(*reference, *angle), atol=1e-9)


def slippery(bound):
    """The plant without dry friction, on which the tools differ."""
    names = [str(symbol) for symbol in bound.model.parameter_symbols]
    p = bound.p.copy()
    p[[names.index("b_cE"), names.index("b_cA")]] = 0.0
    return type(bound)(bound.plant, bound.model, p, bound.sd)


@pytest.mark.parametrize("name", [*peers.PEERS, *compiled_peers.PEERS])
def test_every_tool_ends_where_the_kernel_ends(bound, table, name):
    """A second of flight without friction, on which they differ: to a tenth of an encoder step; a reading that flips would be more."""
    plant = slippery(bound)
    piece = hop(plant)
    piece = replace(piece, t_s=piece.t_s[:201], reference_rad=piece.reference_rad[:201])
    peer = {**peers.PEERS, **compiled_peers.PEERS}[name]
    task = peers.Task(plant, table, lambda: FloatLaw(table), piece, np.array([plant.p, plant.p * 1.001]))
    work = peer.prepare(task)
    if work is None:
        pytest.skip(f"{name} is not installed: see `twinlaw bench`")
    p = task.p if peer.batched else plant.p
    ours = simulate(plant, piece.t_s, piece.x0, table, Conditions(reference=piece.reference_rad, p=p)).x[
        ..., -1, [1, 4]
    ]
    np.testing.assert_allclose(np.asarray(work()), ours, atol=plant.plant.sensors["psi_rad"] / 10)


def quick(monkeypatch):
    for name, value in {"SECONDS_PER_TOOL": 0.0, "SHORTEST_S": 0.0, "SHORT_S": 0.2, "BATCH": 8}.items():
        monkeypatch.setattr(comparison, name, value)


def test_every_tool_has_a_row_and_those_not_installed_say_so(bound, table, monkeypatch):
    quick(monkeypatch)
    rows, share = comparison.run(bound, table, lambda: FloatLaw(table))
    assert 0.0 < share.single < 1.0
    tools = [row.tool for row in rows]
    assert tools[0] == "twinlaw kernel"
    assert set(peers.PEERS) | set(compiled_peers.PEERS) < set(tools)
    for row in rows:
        assert row.note
        assert (row.batch_ratio is None) == (row.simulated_s_per_cpu_s is None) == (row.apart_rad is None)
    for peer in peers.PEERS:
        row = rows[tools.index(peer)]
        assert row.kernel_ratio == pytest.approx(rows[0].simulated_s_per_cpu_s / row.simulated_s_per_cpu_s)
        assert row.batch_ratio == pytest.approx(rows[1].simulated_s_per_cpu_s / row.simulated_s_per_cpu_s)
        assert row.apart_rad < 0.01


@pytest.mark.parametrize("peer", compiled_peers.PEERS)
def test_a_tool_that_is_not_installed_is_left_out(bound, table, monkeypatch, peer):
    monkeypatch.setattr(compiled_peers, "module", lambda name: None)
    task = peers.Task(bound, table, lambda: FloatLaw(table), hop(bound), bound.p[np.newaxis])
    assert compiled_peers.PEERS[peer].prepare(task) is None


@pytest.mark.parametrize("tick_s", [1e-9, 1e-3, 1.0 / 64.0])
def test_a_coarse_clock_tells_the_same_speed(tick_s):
    """Work of 0.3 ms that simulates 0.6 s: 2000, read from a clock that moves in ticks; as exactly as a tick can tell."""
    now_s = 0.0

    def work():
        nonlocal now_s
        now_s += 3e-4

    found = comparison.speed(work, 0.6, clock=lambda: np.floor(now_s / tick_s) * tick_s)
    assert found == pytest.approx(2000.0, rel=max(0.01, 1.1 * tick_s / comparison.SHORTEST_S))


def test_step_halving_reports_the_error_that_finer_steps_show(bound, table):
    found = comparison.step_accuracy(bound, table)
    assert max(found.true_rad) < 1e-7
    np.testing.assert_allclose(found.halving_rad, found.true_rad, rtol=0.2)
