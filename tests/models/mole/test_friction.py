"""Dry friction at two interfaces, against what Filippov's conditions leave."""

import itertools

import numpy as np
import pytest

from models.mole.parameters import FORMULATIONS, Params
from models.mole.theory.friction import bar_hold, decide, mole_hold, response
from models.mole.theory.system import mole

RNG = np.random.default_rng(17)


def moles(formulation, count):
    for _ in range(count):
        factors = np.exp(RNG.uniform(-1.5, 1.5, size=4))
        p = Params()
        yield mole(
            p._replace(
                bar_mass=p.bar_mass * factors[0],
                mole_mass=p.mole_mass * factors[1],
                bar_friction=p.bar_friction * factors[2],
                mole_friction=p.mole_friction * factors[3],
            ),
            formulation,
        )


def situations(q, count):
    """Velocities that are often zero, and forces near all limits."""
    reach = 2 * (q.bar_limit + q.mole_limit)
    for _ in range(count):
        v, x = RNG.normal(size=2) * RNG.integers(0, 2, size=2)
        yield v, x, RNG.uniform(-reach, reach) * RNG.choice([0.1, 0.5, 1.0])


def solved(q, printed, bar, ground, force):
    """Return v', x', T1, T2 of a mode from (17): two equations and, of each interface, one more."""
    coupling = 0.0 if printed else 1 / q.mole_mass
    rows = [[1, 0, 1 / q.mass, -coupling], [0, 1, -1 / q.mole_mass, 1 / q.mole_mass]]
    right = [force / q.mass, -force / q.mole_mass]
    for at, (slip, limit) in enumerate([(bar, q.bar_limit), (ground, q.mole_limit)]):
        row = np.zeros(4)
        row[2 + at if slip else at] = 1
        rows.append(row)
        right.append(slip * limit)
    return np.linalg.solve(np.array(rows), np.array(right))


def admissible(q, printed, v, x, force):
    """Return all modes that contradict nothing."""
    for bar, ground in itertools.product((-1, 0, 1), repeat=2):
        if (v != 0 and bar != np.sign(v)) or (x != 0 and ground != np.sign(x)):
            continue
        dv, dx, t_1, t_2 = solved(q, printed, bar, ground, force)
        right = abs(t_1) <= q.bar_limit * (1 + 1e-12) and abs(t_2) <= q.mole_limit * (1 + 1e-12)
        right &= v != 0 or bar == 0 or bar * dv > 0
        right &= x != 0 or ground == 0 or ground * dx > 0
        if right:
            yield bar, ground


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_the_mode_is_the_only_one_that_contradicts_nothing(formulation):
    seen = set()
    for q in moles(formulation, 40):
        for v, x, force in situations(q, 50):
            modes = list(admissible(q, formulation == "as-printed", v, x, force))
            assert modes == [decide(q, v, x, force)]
            seen.add((v == 0, x == 0, *modes[0]))
    assert len(seen) == 4 + 6 + 6 + 5  # with both at rest the mole slips against the bar only


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_accelerations_and_limits_are_those_of_the_equations(formulation):
    printed = formulation == "as-printed"
    for q in moles(formulation, 10):
        for force in RNG.normal(scale=q.mole_limit, size=20):
            for bar, ground in itertools.product((-1, 0, 1), repeat=2):
                dv, dx, t_1, t_2 = solved(q, printed, bar, ground, force)
                a, b, d, e = response(q, bar, ground)
                scale = dict(rtol=0, atol=1e-12 * (abs(force) + q.mole_limit) / q.mass)
                np.testing.assert_allclose([a * force + b, d * force + e], [dv, dx], **scale)
                if bar == 0:
                    hold = bar_hold(q, ground)
                    assert hold.limit == q.bar_limit
                    np.testing.assert_allclose(hold.gain * force + hold.offset, t_1, rtol=1e-12)
                elif ground == 0:
                    hold = mole_hold(q, bar)
                    assert hold.limit == q.mole_limit
                    np.testing.assert_allclose(hold.gain * force + hold.offset, t_2, rtol=1e-12)


def friction_power(q, v, x, force):
    """Return the rise of kinetic energy less the power of F."""
    a, b, d, e = response(q, *decide(q, v, x, force))
    dv, dx = a * force + b, d * force + e
    return q.bar_mass * (v + x) * (dv + dx) + q.mole_mass * x * dx - force * v


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_friction_dissipates_but_as_printed_it_also_creates_energy(formulation):
    powers = [
        friction_power(q, v, x, force)
        for q in moles(formulation, 40)
        for v, x, force in situations(q, 50)
    ]
    assert (max(powers) > 0.1) == (formulation == "as-printed")
    assert formulation == "as-printed" or max(powers) < 1e-13
