"""Branches of periodic orbits along a parameter, with their events."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from models.beam.branches.bifurcations import Event, cause_of_loss, kind_of
from models.beam.branches.orbits import TOLERANCE, Orbit, defect, orbit_of
from models.beam.exact.passage import passage
from models.beam.exact.tuning import Beam
from models.beam.structure.modal import Array
from models.numerics.continuation import Point, Steps, begin, follow, locate
from models.numerics.newton import Linear

POINTS = 2000  # of a branch, at most
_FIRST, _SMALLEST = 0.005, 1e-7  # steps, relative to the state


class Setting(NamedTuple):
    """A beam and its gaps at one value of a parameter.

    Attributes
    ----------
    beam : Beam
    gaps : ndarray, shape (2,)
        In initial gaps.
    gaps_by_value : ndarray, shape (2,)
    log_forcing_by_value : float
        Derivatives with respect to the parameter.
    """

    beam: Beam
    gaps: Array
    gaps_by_value: Array
    log_forcing_by_value: float


class Branch(NamedTuple):
    """A branch of orbits.

    Attributes
    ----------
    values : ndarray, shape (p,)
        Of the parameter.
    orbits : tuple of Orbit
        One at each.
    events : tuple of Event
        In order along the branch.
    end : str
        The event at which stability was lost, if that ends the branch; ``symmetry-breaking`` if
        asymmetric orbits become symmetric, beyond which there are only their mirror images;
        ``stop`` or ``start`` if it left the range; ``stalled`` if even the smallest step failed;
        ``budget`` after `POINTS` points.
    """

    values: Array
    orbits: tuple[Orbit, ...]
    events: tuple[Event, ...]
    end: str


class Path:
    """The periodic orbits of a beam in the variables of a continuation.

    The parameter of the continuation runs from 0 to `size` while that of the beam covers its range,
    so that it is comparable to the state.

    Parameters
    ----------
    setting : callable
        Returns the `Setting` at a value of the beam's parameter.
    orbit : Orbit
        At the first value.
    start, stop : float
        Range of values; the branch starts at the first towards the second.
    tolerance : float
        Of event location, relative to the range and to the state.
    """

    def __init__(
        self,
        setting: Callable[[float], Setting],
        orbit: Orbit,
        start: float,
        stop: float,
        tolerance: float,
    ):
        self._setting = setting
        self._period = orbit.period
        self._start = start
        self.size = float(np.linalg.norm(orbit.state))
        self._slope = (stop - start) / self.size
        self._nearness = tolerance * self.size
        self._tolerance = TOLERANCE * self.size

    def value(self, parameter: float) -> float:
        """Return the beam's parameter."""
        return self._start + self._slope * parameter

    def function(self, state: Array, parameter: float) -> Linear:
        """Return the change of a state over the period, with its derivatives."""
        at = self._setting(self.value(parameter))
        motion = passage(at.beam, state, at.gaps, periods=self._period)
        n = len(state)
        by_value = motion.tangents[:, n : n + 2] @ at.gaps_by_value
        by_value += motion.tangents[:, n + 2] * at.log_forcing_by_value
        return defect(motion, state, by_value * self._slope)

    def orbit(self, point: Point) -> Orbit:
        """Return the orbit at a point of the branch."""
        gaps = self._setting(self.value(point.parameter)).gaps
        return orbit_of(point.linear.about, point.state, gaps, self._period)

    def at(self, parameter: float, state: Array, direction: float) -> Point | None:
        """Return the point at a parameter, from a guess of its state."""
        return begin(self.function, state, parameter, direction, self._tolerance)

    def points(self, first: Point, largest: float) -> Iterator[Point]:
        """Yield the points of the branch in its range, the last one at its end."""
        before = first
        steps = (_FIRST * self.size, _SMALLEST * self.size, largest * self.size)
        for point in follow(self.function, first, Steps(*steps, self._tolerance)):
            edge = min(max(point.parameter, 0.0), self.size)
            if edge == point.parameter:
                yield point
                before = point
                continue
            way = point.parameter - before.parameter
            part = (edge - before.parameter) / way
            last = self.at(edge, before.state + part * (point.state - before.state), way)
            if last is not None:
                yield last
            return

    def events(self, a: Point, b: Point, before: Orbit, after: Orbit) -> list[Event]:
        """Return the events between two neighbours, in order."""
        tests: list[Callable[[Point], bool]] = []
        if _turns(a, b):
            tests.append(lambda p: _turns(a, p))
        if before.contacts.tolist() != after.contacts.tolist():
            tests.append(lambda p: p.linear.about.contacts.tolist() != before.contacts.tolist())
        outside = before.unstable_directions
        if after.unstable_directions != outside:
            tests.append(lambda p: self.orbit(p).unstable_directions != outside)
        by_kind: dict[str, tuple[float, Event]] = {}
        for has_changed in tests:
            near, far = locate(self.function, a, b, has_changed, self._nearness, self._tolerance)
            orbits = self.orbit(near), self.orbit(far)
            kind = kind_of(*orbits, _turns(near, far))
            way = float(a.tangent[:-1] @ (near.state - a.state))
            by_kind.setdefault(kind, (way, Event(kind, self.value(near.parameter), *orbits)))
        return [event for _, event in sorted(by_kind.values(), key=lambda pair: pair[0])]


def trace(path: Path, orbit: Orbit, stable_only: bool, largest: float) -> Branch:
    """Follow an orbit along a parameter.

    Parameters
    ----------
    path : Path
    orbit : Orbit
        At the first value.
    stable_only : bool
        Whether to end the branch where stability is lost.
    largest : float
        Largest step, relative to the range and to the state.

    Returns
    -------
    Branch
    """
    values, orbits, events = [path.value(0.0)], [orbit], list[Event]()
    point = path.at(0.0, orbit.state, 1.0)
    if point is None:
        return Branch(np.array(values), tuple(orbits), (), "stalled")
    for new in path.points(point, largest):
        after = path.orbit(new)
        for event in path.events(point, new, orbits[-1], after):
            merges = event.kind == "symmetry-breaking" and not orbits[-1].is_symmetric
            events.append(event._replace(after=None) if merges else event)
            cause = cause_of_loss(events) if stable_only else None
            if merges or cause:
                values.append(event.value)
                orbits.append(event.before)
                return Branch(np.array(values), tuple(orbits), tuple(events), cause or event.kind)
        values.append(path.value(new.parameter))
        orbits.append(after)
        point = new
        if len(orbits) == POINTS:
            return Branch(np.array(values), tuple(orbits), tuple(events), "budget")
    end = {0.0: "start", path.size: "stop"}.get(point.parameter, "stalled")
    return Branch(np.array(values), tuple(orbits), tuple(events), end)


def _turns(a: Point, b: Point) -> bool:
    """Return whether the branch turns back an odd number of times between two points."""
    return (a.tangent[-1] > 0) != (b.tangent[-1] > 0)
