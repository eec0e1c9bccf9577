"""The comparison with other tools: that all fly the same flight, never how fast."""

import numpy as np
import pytest

from design.law import FloatLaw
from sim import bench, bench_compiled, bench_law, bench_peers
from sim.manoeuvres import hop
from sim.simulate import simulate


class Plain:
    """Numbers as they are."""

    minimum, maximum = min, max


def test_the_peers_law_is_the_law(table):
    """On random references and angles that saturate both inputs; the order of sums differs, so not to the last bit."""
    random, law = np.random.default_rng(5), FloatLaw(table)
    law.reset(0.0, 0.0)
    state = [0.0] * (2 * bench_law.LAW_STATES)
    for reference, angle in zip(random.uniform(-0.5, 0.5, (200, 2)), random.uniform(-0.2, 0.2, (200, 2)), strict=True):
        state, u = bench_law.law_step(table, Plain, state, reference.tolist(), angle.tolist())
        np.testing.assert_allclose(u, law.step(*reference, *angle), atol=1e-9)


def test_a_peer_in_python_ends_where_the_kernel_ends(bound, table):
    """Without friction, on which they differ, the readings of a second of flight agree to one encoder step."""
    names = [str(symbol) for symbol in bound.model.parameter_symbols]
    p = bound.p.copy()
    p[[names.index("b_cE"), names.index("b_cA")]] = 0.0
    slippery = type(bound)(bound.plant, bound.model, p, bound.sd)
    piece, law, x = hop(bound), FloatLaw(table), hop(bound).x0.tolist()
    hold = bench_peers.rk4_hold(bench_peers.scalar_rates(slippery))
    steps = [bound.plant.sensors[output] for output in ("psi_rad", "phi_rad")]
    y = [round(angle / step) * step for angle, step in zip((x[1], x[4]), steps, strict=True)]
    law.reset(*y)
    for reference in piece.reference_rad[:200].tolist():
        y = [round(angle / step) * step for angle, step in zip((x[1], x[4]), steps, strict=True)]
        x = hold(x, law.step(*reference, *y), 0.01)
    ours = simulate(slippery, piece.t_s, piece.x0, table, reference=piece.reference_rad).x[200]
    np.testing.assert_allclose([x[1], x[4]], ours[[1, 4]], atol=steps[0])


def test_every_tool_has_a_row_and_those_not_installed_say_so(bound, table, monkeypatch):
    monkeypatch.setattr(bench, "SECONDS_PER_TOOL", 0.0)
    monkeypatch.setattr(bench, "SHORT_S", 0.2)
    monkeypatch.setattr(bench, "BATCH", 8)
    rows = bench.run(bound, table, lambda: FloatLaw(table))
    tools = [row.tool for row in rows]
    assert tools[0] == "twinlaw kernel"
    assert set(bench_peers.PEERS) | set(bench_compiled.PEERS) < set(tools)
    for row in rows:
        assert row.note
        assert (row.ratio is None) == (row.simulated_s_per_cpu_s is None)
    for peer in bench_peers.PEERS:
        assert rows[tools.index(peer)].ratio is not None


@pytest.mark.parametrize("peer", ["CasADi generated C", "numba", "diffrax"])
def test_a_tool_that_is_not_installed_is_left_out(bound, table, monkeypatch, peer):
    monkeypatch.setattr(bench_compiled, "_module", lambda name: None)
    assert bench_compiled.PEERS[peer].prepare(bound, table, lambda: FloatLaw(table), hop(bound)) is None
