"""Beams prepared for the exact propagator: their phases."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.exact.phases import Phase, phases
from models.beam.parameters import Settings
from models.beam.structure.modal import Array, Beams, free_reach, steady_response
from models.beam.structure.propagation import LONGEST

TRACE_STEPS = 200


class System(NamedTuple):
    """n beams with their phases; see `models.beam.structure.propagation.System`.

    Attributes
    ----------
    phases : tuple of (Phase, Phase)
        Free flight and contact of each beam.
    modal : ndarray, shape (n, m), complex
        Steady amplitude of each mode without contact.
    free_reach, beams, steps
        As there; steps are those of a trace.
    """

    phases: tuple[tuple[Phase, Phase], ...]
    modal: NDArray[np.complex128]
    free_reach: Array
    beams: Beams
    steps: int

    @property
    def longest(self) -> int:
        """`LONGEST`: the budget of events sets no limit."""
        return LONGEST

    def take(self, rows: NDArray[np.intp]) -> "System":
        """Return some of the beams."""
        chosen = tuple(self.phases[i] for i in rows)
        return System(
            chosen, self.modal[rows], self.free_reach[rows], self.beams.take(rows), self.steps
        )


def groups(beams: Beams, settings: Settings) -> Iterator[tuple[NDArray[np.intp], System]]:
    """Find the modes of n beams out of contact and in contact, all in one group."""
    rows = np.arange(len(beams.forcing))
    each = tuple(phases(beams, i) for i in range(len(rows)))
    steps = settings.steps_per_period or TRACE_STEPS
    modal = steady_response(beams)
    yield rows, System(each, modal, free_reach(beams), beams, steps)


def finer(system: System, state: Array) -> Iterator[tuple[NDArray[np.intp], System, Array]]:
    """Yield nothing: there are no steps to refine."""
    return iter(())
