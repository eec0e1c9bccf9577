"""The real rigs: without effects they are the project's plants, their logs are as people make them, a truth says what flew."""

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from blind import Benchmark, make
from blind.cases.make import Order, make_case
from blind.cases.sealed import open_seal, truth_to_json
from blind.cases.severity import SLOPE_STEP_S
from blind.effects.effect import Effect, Shape
from blind.effects.visited import Visited
from blind.rigs.bench import Plan
from blind.rigs.real import lab as real_lab
from blind.rigs.real.catalogue import ALL, CATALOGUES
from blind.rigs.real.derive import SOURCES as SOURCES_OF
from blind.rigs.real.derive import Array, Measured, autoregression, push, reading
from blind.rigs.real.lab import Errors, LogStyle, RealLab, draw_bench
from blind.rigs.real.plant import RealPlant
from blind.rigs.real.plants import ANTX_2DOF_DRONE, DC_MOTOR, PLANTS
from blind.rigs.real.simulation import ARC_TANGENT, DAHL, FOLDER, LUGRE, SOURCES, Body
from blind.rigs.real.spectra import Spectrum, spectra
from blind.simulation.record import Loss, Model, Record
from records.log import load_log
from records.plant import load_plant
from sim.added_effects import Sizes, combined, library, with_effects, with_values
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from sim.effects import effects_for
from sim.simulate import Conditions, simulate
from tests.recorded import dataset_folder
from tests.soak import SOAK, sampled

FREE, SEED = (False, False), 4
NOMINAL = Plan("nominal", (), (), True, False)
# Times at which an effect begins.
# What the states of a plant, in its order, are in the rigs' C: angle and rate of each axis, then what lags. The others' are in that order.
ORDER = {
    "ce150": ("psi_rad", "psi_dot_rad_s", "phi_rad", "phi_dot_rad_s", "omega_M_rad_s", "omega_T_rad_s"),
    "antx_2dof_drone": ("theta_rad", "q_rad_s", "", "", "M_filtered", "M_filtered_rate"),
    "dc_motor": ("theta_rad", "omega_rad_s", "", "", "i_A"),
}
EVENTS = ("pulse_start_s", "weight_time_s", "chip_time_s", "jump_time_s")
OF_A_PLANT = pytest.mark.parametrize("plant", PLANTS, ids=[plant.name for plant in PLANTS])
OF_SOME_PLANTS = pytest.mark.parametrize(
    "plant", sampled(PLANTS, keep=[plant for plant in PLANTS if plant.name in ("antx_2dof_drone", "ce150", "dc_motor")])
)


def lab_of(
    plant: RealPlant, seconds: float, law: int, *, closed: bool = True, locked: tuple[bool, bool] = FREE
) -> RealLab:
    """The plant as it is stated in still air, read without error."""
    given = plant.read(plant.path.read_text(), plant.name)
    style = LogStyle(0.01, seconds, closed, locked)
    nothing = (0.0,) * len(plant.outputs)
    errors = Errors(spectra()["push"][:2], nothing, spectra()["reading"][:2], nothing, nothing)
    width = [1e-3 * size for size in (plant.rate if law == ARC_TANGENT else plant.reach)]
    return RealLab(plant, given, given, Body(law, (width[0], width[-1])), errors, (style,) * 4, 0.8)


def flown(lab: RealLab, settings: Mapping[tuple[str, int], float], *, placed: bool = False, seed: int = 3) -> Record:
    """Shadow 0 has the settings, shadow 1 has not."""
    model = Model(lab.nominal, settings)
    return lab.fly(
        model, [model, Model(lab.nominal, {}, placed=placed)], lab.inputs(np.random.default_rng(seed), Loss(), 0)
    )


def test_a_shifted_weight_is_a_torque_wherever_gravity_turns_an_axis() -> None:
    # Truth: the effect moves a share of gravity's moment, so that moment is the scale of its torque; 0 would be no scale.
    turned = [plant for plant in PLANTS if plant.gravity]
    assert len(turned) == 3
    for plant in turned:
        bench = draw_bench(plant, plant.read(plant.path.read_text(), plant.name), NOMINAL, np.random.default_rng(SEED))
        assert bench.gravity_Nm > 0.0, plant.name


