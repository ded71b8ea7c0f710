"""Limit-state function: distance of rows beyond a threshold, in standard normal space."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr
from scipy.stats import skew

from uq.contract import Floats, Mask, Output, Status, censored_name
from uq.errors import InputError, nearest
from uq.execution.executor import Dispatcher, Executor
from uq.execution.options import RunOptions
from uq.execution.tally import MemoryStore
from uq.result.workload import Workload
from uq.sampling.named_values import unknown_name
from uq.study.definition import Study
from uq.study.evaluate import Chunk
from uq.study.row_sampling import Rows, physical, row_seeds
from uq.text.element_names import place_of, places

Evaluator = Callable[[Floats, NDArray[np.uint64]], Chunk]
"""``evaluator(x, seed)`` -> outputs of rows x (n, d), in declared order, with seeds (n,): the same
bits in any process."""


_RATIO = 3.0  # of largest to smallest value from which logarithms may be used


@contextmanager
def evaluator_of(study: Study, output: str, options: RunOptions) -> Iterator[Evaluator]:
    """Yield a function that runs the model of a study.

    Parameters
    ----------
    study : Study
    output : str
        The requested output: computed alone if the model supports it; empty for all outputs.
    options : RunOptions
    """
    cheap = output in study.model.cheap
    model = study.model.alone(output) if cheap else study.model
    none = Rows.without_design(np.empty((0, 0)), np.empty(0, np.uint64))
    wanted = output if cheap else ""
    work = Workload(
        model, study.model_reference, study.settings, 0, 1, block=none.part, output=wanted
    )
    with Executor(work, options) as executor:

        def evaluator(x: Floats, seed: NDArray[np.uint64]) -> Chunk:
            batch = work._replace(total=len(x), block=Rows.without_design(x, seed).part)
            store = MemoryStore(batch)
            executor.finish(Dispatcher(batch, options, store, executor.evaluate))
            return store.chunk()

        yield evaluator


class EventLimit(NamedTuple):
    """A limit: an output, or an element of it, above or below a threshold in the output's unit."""

    output: str
    threshold: float
    below: bool = False


class MarginScale(NamedTuple):
    """Scale of the distances beyond a limit, which keeps their sign.

    Attributes
    ----------
    limit : EventLimit
    logarithmic : bool
        Whether distances are those of logarithms, which is better for a skewed positive output.
    sd : float
        Standard deviation, by which distances are divided.
    """

    limit: EventLimit
    logarithmic: bool
    sd: float

    def __call__(self, margin: Floats) -> Floats:
        """Return scaled distances; the others may be infinite or NaN."""
        if self.logarithmic:
            sign = -1.0 if self.limit.below else 1.0
            with np.errstate(divide="ignore"):
                margin = sign * np.log1p(np.maximum(sign * margin / self.limit.threshold, -1.0))
        return margin / self.sd


def scale_of(limit: EventLimit, margin: Floats) -> MarginScale:
    """Return the scale of the distances beyond a limit, from those of the first rows."""
    margin = margin[np.isfinite(margin)]
    ratio = 1.0 + (-margin if limit.below else margin) / (limit.threshold or np.nan)
    logarithmic = bool(
        limit.threshold > 0
        and len(margin) > 1
        and ratio.min() > 0
        and ratio.max() > _RATIO * ratio.min()
        and abs(float(skew(np.log(ratio)))) < abs(float(skew(ratio)))
    )
    sd = float(MarginScale(limit, logarithmic, 1.0)(margin).std()) if len(margin) else 0.0
    return MarginScale(limit, logarithmic, sd or 1.0)


