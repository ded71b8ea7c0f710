"""Frequencies against the exact frequency equation of the continuous beam."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq
from twins import assemble

from models.beam.parameters import Params
from models.beam.structure.finite_element import modes

RIGID = Params(lateral_support_stiffness=1e9, rotational_support_stiffness=1e6)


def frequency_determinant(wave_number, p):
    """Vanishes at the natural frequencies of a sprung-free Euler-Bernoulli beam.

    Deflection A cos bx + B sin bx + C exp(-bx) + D exp(b(x - L)), none of which overflows. At the
    spring EI w''' = -k_tra w and EI w'' = k_rot w'; at the free end w'' = w''' = 0.
    """
    b, length = wave_number, p.length
    c, s, e = np.cos(b * length), np.sin(b * length), np.exp(-b * length)
    tra = p.lateral_support_stiffness / (p.flexural_rigidity * b**3)
    rot = p.rotational_support_stiffness / (p.flexural_rigidity * b)
    return np.linalg.det(
        [
            [tra, -1, tra - 1, (tra + 1) * e],
            [-1, -rot, 1 + rot, (1 - rot) * e],
            [-c, -s, e, 1],
            [s, -c, -e, 1],
        ]
    )


def exact_frequencies(p, count):
    """Return the lowest angular frequencies [rad s-1]."""
    grid = np.linspace(0.05, np.pi * (count + 1), 400 * count) / p.length
    values = [frequency_determinant(b, p) for b in grid]
    at = np.flatnonzero(np.diff(np.sign(values)))[:count]
    roots = [
        brentq(frequency_determinant, grid[i], grid[i + 1], (p,), xtol=1e-15, rtol=1e-15)
        for i in at
    ]
    return np.array(roots) ** 2 * np.sqrt(p.flexural_rigidity / p.mass_per_length)


def frequencies(p, elements, count=None):
    return modes_of_one(p, elements, count).frequency[0]


def modes_of_one(p, elements, count=None):
    arrays = (np.array([value]) for value in p[:5])
    return modes(*arrays, elements, count)


def test_the_exact_equation_gives_the_textbook_cantilever():
    """Blevins' roots lambda L of cos cosh = -1."""
    frequencies_found = exact_frequencies(RIGID._replace(lateral_support_stiffness=1e15), 3)
    wave_numbers = np.sqrt(
        frequencies_found * np.sqrt(RIGID.mass_per_length / RIGID.flexural_rigidity)
    )
    np.testing.assert_allclose(
        wave_numbers * RIGID.length, [1.87510407, 4.69409113, 7.85475744], rtol=3e-5
    )


def test_frequencies_at_ten_elements():
    """The errors of modes 1, 2 and 6 at the nominal mesh, to the digit known."""
    error = frequencies(Params(), 10, 6) / exact_frequencies(Params(), 6) - 1
    np.testing.assert_allclose(error[[0, 1, 5]], [7e-7, 3e-5, 4e-3], rtol=0.1)
    assert (error > 0).all()


@pytest.mark.parametrize("p", [Params(), RIGID, Params(rotational_support_stiffness=15.0)])
def test_frequencies_converge_with_the_fourth_power_of_the_element(p):
    truth = exact_frequencies(p, 4)
    coarse, fine = (frequencies(p, n, 4) / truth - 1 for n in (10, 20))
    np.testing.assert_allclose(np.log2(coarse / fine), 4, atol=0.15)


@pytest.mark.parametrize("elements", [1, 3, 10])
def test_modes_match_the_assembled_matrices(elements):
    """Frequencies and tip values of the mass-normalised modes, all of them."""
    p = Params()
    beam = assemble(p, elements)
    square, shape = eigh(beam.stiffness, beam.mass)
    beam_modes = modes_of_one(p, elements)
    np.testing.assert_allclose(beam_modes.frequency[0], np.sqrt(square), rtol=1e-9)
    np.testing.assert_allclose(beam_modes.tip[0], np.abs(shape[beam.tip]), rtol=1e-9, atol=1e-8)


def test_the_fundamental_is_exact_on_a_fine_mesh():
    """Rounding must not grow with the mesh, as it does in a solver of K x = w^2 M x."""
    error = frequencies(Params(), 40, 1) / exact_frequencies(Params(), 1) - 1
    assert abs(error[0] - 7e-7 / 4**4) < 1e-9


def test_rows_are_independent():
    """A batch gives each beam what it gets alone."""
    p = Params()
    both = modes(*(np.array([value, 1.1 * value]) for value in p[:5]), 10)
    alone = modes(*(np.array([1.1 * value]) for value in p[:5]), 10)
    np.testing.assert_array_equal(both.frequency[1], alone.frequency[0])
    np.testing.assert_array_equal(both.tip[1], alone.tip[0])