def largest(plant: RealPlant) -> Array:
    """What a run reaches of all outputs, or of angle and rate where a gyro measures that."""
    return np.array(plant.reach + plant.rate if len(plant.outputs) > len(plant.axes) else max(plant.reach))


@OF_A_PLANT
def test_a_prediction_is_smooth_in_every_parameter(plant: RealPlant) -> None:
    """A tenth more or less of any number moves coarse predictions of a second by no more than a few times what a run reaches."""
    lab = lab_of(plant, 4.0, DAHL)
    record = flown(lab, {})
    for name, values in lab.nominal.values.items():
        for share in (0.9, 1.1):
            moved = lab.predict(lab.nominal.with_values({name: share * values}), record, SLOPE_STEP_S)
            assert (np.abs(moved - record.exact_rad) < 5.0 * largest(plant)).all(), name


@OF_SOME_PLANTS
def test_without_effects_it_is_the_projects_plant(plant: RealPlant) -> None:
    """Free 1 s runs from the same states: bristles in the bearings against located friction, within a hundredth of what it reaches."""
    record = flown(lab_of(plant, 6.0, DAHL), {})
    bound = bind(load_plant(plant.path))
    states = [str(state) for state in bound.model.states]
    order = [ORDER.get(plant.name, states).index(state) for state in states]
    for first in range(0, len(record.t_s), 100):
        rows = slice(first, first + 100)
        start = record.apparent[first][order]
        run = simulate(
            bound,
            record.t_s[rows],
            start,
            record.u_V[rows],
            Conditions(resolution=[0.0] * len(plant.outputs), substeps=4),
        )
        assert (np.abs(run.y - record.exact_rad[rows]) < 0.01 * largest(plant)).all()
    assert np.ptp(record.exact_rad, axis=0).min() > 0.2 * min(plant.reach)


@OF_A_PLANT
@pytest.mark.parametrize("law", [ARC_TANGENT, DAHL, LUGRE])
def test_in_still_air_a_rig_repeats_itself_exactly_and_its_coarse_prediction_nearly(plant: RealPlant, law: int) -> None:
    lab = lab_of(plant, 4.0, law, closed=law == DAHL)
    record = flown(lab, {("sensor_delay_s", 0): 0.02, ("lag_s", 0): 0.03})
    np.testing.assert_array_equal(record.shadow[:, 0], record.exact_rad)
    plain = flown(lab, {})
    assert (np.abs(lab.predict(lab.nominal, plain, 2e-3) - plain.exact_rad) < 0.01 * largest(plant)).all()


def test_an_axis_that_is_held_stands_while_its_readings_tip_to_and_fro() -> None:
    plant = PLANTS[0]
    lab = lab_of(plant, 4.0, DAHL, closed=False, locked=(False, True))
    record = flown(replace(lab, errors=replace(lab.errors, white_counts=(0.3, 0.3))), {})
    counts = record.y_rad[:, 1] / lab.nominal.resolution_rad[1]
    assert record.locked == ("azimuth",)
    assert np.ptp(record.apparent[:, 2]) == 0.0
    assert 1.0 <= np.ptp(np.round(counts)) <= 3.0
    assert np.ptp(record.exact_rad[:, 0]) > 0.02


@OF_A_PLANT
def test_a_filter_behind_a_late_sensor_leaves_the_rate_that_it_shows(plant: RealPlant) -> None:
    """A filter of 2 ms makes an angle late by no more than that times its rate; the rate beside it is the shown angle's still."""
    lab = lab_of(plant, 4.0, DAHL, closed=False)
    late = {("sensor_delay_s", 0): 0.02}
    bare = flown(lab, late)
    behind = flown(replace(lab, body=replace(lab.body, filter_s=(2e-3, 2e-3 if len(plant.axes) > 1 else 0.0))), late)
    np.testing.assert_array_equal(behind.apparent[:, 1], bare.apparent[:, 1])
    assert np.abs(behind.apparent[:, 0] - bare.apparent[:, 0]).max() < 2.1e-3 * np.abs(bare.apparent[:, 1]).max()


