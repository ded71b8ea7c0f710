"""The labelled time history."""

import numpy as np
import pytest

from models.vibrator.batch import batch
from models.vibrator.equations.system import system
from models.vibrator.exact import propagator
from models.vibrator.parameters import Params, Settings
from models.vibrator.trajectory import simulate


@pytest.mark.parametrize("kinematics", ["small", "exact"])
def test_it_shows_the_start(kinematics):
    p = Params(support_half_spacing=1.5)
    settings = Settings(kinematics=kinematics, run_up=3.0, tolerance=1e-10)
    history = simulate(p, settings)
    values = {name: series for name, (_, _, series) in history.quantities.items()}
    assert history.time[0] == 0
    assert history.time[-1] == 3
    assert {len(series) for series in values.values()} == {len(history.time)}
    assert values["speed_1"][0] == 0
    assert 140 < values["speed_1"][-1] < 157
    hanging = -2 * (np.pi / 2 + p.working_angle)
    np.testing.assert_allclose(values["disphasing_angle"][0], hanging, rtol=1e-14)
    m = system(p, kinematics)
    end = propagator.propagate(m, propagator.start(p, m), 3.0, 1e-10).state
    got = [values[name][-1] for name in ("x", "y", "alpha")]
    np.testing.assert_allclose(got, end[:3], rtol=0, atol=1e-9)
    # A rigid deck: its ends' displacements along xi differ by its rotation alone.
    tilt = values["displacement_right"] - values["displacement_left"]
    expected = values["alpha"] * np.sin(p.working_angle)
    if kinematics == "exact":
        expected = np.cos(values["alpha"] - p.working_angle) - np.cos(p.working_angle)
    np.testing.assert_allclose(tilt, 3 * expected, rtol=0, atol=1e-14)
    along = values["x"] * np.cos(p.working_angle) + values["y"] * np.sin(p.working_angle)
    middle = (values["displacement_right"] + values["displacement_left"]) / 2
    np.testing.assert_allclose(middle, along, atol=1e-15)


POINTS = ((-1.5, 0.0), (1.5, 0.0), (0.7, -0.9))


def points_of(history, count):
    """Return where points are beyond rest, shape (count, 2, k)."""
    names = [[f"point_{i}_{axis}" for axis in "xy"] for i in range(1, count + 1)]
    return np.array([[history.quantities[name][2] for name in pair] for pair in names])


@pytest.mark.parametrize("kinematics", ["small", "exact"])
def test_it_shows_points_of_the_body(kinematics):
    p = Params(support_half_spacing=1.5, support_offset=-4.0)
    settings = Settings(kinematics=kinematics, run_up=2.0, body_points=POINTS)
    history = simulate(p, settings)
    values = {name: series for name, (_, _, series) in history.quantities.items()}
    moved = points_of(history, 3)
    axis = np.array([np.cos(p.working_angle), np.sin(p.working_angle)])
    for ends, name in ((moved[0], "displacement_left"), (moved[1], "displacement_right")):
        np.testing.assert_allclose(axis @ ends, values[name], rtol=0, atol=1e-15)
    # Seen from C a point turns by alpha, or in the frozen geometry moves across its lever.
    c = np.array([values["x"], values["y"]])
    alpha = values["alpha"]
    assert np.ptp(alpha) > 1e-3
    for point, motion in zip(POINTS, moved, strict=True):
        lever = complex(*point)
        turned = lever * (np.exp(1j * alpha) if kinematics == "exact" else 1 + 1j * alpha)
        expected = c + [(turned - lever).real, (turned - lever).imag]
        np.testing.assert_allclose(motion, expected, rtol=0, atol=1e-14)
    unit, meaning, _ = history.quantities["point_3_y"]
    assert unit == "m"
    assert meaning == "vertical displacement of the body point at (0.7, -0.9) m from C"


@pytest.mark.parametrize(("kinematics", "stretch"), [("small", 1e-6), ("exact", 0.0)])
def test_exact_kinematics_keep_the_distances_of_points(kinematics, stretch):
    p = Params(support_half_spacing=1.5, support_offset=-4.0)
    settings = Settings(kinematics=kinematics, run_up=2.0, body_points=POINTS)
    places = np.array(POINTS)[:, :, None] + points_of(simulate(p, settings), 3)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        distance = np.hypot(*(places[i] - places[j]))
        largest = abs(distance / np.hypot(*np.subtract(POINTS[i], POINTS[j])) - 1).max()
        assert stretch <= largest < stretch + 1e-4 if stretch else largest < 1e-14


def test_points_are_not_asked_for_by_default():
    history = simulate(Params(), Settings(run_up=1.0, tolerance=1e-4))
    assert not [name for name in history.quantities if name.startswith("point")]


def test_it_ends_at_ten_seconds_and_shows_feed_and_mount_where_there_are_any():
    plain = simulate(Params(), Settings(tolerance=1e-4))
    assert plain.time[-1] == 10
    assert "feed_height" not in plain.quantities
    p = Params(feed_mass=100.0, mount_stiffness=2e7)
    history = simulate(p, Settings(run_up=2.0, tolerance=1e-5))
    assert history.quantities["feed_height"][2].max() > 0
    assert history.quantities["feed_height"][2].min() == 0
    assert np.ptp(history.quantities["mount_displacement"][2]) > 1e-4


def test_it_stops_where_the_budget_ends():
    p = Params(mount_stiffness=1e17, mount_damping_ratio=1.0)
    history = simulate(p, Settings(run_up=1.0))
    assert history.time[-1] < 1
    assert np.isfinite(history.quantities["x"][2]).all()


def test_it_is_long_enough_to_show_the_motion_that_the_outputs_describe():
    late = Params(overload_capacity=0.3)  # synchronises after 11.6 s
    settings = Settings(run_up=14.0, tolerance=1e-6)
    outputs, _ = batch(np.array([late]), np.zeros(1, np.uint64), settings)
    history = simulate(late, settings)
    angle = history.quantities["disphasing_angle"][2][history.time > history.time[-1] - 0.5]
    mean = np.angle(np.exp(1j * angle).mean())
    assert mean == pytest.approx(outputs["disphasing_angle"][0], abs=0.01)
    never = Params(rated_torque_1=40.0, synchronous_speed_1=140.0, breakdown_speed_1=110.0)
    assert simulate(never, settings).time[-1] == 14
