"""The genetic algorithm of seed 001: its code by a worked example, its operators one by one, its search on a known valley."""

from functools import partial

import numpy as np
import pytest

from identification.experiments.table import kinds_of, perform
from identification.experiments.velagic.experiments import KINDS
from identification.fit.belief import NOTHING
from identification.fit.problem import Prior, Problem
from identification.runs.prediction import predicted
from identification.search import methods
from identification.search.genetic import Code, Settings, evolve
from identification.search.methods import Search, search
from identification.search.population import absolute_error, predictions
from identification.stages.staged import AskedOfStage, identify_stage
from tests.plants import bound as plant_of


def coded(kind, names):
    entries = [KINDS[kind].code[name] for name in names]
    lower, upper, bits = zip(*entries, strict=True)
    return Code(np.array(lower), np.array(upper), tuple(bits))


def test_bits_become_values_as_eqs_10_and_11_say():
    """Three bits of weights 1, 2, 4 from 10 to 24: 1 + 4 = 5 of 7 steps of 2; two bits from -1 to 2: 2 of 3 steps of 1."""
    code = Code(np.array([10.0, -1.0]), np.array([24.0, 2.0]), (3, 2))
    chromosomes = np.array([[1, 0, 1, 0, 1], [0, 0, 0, 0, 0], [1, 1, 1, 1, 1]], dtype=np.uint8)
    np.testing.assert_allclose(code.values(chromosomes), [[20.0, 1.0], [10.0, -1.0], [24.0, 2.0]], rtol=1e-14)


def test_the_chromosome_of_u1_has_94_bits_with_steps_of_a_millionth():
    """17, 16, 20, 15, 26 as the paper lists them; their sum is not the 96 that it states."""
    code = coded("main_motor", ("a_1", "b_1", "B_psi", "tau_G", "I_inv"))
    assert code.bits == (17, 16, 20, 15, 26)
    assert code.length == 94
    step = (code.upper - code.lower) / (2.0 ** np.array(code.bits) - 1.0)
    np.testing.assert_allclose(step, 1e-6, rtol=1e-6)


def test_the_paper_s_values_lie_within_every_range():
    plant = plant_of("ce150_velagic")
    for kind in KINDS.values():
        for name, (lower, upper, _) in kind.code.items():
            assert lower < plant.parameter(name) < upper


def test_the_population_has_the_size_and_the_rates_of_the_paper():
    assert Settings() == Settings(population=50, generations=150, crossover=0.75, mutation=0.1)


def test_a_known_valley_is_found_and_the_fitness_never_falls():
    """J = 1000 (|x - 3| + |y + 1|) over 2^16 steps each: within 2 % of the ranges after 150 generations, from any of three seeds."""
    code = Code(np.array([0.0, -5.0]), np.array([10.0, 5.0]), (16, 16))
    for seed in (1, 2, 3):
        found = evolve(code, lambda v: 1000.0 * np.abs(v - [3.0, -1.0]).sum(axis=1), seed)
        np.testing.assert_allclose(found.values, [3.0, -1.0], atol=0.2)
        assert len(found.best) == len(found.mean) == 150
        assert np.all(np.diff(found.best) >= 0.0)
        assert found.best[-1] == pytest.approx(1e5 - 1000.0 * np.abs(found.values - [3.0, -1.0]).sum())


def test_the_same_seed_gives_the_same_values_and_another_others():
    code = Code(np.zeros(2), np.ones(2), (12, 12))
    runs = [evolve(code, lambda v: 1e4 * np.abs(v - 0.3).sum(axis=1), seed).best for seed in (1, 1, 2)]
    assert runs[0] == runs[1] != runs[2]


def test_without_crossover_and_mutation_the_wheel_only_copies_and_prefers_the_fit():
    """One bit, fitness 0 against 100000: after one turn of the wheel nobody is left whose share was 0."""
    code, seen = Code(np.zeros(1), np.ones(1), (1,)), []

    def cost(values):
        seen.append(values[:, 0])
        return np.where(values[:, 0] > 0.5, 0.0, 2e5)

    evolve(code, cost, 1, Settings(generations=2, crossover=0.0, mutation=0.0, keep_best=False))
    assert 0.0 in seen[0]
    assert set(seen[1]) == {1.0}