def begun_early(effect: Effect) -> Shape:
    """A shape of the effect, with an event half a second after the beginning."""
    return {key: 0.5 if key in EVENTS else value for key, value in effect.draw(np.random.default_rng(1)).items()}


def large(effect: Effect) -> dict[tuple[str, int], float]:
    """Settings of an effect at eight times its size (within bounds) that begins early."""
    return dict(effect.settings(float(np.clip(8.0, *effect.bounds)), begun_early(effect)))


@OF_SOME_PLANTS
def test_every_effect_is_felt(plant: RealPlant) -> None:
    """Beside a run without effects, free predictions with each differ by more than a three-thousandth of what the axis reaches."""
    effects = [e for e in CATALOGUES[plant.name].all if e.size.field and not e.name.endswith("sensor.quantization")]
    lab = lab_of(plant, 4.0, DAHL)
    plain = Model(lab.nominal, {})
    shadows = [plain, *(Model(lab.nominal, large(effect), placed=effect.sensor) for effect in effects)]
    record = lab.fly(plain, shadows, lab.inputs(np.random.default_rng(4), Loss(), 0))
    moved = (np.abs(record.shadow[:, 1:] - record.shadow[:, :1]) / np.array(plant.reach)).max(axis=(0, 2))
    assert not [effect.name for effect, most in zip(effects, moved, strict=True) if most < 3e-4]


@OF_A_PLANT
def test_every_library_effect_has_finite_parameters_in_the_librarys_formula(plant: RealPlant) -> None:
    record = flown(lab_of(plant, 6.0, DAHL), {})
    u = np.column_stack([record.u_V, np.zeros(len(record.u_V))])[:, :2]
    visited = Visited(3.0 * record.t_s, *record.apparent.T, *u.T, 0.04, lambda w: 1e-7 * w * np.abs(w), 100.0)
    catalogue = CATALOGUES[plant.name]
    for effect in (*catalogue.known, *catalogue.timing):
        found = effect.equivalent(1.0, effect.draw(np.random.default_rng(2)), visited)
        assert any(entry.main for entry in found.values()), effect.name
        assert all(np.isfinite(entry.value) and entry.scale > 0.0 for entry in found.values()), effect.name


@OF_A_PLANT
def test_names_of_known_effects_are_the_librarys(plant: RealPlant) -> None:
    catalogue = CATALOGUES[plant.name]
    library = set(effects_for(bind(load_plant(plant.path)).model))
    names = [effect.name for effect in catalogue.all]
    assert len(set(names)) == len(names)
    assert {effect.name for effect in (*catalogue.known, *catalogue.timing)} <= library
    assert {twin for effect in catalogue.all for twin in effect.twins} <= library


def test_the_c_reads_every_field_that_a_row_sets_and_no_other() -> None:
    text = "".join((FOLDER / source).read_text() for source in SOURCES)
    fields = {name for e in ALL if e.size.field for name in (e.size.field, *e.drawn, *e.fixed)}
    assert fields == {a or b for a, b in re.findall(r"\bfx->(\w+)|effects\.(\w+)", text)}


def test_colours_are_stable_and_of_size_one() -> None:
    for kind in spectra().values():
        for spectrum in kind:
            assert np.abs(np.roots([1.0, *(-a for a in spectrum.coefficients)])).max() < 1.0
            assert np.sqrt(np.mean(spectrum.drawn(np.random.default_rng(0), 4000, 0.001) ** 2)) == pytest.approx(1.0)


