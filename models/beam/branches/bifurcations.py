"""Bifurcations and grazing of a periodic orbit, identified from the orbits on either side.

At folds, period doublings, Neimark-Sacker and symmetry-breaking bifurcations a multiplier crosses
the unit circle. Grazing, where a contact appears or disappears, shows only in the trajectory: there
the Jacobian of the period map is continuous, but changes like the square root of the distance, so
that a fold can follow at once, without a warning by the multipliers before.
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from models.beam.branches.orbits import Orbit

Kind = Literal["fold", "period-doubling", "neimark-sacker", "symmetry-breaking", "grazing"]

_MERGED = 1e-2  # difference of the sites' work, relative to their sum, next to a symmetric orbit
_SHALLOW = 0.05  # depth of a new contact, relative to the deepest
_REAL = 1e-9  # largest imaginary part of a real multiplier


class Event(NamedTuple):
    """An event between two points of a branch.

    Attributes
    ----------
    kind : str
        ``fold``, ``period-doubling``, ``neimark-sacker``, ``symmetry-breaking`` (the branch of
        symmetric orbits meets those of two asymmetric ones) or ``grazing``.
    value : float
        Of the parameter.
    before, after : Orbit
        On either side, within the tolerance; None where there is no orbit beyond.
    """

    kind: Kind
    value: float
    before: Orbit
    after: Orbit | None

    @property
    def loses_stability(self) -> bool:
        """Whether the orbit is stable before the event and not after it."""
        beyond = self.after is not None and self.after.is_stable
        return self.before.is_stable and not beyond


def kind_of(before: Orbit, after: Orbit, turns: bool) -> Kind:
    """Return the kind of event between two orbits that enclose it within the tolerance.

    Parameters
    ----------
    before, after : Orbit
    turns : bool
        Whether the branch turns back between them.

    Returns
    -------
    str
        As in `Event`.
    """
    if before.contacts.tolist() != after.contacts.tolist():
        return "grazing"
    critical = after.multipliers[np.argmin(np.abs(np.abs(after.multipliers) - 1))]
    if not turns and abs(critical.imag) > _REAL:
        return "neimark-sacker"
    if not turns and critical.real < 0:
        return "period-doubling"
    can_be_symmetric = before.gaps[0] == before.gaps[1] and before.period % 2 == 1
    merged = abs(before.work[0] - before.work[1]) <= _MERGED * before.work.sum()
    return "symmetry-breaking" if can_be_symmetric and merged else "fold"


def cause_of_loss(events: Sequence[Event]) -> Kind | None:
    """Return the event by which an orbit loses its stability, None if it does not.

    Parameters
    ----------
    events : sequence of Event
        Along the branch, in order.

    Returns
    -------
    str or None
        Grazing, if the multipliers cross the unit circle while the contact that appeared there is
        still shallow; else the kind of the event itself.
    """
    grazed = False
    for event in events:
        grazed = grazed or event.kind == "grazing"
        if event.loses_stability:
            shallow = event.before.clearance < _SHALLOW * event.before.peak.max()
            return "grazing" if grazed and shallow else event.kind
    return None