class LimitState:
    """Limit-state function: distance of rows beyond a threshold.

    Parameters
    ----------
    study : Study
    name : str
        An output, or one element of an output with dimensions.
    threshold : float
        In the output's unit.
    below : bool
        Whether the event is below it.
    evaluator : Evaluator
    first : int, optional
        Number of the first row, which with the seed gives the random numbers of a row.

    Attributes
    ----------
    output : Output
    limit : EventLimit
    parts : list of LimitState
        One for each limit.
    every : bool
        Whether an event requires all limits to be exceeded.
    dimension : int
        Of standard normal space.
    rows : int
        Rows computed so far.
    failed : int
        Rows that failed, or were censored before the threshold.
    undefined : int
        Rows with an undefined output.
    failures : dict of str to str
        Status label -> message of the first row with that status.
    """

    def __init__(
        self,
        study: Study,
        name: str,
        threshold: float,
        below: bool,
        evaluator: Evaluator,
        first: int = 0,
    ) -> None:
        self.study, self.threshold, self.below = study, threshold, below
        self.output, self._place = find_element(study, name)
        self.dimension = len(study.uncertain)
        self._column = name.partition("[")[0]
        self._evaluator = evaluator
        self._first = first
        self.limit = EventLimit(name, threshold, below)
        self.parts: list[LimitState] = [self]
        self.every = False
        self.rows = self.failed = self.undefined = 0
        self.failures: dict[str, str] = {}

    def physical(self, u: Floats) -> Floats:
        """Map points of standard normal space, (n, dimension), to the model's parameters."""
        return physical(self.study, np.clip(ndtr(u), 2.0**-54, 1.0 - 2.0**-53))

    def uncertain(self, u: Floats) -> Floats:
        """Map points of standard normal space to the uncertain parameters."""
        names = self.study.model.parameter_names
        return self.physical(u)[:, [names.index(name) for name in self.study.uncertain]]

    def __call__(self, u: Floats) -> Floats:
        """Evaluate the limit-state function at points of standard normal space.

        Parameters
        ----------
        u : ndarray, shape (n, dimension)
            Standard normal.

        Returns
        -------
        ndarray, shape (n,)
            Distance beyond the threshold, positive within the event; -inf for a row without a
            value, which counts as outside.
        """
        return self._margin(self._chunk(u))

    def each(self, u: Floats) -> Floats:
        """Return the distances beyond each limit, shape (n, limits); NaN without a value."""
        chunk = self._chunk(u)
        self._margin(chunk)
        judged = [part.judged(chunk) for part in self.parts]
        return np.stack(
            [np.where(failed | undefined, np.nan, margin) for margin, failed, undefined in judged],
            axis=1,
        )

    def _chunk(self, u: Floats) -> Chunk:
        # Every row has its own random numbers, as in a study.
        number = np.arange(len(u)) + self.rows + self._first
        chunk = self._evaluator(self.physical(u), row_seeds(self.study.design.seed, number))
        for label, (row, text) in chunk.failures.items():
            self.failures.setdefault(label, f"row {self.rows + row}: {text}")
        self.rows += len(u)
        return chunk

    def _margin(self, chunk: Chunk) -> Floats:
        margin, failed, undefined = self.judged(chunk)
        self.undefined += int(undefined.sum())
        self.failed += int(failed.sum())
        return margin

    def judged(self, chunk: Chunk) -> tuple[Floats, Mask, Mask]:
        """Return distances beyond the limit, and which rows failed or are undefined, (n,) each."""

        def column(name: str) -> NDArray[Any]:
            return chunk.columns[name].reshape(len(chunk.status), -1)[:, self._place]

        values = column(self._column)
        absent = self.output.is_absent(values)
        undefined = np.isnan(values) & (chunk.status == Status.OK)
        values = self.output.for_thresholds(values)
        margin = self.threshold - values if self.below else values - self.threshold
        if self.output.has_censored_flag:
            censored = column(censored_name(self._column)).astype(bool)
            absent |= censored & (values < self.threshold)
            if not self.below:
                margin[censored] = np.inf
        margin[absent] = -np.inf
        return margin, absent & ~undefined, undefined


class SystemState(LimitState):
    """Limit-state function of a system event: any or all of several limits.

    Parameters
    ----------
    study : Study
    limits : sequence of EventLimit
    every : bool
        Whether all limits must be exceeded (a parallel system) instead of any (a series system).
    evaluator : Evaluator
    first : int, optional

    Notes
    -----
    The distance is the smallest or largest of those beyond each limit, each scaled by the rows of
    the first call (`scale_of`). A row counts as failed only if the limits that have a value do not
    decide it.
    """

    def __init__(
        self,
        study: Study,
        limits: Sequence[EventLimit],
        every: bool,
        evaluator: Evaluator,
        first: int = 0,
    ) -> None:
        super().__init__(study, *limits[0], evaluator, first)
        self.parts = [LimitState(study, *limit, evaluator) for limit in limits]
        self.every = every
        self._scales: list[MarginScale] = []

    def judged(self, chunk: Chunk) -> tuple[Floats, Mask, Mask]:
        """Return distances beyond the limits, and which rows failed or are undefined, (n,) each."""
        parts = [part.judged(chunk) for part in self.parts]
        if not self._scales:
            self._scales = [
                scale_of(part.limit, margin)
                for part, (margin, *_) in zip(self.parts, parts, strict=True)
            ]
        margins = np.stack(
            [scale(margin) for scale, (margin, *_) in zip(self._scales, parts, strict=True)]
        )
        failed = np.stack([part[1] for part in parts])
        undefined = np.stack([part[2] for part in parts])
        if self.every:
            decided = ((margins <= 0) & ~failed & ~undefined).any(axis=0)
            lost = np.asarray(failed.any(axis=0) & ~decided)
            absent = np.asarray(undefined.any(axis=0) & ~decided & ~lost)
            return margins.min(axis=0), lost, absent
        lost = np.asarray(failed.any(axis=0) & ~(margins > 0).any(axis=0))
        return margins.max(axis=0), lost, np.asarray(undefined.all(axis=0))


def find_element(study: Study, name: str) -> tuple[Output, int]:
    """Find an output by its name or the name of an element; return it and the element index.

    Raises
    ------
    InputError
        When there is no such output or element, or it is a category.
    """
    model, output = study.model, name.partition("[")[0]
    if output not in model.outputs:
        problem = unknown_name("output", output, model, tuple(model.outputs))
        raise InputError(f"'{output}': {problem}")
    declared = model.outputs[output]
    if declared.is_category:
        raise InputError(f"'{output}' is a category: it has shares, not thresholds")
    coordinates = model.coordinates(study.settings)
    axes = {dim: coordinates[dim] for dim in declared.dims}
    labels, chosen = [label for label, *_ in places(output, axes)], place_of(name, axes)
    if not chosen:
        choice = f"; choose one, such as '{labels[0]}'" if name == output else ""
        raise InputError(f"'{name}': no such element{choice or nearest(name, labels)}")
    return declared, labels.index(chosen[0][0])