def test_an_autoregression_is_found_again() -> None:
    coefficients = (0.6, -0.4, 0.2, 0.1)
    spectrum = Spectrum("", 0.01, 1.0, coefficients)
    found = autoregression(spectrum.drawn(np.random.default_rng(1), 20_000, 0.01))
    assert found == pytest.approx(coefficients, abs=0.03)


@pytest.mark.parametrize(
    ("name", "dataset", "kinds"),
    [
        ("aeroshield", "aeroshield", {"reading": reading, "push": push}),
        ("antx_pitch", "antx_2dof_drone", {"reading": reading, "push": push}),
        ("antx_rate", "antx_2dof_drone", {"reading": reading}),
    ],
)
def test_the_numbers_of_the_table_are_those_of_the_recording(
    name: str, dataset: str, kinds: Mapping[str, Callable[[Measured], tuple[Array, float]]]
) -> None:
    path, read = SOURCES_OF[name]
    measured = read(dataset_folder(dataset).parent / path)
    for kind, find in kinds.items():
        known = next(spectrum for spectrum in spectra()[kind] if spectrum.name == name)
        left, share = find(measured)
        assert autoregression(left) == pytest.approx(known.coefficients, abs=1e-4)
        assert share == pytest.approx(known.share, rel=0.01)


@OF_A_PLANT
def test_spreads_are_two_per_cent_and_more_and_conventions_stay(plant: RealPlant) -> None:
    given = plant.read(plant.path.read_text(), plant.name)
    for seed in range(8):
        bench = draw_bench(plant, given, NOMINAL, np.random.default_rng(seed))
        for name, values in bench.nominal.values.items():
            shares = bench.nominal.sds[name][values != 0.0] / np.abs(values[values != 0.0])
            assert np.all((shares == 0.0) | ((shares > 0.0199) & (shares < 0.1501)))
            assert np.all(np.abs(bench.true.values[name] - values) <= 2.51 * bench.nominal.sds[name])
        logs = bench.lab.styles[:-1]  # type: ignore[attr-defined]
        assert all(log.rows <= real_lab.MOST_ROWS for log in logs)
        assert logs[-1].length_s >= 20.0
        assert not any(all(log.locked[i] for log in logs[:-1]) for i in range(2))


