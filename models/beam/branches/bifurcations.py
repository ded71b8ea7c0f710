"""What can happen to a periodic orbit as a parameter changes, by the orbits on either side.

Folds, period doublings, Neimark-Sacker and symmetry-breaking bifurcations show in a multiplier that
crosses the unit circle. Grazing, where a contact is born or dies, shows in the trajectory alone:
there the Jacobian of the period map is continuous, but it leaves its value like the square root of
the distance, so that a fold can follow at once, without any warning by the multipliers before.
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from models.beam.branches.orbits import Orbit

Kind = Literal["fold", "period-doubling", "neimark-sacker", "symmetry-breaking", "grazing"]

_MERGED = 1e-2  # difference of the sites' work, relative to their sum, next to a symmetric orbit
_SHALLOW = 0.05  # depth of a contact just born, relative to the deepest
_REAL = 1e-9  # largest imaginary part of a real multiplier


class Event(NamedTuple):
    """Something that happens between two points of a branch.

    Attributes
    ----------
    kind : str
        ``fold``, ``period-doubling``, ``neimark-sacker``, ``symmetry-breaking`` (a branch of
        symmetric orbits parts from, or meets, those of two asymmetric ones) or ``grazing``.
    value : float
        Of the parameter.
    before, after : Orbit
        On either side, as near as was asked for; None where there is no orbit beyond.
    """

    kind: Kind
    value: float
    before: Orbit
    after: Orbit | None

    @property
    def loses_stability(self) -> bool:
        """Whether the orbit is stable before and not after."""
        beyond = self.after is not None and self.after.is_stable
        return self.before.is_stable and not beyond


def kind_of(before: Orbit, after: Orbit, turns: bool) -> Kind:
    """Return what happens between two orbits that are neighbours to within rounding of the search.

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
    """Return what makes an orbit lose its stability, None if it does not.

    Parameters
    ----------
    events : sequence of Event
        On the way, in order.

    Returns
    -------
    str or None
        Grazing, where the multipliers cross the unit circle while the contact that it gave birth to
        is still shallow; else the kind of the event itself.
    """
    grazed = False
    for event in events:
        grazed = grazed or event.kind == "grazing"
        if event.loses_stability:
            shallow = event.before.clearance < _SHALLOW * event.before.peak.max()
            return "grazing" if grazed and shallow else event.kind
    return None
