"""The numbers of the imported logs against facts that are known of the rigs: units, times, limits, locked axes, lost samples."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from recordings.datasets.matlab import array, stream, variables
from sim.simulate import Conditions, simulate
from tests.plants import bound
from tests.recorded import dataset_folder, recorded

PITCH_COUNT_RAD, YAW_COUNT_RAD = 2 * np.pi / 2048, 2 * np.pi / 4096


def off_the_grid(values: np.ndarray, step: float) -> float:
    """Largest distance of the values from multiples of `step`, in steps."""
    return float(np.nanmax(np.abs(values / step - np.round(values / step))))


def test_quanser_angles_are_encoder_counts_every_2_ms() -> None:
    log = recorded("quanser_aero", "model_verification")
    np.testing.assert_allclose(np.diff(log.t_s), 0.002, atol=1e-9)
    assert off_the_grid(log.column("theta_rad"), PITCH_COUNT_RAD) < 1e-6
    assert off_the_grid(log.column("psi_rad"), YAW_COUNT_RAD) < 1e-6
    assert set(log.extra) == {"omega_M_rad_s", "omega_T_rad_s"}
    main, tail = log.u[:, 0], log.u[:, 1]
    assert (main[(log.t_s >= 5.0) & (log.t_s < 15.0)] == 10.0).all()
    assert (tail[(log.t_s >= 15.0) & (log.t_s < 25.0)] == 10.0).all()
    assert main.sum() == tail.sum() == 50_000.0  # 10 V for 10 s each and nothing else


@pytest.mark.parametrize(
    ("record", "locked", "not_recorded", "simulated"),
    [
        ("model_verification", (), (), False),
        ("full_model", (), (), True),
        ("reduced_model", (), (), True),
        ("dynamic_coupling_free_pitch", (), ("psi_rad",), False),
        ("dynamic_coupling_locked_pitch", ("pitch",), ("psi_rad",), False),
        ("pitch_coefficients", ("yaw",), ("psi_rad",), False),
        ("yaw_coefficients", ("pitch",), ("theta_rad",), False),
    ],
)
def test_quanser_logs_say_what_was_locked_measured_and_simulated(
    record: str, locked: tuple[str, ...], not_recorded: tuple[str, ...], simulated: bool
) -> None:
    log = recorded("quanser_aero", record)
    assert log.source is not None
    assert (log.locked, log.loop, log.source.simulated) == (locked, "open", simulated)
    for output in log.columns.outputs:
        assert np.isnan(log.column(output)).all() == (output in not_recorded)


def test_aeroshield_repeats_itself_to_the_published_floor() -> None:
    # Published: 0.037 and 0.034 rad rms between the two runs of the identification and the validation input.
    floors = []
    for first, second in (("ident_data", "Identification_Data2"), ("val_data", "Validation_Data2")):
        one, two = recorded("aeroshield", first), recorded("aeroshield", second)
        np.testing.assert_allclose(one.u[:-1], two.u[:-1], atol=1e-5)
        floors.append(float(np.sqrt(np.mean((one.y - two.y) ** 2))))
    assert floors == pytest.approx([0.037, 0.034], abs=0.0005)


def test_aeroshield_angles_step_by_their_sensor() -> None:
    printed = 0.5e-5  # rounded to five decimals
    for record in ("ident_data", "val_data"):
        log = recorded("aeroshield", record)
        assert off_the_grid(log.y, 1.5 * np.pi / 4096) * 1.5 * np.pi / 4096 < 1.01 * printed
    assert off_the_grid(recorded("aeroshield", "Identification_Data").y, 2 * np.pi / 4096) < 1e-6


def test_aeroshield_older_runs_swing_as_the_later_ones_at_their_own_rate() -> None:
    # A pendulum fitted by free-running simulation: the same arm, so the same gravity over length within 20 %, near 70 s^-2.
    # Read at 10 ms like the others, the older run would give (15/10)^2 = 2.25 times as much.
    plant = bound("aeroshield_two_clocks")

    def gravity_over_length(record: str) -> float:
        log = recorded("aeroshield", record)
        x0 = [log.y[0, 0], 0.0]

        def error(guess: np.ndarray) -> np.ndarray:
            run = simulate(plant, log.t_s, x0, log.u, Conditions(p=[*guess, 3.7], resolution=0.0, keep="y"))
            assert run.y is not None
            return (run.y - log.y).ravel()

        return float(least_squares(error, [20.0, 70.0, 1.5], x_scale=[5.0, 20.0, 1.0]).x[1])

    assert gravity_over_length("Identification_Data") == pytest.approx(gravity_over_length("ident_data"), rel=0.2)


def test_a_reference_that_lost_a_digit_on_the_serial_line_is_nan() -> None:
    log = recorded("aeroshield", "EMPC_due")
    reference = log.extra["theta_ref_rad"]
    assert int(np.isnan(reference).sum()) == 70
    assert set(np.unique(reference[np.isfinite(reference)])) == {0.0, 0.35, 0.8, 1.0, 1.2, 1.3}
    assert np.isfinite(log.u).all()
    assert log.loop == "closed"


def test_antx_rows_stand_at_the_command_stamps_and_read_samples_there() -> None:
    record = "Lab01_part1__log_1_2024-5-22-17-22-32_2dd"
    log = recorded("antx_2dof_drone", record)
    found = variables((dataset_folder("antx_2dof_drone") / f"{record}.mat").read_bytes(), record)
    stamps_s, torque = stream(found, "M", record)
    np.testing.assert_array_equal(log.t_s, stamps_s)
    np.testing.assert_array_equal(log.u[:, 0], torque)
    for output, name in (("theta_rad", "theta"), ("q_rad_s", "q")):
        times_s, values = stream(found, name, record)
        column = log.column(output)
        rows = np.flatnonzero(np.isfinite(column))
        assert rows.size > 0.99 * column.size
        nearest = np.abs(times_s[None, :] - log.t_s[rows, None]).argmin(axis=1)
        # On the line between the samples about the row's time, so never outside them.
        earlier = np.clip(np.searchsorted(times_s, log.t_s[rows], side="right") - 1, 0, times_s.size - 2)
        share = (log.t_s[rows] - times_s[earlier]) / (times_s[earlier + 1] - times_s[earlier])
        line = (1.0 - share) * values[earlier] + share * values[earlier + 1]
        inside = (share >= 0.0) & (share <= 1.0)
        np.testing.assert_allclose(column[rows][inside], line[inside], atol=1e-9)
        assert np.abs(times_s[nearest] - log.t_s[rows]).max() < 0.002
        assert len(np.unique(nearest)) == rows.size  # no sample is used twice
    assert np.diff(log.t_s).max() > 0.06  # the record's longest gap


def test_antx_plant_holds_the_published_parameters() -> None:
    file = "identified_model_data.mat"
    published = variables((dataset_folder("antx_2dof_drone") / file).read_bytes(), file)
    plant = bound("antx_2dof_drone").plant
    for name in ("omega_n", "xi", "mu", "tau"):
        assert plant.parameters[name].value == pytest.approx(float(array(published, name, file)), rel=1e-9)


def test_emps_voltage_is_what_its_published_controller_demands() -> None:
    # v = kp kv (qg - q) - kv q', kp = 160.18 1/s, kv = 243.45 V s/m; the speed from a cubic through 61 samples: within 0.15 V rms, of 4 V.
    log = recorded("emps", "DATA_EMPS")
    assert log.sample_period_s == 0.001
    q, wanted, voltage = log.y[:, 0], log.extra["q_ref_m"], log.u[:, 0]
    offsets = np.arange(-30, 31) * 0.001
    slope = np.linalg.pinv(np.vander(offsets, 4, increasing=True))[1]
    speed = np.convolve(q, slope[::-1], mode="same")
    error = (160.18 * 243.45 * (wanted - q) - 243.45 * speed - voltage)[50:-50]
    assert np.sqrt(np.mean(error**2)) < 0.15


def test_pamh_numbers_survive_decimal_commas_and_mixed_signs() -> None:
    for record in ("PAMH_I_PD_EquiE_G3", "PAMH_PID_EquiE_G3-n19", "PAMH_REI_EquiE_G3"):
        log = recorded("pamh_aeropendulum", record)
        np.testing.assert_allclose(np.diff(log.t_s), 0.02, atol=1e-9)
        assert log.t_s[0] == -0.4
        assert set(np.unique(log.extra["theta_ref_rad"])) == {0.0, 0.6}
        assert 0.0 <= log.u.min() <= log.u.max() <= 2.0
        settled = (log.t_s > 8.0) & (log.t_s < 10.0)
        assert np.abs(log.y[settled, 0] - 0.6).max() < 0.012  # the controllers have integral action
        before, within = log.u[(log.t_s > 9.5) & (log.t_s < 10.0)], log.u[np.isclose(log.t_s, 10.04)]
        assert within.item() - before.mean() == pytest.approx(0.2, abs=0.06)  # the logged disturbance is in the voltage
    log = recorded("pamh_aeropendulum", "PAMH_3set")
    assert log.loop == "open"
    assert set(np.unique(log.u)) == {0.0, 1.7}


@pytest.mark.parametrize(
    ("record", "fast_ppm"),
    [("physicalMeasurement_2025_12_18_18_10_41", -32.0), ("impulse_char_2026_01_24_22_49_36", 1437.0)],
)
def test_two_clocks_board_time_is_even_where_host_time_bunches(record: str, fast_ppm: float) -> None:
    log = recorded("aeroshield_two_clocks", record)
    host_s = log.extra["t_host_s"]
    assert np.diff(log.t_s).min() > 0.7 * log.sample_period_s
    fresh = np.concatenate([[True], np.diff(host_s) > 0.5 * log.sample_period_s])
    rate = (log.t_s[fresh][-1] - log.t_s[fresh][0]) / (host_s[fresh][-1] - host_s[fresh][0])
    assert (rate - 1.0) * 1e6 == pytest.approx(fast_ppm, abs=25.0)  # 0.5 ms of jitter at either end over 30 s
    assert log.source is not None
    assert any(f"{fast_ppm:+.0f} ppm" in note for note in log.source.notes)
    assert set(np.unique(log.u)) == {0.0, 3.7}
    assert off_the_grid(log.y, 1.5 * np.pi / 4096) < 1e-3


def test_two_clocks_lost_samples_stay_gaps_in_time() -> None:
    log = recorded("aeroshield_two_clocks", "impulse_char_2026_01_24_22_48_45")
    steps = np.diff(log.t_s)
    assert steps.max() == pytest.approx(0.267, abs=0.001)
    assert int((steps > 0.075).sum()) == 4


def test_the_coil_s_duty_climbs_a_ladder_and_its_current_follows_the_published_resistance() -> None:
    log = recorded("maglev_coil", "c12")
    np.testing.assert_allclose(np.diff(log.t_s), 0.005, atol=1e-9)
    np.testing.assert_allclose(np.unique(log.u), np.arange(11) / 10, atol=1e-6)
    # The last 0.5 s of full duty: 11.658 V over 4.17 V/A, less what the driver's dead band takes.
    full = log.u[:, 0] == 1.0
    assert np.mean(log.y[full][100:, 0]) == pytest.approx(11.658 / 4.17, rel=0.06)


@pytest.mark.parametrize("record", ["sac", "es05", "ddp", "dircol"])
def test_the_pendulum_hangs_at_zero_at_first_and_is_read_in_whole_steps(record: str) -> None:
    log = recorded("torque_limited_pendulum", record)
    assert abs(log.y[0, 0]) < 0.002
    assert off_the_grid(log.y[:, 0] - log.y[0, 0], 2.914473e-3) < 1e-3
    assert np.abs(log.u).max() < 5.0
    assert log.source is not None
    assert log.source.licence == "BSD-3-Clause"
