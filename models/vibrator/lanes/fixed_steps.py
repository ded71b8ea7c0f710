"""The fast propagator: n rigid machines advanced by steps of fixed length, with notes of them."""

import math

import numpy as np

from models.numerics.blocks import LANES, aligned
from models.numerics.jit import kernel, spliced
from models.vibrator.lanes.machines import Machines
from models.vibrator.lanes.notes import (
    CONSTANTS_ROOM,
    COS,
    NOTES,
    NOTES_ROOM,
    SIN,
    begin,
    note_entries,
    note_step,
)
from models.vibrator.lanes.packed import STATE, Array, load, store
from models.vibrator.lanes.steps import AT, SIZE, prepare, step_5, step_8

_DEAD = 1e-140


@spliced
def _advance(take_step, constants, h, state, target, steps, band, notes, work):
    c, w, note, step_size, aim = work
    y = w[AT.position : AT.position + STATE * LANES]
    for first in range(0, state.shape[0], LANES):
        load(constants, first, c)
        load(state, first, y)
        # Decayed vibrations: numbers near underflow would be ten times slower. NaN is kept.
        for j in range(STATE * LANES):
            y[j] = 0.0 if abs(y[j]) <= _DEAD else y[j]
        load(h, first, step_size)
        load(target, first, aim)
        for lane in range(LANES):
            angle = c[4 * LANES + lane]
            c[COS * LANES + lane], c[SIN * LANES + lane] = math.cos(angle), math.sin(angle)
        prepare(c, step_size, w)
        begin(w, aim, note)
        for step in range(steps):
            take_step(w)
            note_step(c, w, note)
            note_entries(w, aim, float(step), band, note)
        store(y, first, state)
        store(note, first, notes)


@kernel
def _advance_5(constants, h, state, target, steps, band, notes, work):
    _advance(step_5, constants, h, state, target, steps, band, notes, work)


@kernel
def _advance_8(constants, h, state, target, steps, band, notes, work):
    _advance(step_8, constants, h, state, target, steps, band, notes, work)


def advance(
    machines: Machines,
    state: Array,
    h: Array,
    target: Array,
    steps: int,
    band: float,
    accurate: bool,
) -> Array:
    """Advance n machines by some steps.

    Parameters
    ----------
    machines : Machines
    state : ndarray, shape (n, STATE)
        Updated in place.
    h : ndarray, shape (n,)
        Step [s].
    target : ndarray, shape (n,)
        Centre of the band of the disphasing angle [rad]; NaN for none.
    steps : int
    band : float
        Its half-width [rad].
    accurate : bool
        Steps of order 8 instead of 5. They cost twice as much; in run-ups of 5 s, six per turn have
        a measured error of 1e-8 rad, as have twenty of order 5.

    Returns
    -------
    ndarray, shape (n, NOTES)
        Sums over the steps of the motors' powers before bearing loss [W] and of the disphasing
        angle [rad]; smallest and largest rotation [rad], displacement along xi of the left and the
        right end of the deck [m], and disphasing angle [rad]; largest squared displacement of C
        [m2]; when the disphasing angle last entered its band [steps], -1 if it did not.
    """
    notes = np.empty((len(state), NOTES))
    work = (
        aligned(CONSTANTS_ROOM * LANES),
        aligned(SIZE),
        aligned(NOTES_ROOM * LANES),
        aligned(LANES),
        aligned(LANES),
    )
    aim = target[:, None]
    run = _advance_8 if accurate else _advance_5
    run(machines.constants, h[:, None], state, aim, steps, band, notes, work)
    return notes