def test_crossover_alone_keeps_every_place_s_bits():
    """Exchange behind one cut: how often each place is 1 among the children is what it is among their parents."""
    code, seen = Code(np.zeros(4), np.ones(4), (1, 1, 1, 1)), []
    only = Settings(generations=2, crossover=1.0, mutation=0.0, keep_best=False)
    uniform = Settings(generations=2, crossover=0.0, mutation=0.0, keep_best=False)
    for settings in (only, uniform):
        evolve(code, lambda v: (seen.append(v), np.zeros(len(v)))[1], 3, settings)
    crossed, parents = seen[1], seen[3]
    assert not np.array_equal(crossed, parents)
    # The wheel's draw comes first and is the same for both.
    np.testing.assert_array_equal(crossed.sum(axis=0), parents.sum(axis=0))


def test_mutation_turns_a_tenth_of_the_bits():
    """All strings alike and all bits 0 but for mutation: 50 x 2000 bits, 0.1 +- 0.004 are four standard deviations."""
    code, seen = Code(np.zeros(2000), np.ones(2000), (1,) * 2000), []
    stay = Settings(generations=2, crossover=0.0, mutation=0.1, keep_best=False)

    def cost(values):
        seen.append(values)
        return np.where(np.arange(len(values)) == 0, 0.0, 2e5)  # the wheel can only take the first

    evolve(code, cost, 1, stay)
    assert np.mean(seen[1] != seen[0][0]) == pytest.approx(0.1, abs=0.004)


@pytest.fixture(scope="module")
def problem(main_motor):
    """u1 of the paper's set with four free parameters."""
    plant, kind = plant_of("ce150_velagic"), kinds_of("ce150_velagic")["main_motor"]
    run = kind.run(main_motor, plant)
    names = ("a_1", "b_1", "B_psi", "I_inv")
    lower, upper = (np.array([kind.code[name][side] for name in names]) for side in (0, 1))
    start = np.array([plant.parameter(name) for name in names])
    return Problem(names, start, start, lower, upper, (run,), Prior(start, np.zeros((4, 4))))


def test_a_population_at_once_predicts_what_each_does_alone(problem):
    rng = np.random.default_rng(5)
    thetas = rng.uniform(problem.lower, problem.upper, (5, 4))
    run = problem.runs[0]
    alone = np.stack([predicted(run, problem.names, theta) for theta in thetas])
    np.testing.assert_allclose(predictions(run, problem.names, thetas), alone, atol=1e-9)
    by_hand = np.degrees(np.abs(run.y - alone)).sum(axis=1)
    np.testing.assert_allclose(absolute_error(problem, thetas), by_hand, rtol=1e-9)


def test_what_is_left_at_the_truth_is_the_encoder_s_rounding(problem):
    """Rounding to steps q leaves q/4 in the mean: 0.022 deg each, and less while the arm rests on its stop."""
    mean_deg = absolute_error(problem, problem.start[None])[0] / problem.runs[0].y.size
    assert 0.5 * 0.022 < mean_deg < 1.1 * 0.022


@pytest.mark.parametrize("method", ["genetic", "evolution", "gradient"])
def test_a_parameter_without_bounds_is_looked_for_within_five_sizes_of_its_start(monkeypatch, method):
    """Experiment 3 of seed 000: Psi_m has no bounds, and is 0 on this rig; every reading is a balance, not a motion."""
    monkeypatch.setattr(methods, "evolve", partial(evolve, settings=Settings(generations=25)))
    plant = plant_of("ce150")
    stage = identify_stage(plant, perform("gravity", plant, 1), NOTHING, AskedOfStage(wanted=Search(method, 1)))
    (found,) = stage.result.searched
    place = found.names.index("Psi_m")
    assert (found.lower[place], found.upper[place]) == (-0.5, 0.5)
    assert abs(found.values[place]) < 0.1
    assert stage.belief.value("tau_gE") == pytest.approx(plant.parameter("tau_gE"), rel=3e-3)


def test_a_better_string_is_told_at_once(monkeypatch, problem):
    monkeypatch.setattr(methods, "evolve", partial(evolve, settings=Settings(generations=10)))
    told = []
    found = search(problem, [0, 1, 2, 3], Search("genetic", 2), lambda values: told.append(dict(values)))[0]
    assert told
    assert list(told[-1].values()) == pytest.approx(found.values.tolist())
    assert set(told[-1]) == set(problem.names)