def shorten(patch: pytest.MonkeyPatch) -> None:
    """None of the effects that the seed gives begins later than these runs end."""
    if not SOAK:
        patch.setattr(real_lab, "TRIAL_S", 4.0)
        patch.setattr(real_lab, "RUN_LENGTHS_S", (4.0, 6.0))
        patch.setattr(real_lab, "PERIODS_S", (0.02, 0.01))
        patch.setattr(real_lab, "HOLD_PERIODS_S", (0.02, 0.01))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two cases of each plant."""
    out = tmp_path_factory.mktemp("real") / "cases"
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        make(Benchmark(SEED, 2 * len(PLANTS), ("nominal", "single"), rig="real"), out)
    return out


def test_every_case_is_logs_and_a_plant_that_the_records_read(folder: Path) -> None:
    cases = sorted(folder.glob("case-*"))
    truths = open_seal(folder)
    for number, case in enumerate(cases):
        plant = PLANTS[number % len(PLANTS)]
        stated = load_plant(case / "plant.toml")
        columns = log_columns(bind(stated).model)
        assert set(truths[case.name].floor_rad) == set(plant.outputs)
        for path in case.glob("*.csv"):
            log = load_log(path, columns)
            assert log.t_s[0] >= 0.0
            assert np.median(np.diff(log.t_s)) == pytest.approx(log.sample_period_s, rel=2e-3, abs=2e-6)
            for index, output in enumerate(plant.outputs):
                counts = log.y[:, index] / stated.sensors[output]
                np.testing.assert_allclose(counts, np.round(counts), atol=2e-3)
    assert {truth.kind for truth in truths.values()} == {"nominal", "single"}


def test_truths_hold_what_was_asked_for_and_no_case_tells_its_own(folder: Path) -> None:
    truths = open_seal(folder)
    for truth in truths.values():
        assert (truth.severity > 0.0) == bool(truth.effects) == (truth.kind == "single")
        assert all(floor > 0.0 for floor in truth.floor_rad.values())
    names = {effect.name for truth in truths.values() for effect in truth.effects}
    public = [path for path in folder.rglob("*") if path.is_file() and "sealed" not in path.parts]
    assert not [path for path in public if any(name in path.read_text() for name in (*names, "severity", "salt"))]


def test_a_case_without_effect_leaves_its_floor_on_the_hold_out(folder: Path) -> None:
    for truth in open_seal(folder).values():
        if truth.kind == "nominal":
            for name, floor in truth.floor_rad.items():
                assert truth.hold.rms_true[name] < 3.0 * floor


def test_a_case_comes_out_the_same_when_it_is_made_again(folder: Path) -> None:
    name, truth = next((name, truth) for name, truth in open_seal(folder).items() if truth.kind == "single")
    index, plants = int(name[-4:]), tuple(range(len(PLANTS)))
    given = PLANTS[(index - 1) % len(PLANTS)].path.read_text()
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        made = make_case(Order(SEED, index, 2 * len(PLANTS), ("nominal", "single"), given, "real", plants))
    assert made["files"] == {path.name: path.read_text() for path in (folder / name).iterdir()}
    assert json.dumps(made["truth"]) == json.dumps(truth_to_json(truth))


def test_a_plant_file_that_is_given_decides_on_the_plant(tmp_path: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        make(Benchmark(3, 1, ("nominal",), PLANTS[-1].path, "real"), tmp_path / "x")
    assert f'plant = "{PLANTS[-1].name}"' in (tmp_path / "x/case-0001/hold-1.toml").read_text()


# Counting is no part of exact readings; a motor is warm after longer; where friction falls faster than damping rises a pitch that is hardly
# held makes much of how its bearing gave at the start.
NOT_FLOWN = ("theta_sensor.quantization", "rotor.warmup", "pitch.stribeck")


def flying(together: BoundPlant, bound: BoundPlant, sizes: Sizes) -> BoundPlant:
    """The plant with one effect: by the kernel of `together` where that has it."""
    return with_values(together, sizes) if sizes.keys() <= together.effects.keys() else with_effects(bound, sizes)


@pytest.mark.parametrize("plant", [ANTX_2DOF_DRONE, DC_MOTOR], ids=["drone", "motor"])
def test_the_librarys_formula_with_a_truths_parameters_flies_what_the_rig_flew(plant: RealPlant) -> None:
    """Free for 4 s from the same start, at most a fifth of what the effect changes is left: formulas, stages and steps are other ones."""
    bound, lab = bind(load_plant(plant.path)), lab_of(plant, 4.0, DAHL, closed=False)
    effects = [effect for effect in CATALOGUES[plant.name].known if effect.name not in NOT_FLOWN]
    # One kernel flies all effects on the equations, the others at next to no size.
    together = combined(bound, [effect.name for effect in effects if library(bound)[effect.name].on_equations])
    order = [ORDER[plant.name].index(str(state)) for state in bound.model.states]
    start = flown(lab, {}).apparent[0][order]
    for effect in effects:
        shape, m = begun_early(effect), float(np.clip(3.0, *effect.bounds))
        record = flown(lab, effect.settings(m, shape))
        u = np.column_stack([record.u_V, np.zeros(len(record.u_V))])
        visited = Visited(record.t_s, *record.apparent.T, *u.T, 0.0, np.zeros_like)
        found = {effect.name: {symbol: entry.value for symbol, entry in effect.equivalent(m, shape, visited).items()}}
        x0 = start if effect.sensor else record.apparent[0][order]
        left = []
        for model in (bound, flying(together, bound, found)):
            run = simulate(
                model, record.t_s, x0, record.u_V, Conditions(resolution=[0.0] * len(plant.outputs), substeps=4)
            )
            left.append(np.std(run.y[:, 0] - record.exact_rad[:, 0]))
        assert left[1] < left[0] / 5.0, effect.name
