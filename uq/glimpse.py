"""A first look at the rows of a run as they arrive: median lives and shares of regimes."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uq.columns import censored_name
from uq.work import Work

if TYPE_CHECKING:
    from uq.evaluate import Chunk

_KEPT = 4096
"""Values of a life kept at most; of more, every second, every fourth and so on."""


class Glimpse:
    """What the rows of one run say so far, in bounded memory; nothing of it enters a result.

    Parameters
    ----------
    work : Work
    """

    def __init__(self, work: Work) -> None:
        self._regimes: tuple[str, ...] = ()
        self._lives: dict[str, _Sample] = {}
        coordinates = work.model.coordinates(work.settings)
        for name, output in work.model.outputs.items():
            if name == "regime" and output.kind == "category":
                self._regimes = output.categories
            if output.kind == "lifetime":  # its first element stands for all
                place = ",".join(f"{dim}={list(coordinates[dim])[0]}" for dim in output.dims)
                self._lives[name] = _Sample(f"{name}[{place}]" if place else name)
        self._counts = np.zeros(len(self._regimes), dtype=np.int64)

    def see(self, chunk: "Chunk") -> None:
        """Take note of some rows."""
        if self._regimes:
            codes = chunk.columns["regime"]
            self._counts += np.bincount(codes[codes >= 0], minlength=len(self._counts))
        for name, sample in self._lives.items():
            first: Any = (slice(None), *[0] * (chunk.columns[name].ndim - 1))
            values = chunk.columns[name][first]
            if (flag := censored_name(name)) in chunk.columns:
                values = np.where(chunk.columns[flag][first], np.inf, values)
            sample.add(values[~np.isnan(values)])

    @property
    def medians(self) -> dict[str, float]:
        """Median of the first element of each lifetime [s]; inf where most rows do not end."""
        return {one.label: one.median for one in self._lives.values() if one.median is not None}

    @property
    def shares(self) -> dict[str, float]:
        """Share of each regime that occurs, the largest first."""
        total = int(self._counts.sum())
        pairs = zip(self._regimes, self._counts.tolist(), strict=True)
        found = {name: count / total for name, count in pairs if count}
        return dict(sorted(found.items(), key=lambda pair: -pair[1]))


class _Sample:
    """Evenly spaced values of a stream."""

    def __init__(self, label: str) -> None:
        self.label = label
        self._values: NDArray[np.float64] = np.empty(0)
        self._step, self._next = 1, 0

    def add(self, values: NDArray[Any]) -> None:
        taken = values[self._next :: self._step]
        self._next = self._next + len(taken) * self._step - len(values)
        self._values = np.append(self._values, taken)
        while len(self._values) > _KEPT:
            if len(self._values) % 2:
                self._next += self._step
            self._values = self._values[::2]
            self._step *= 2

    @property
    def median(self) -> float | None:
        if not len(self._values):
            return None
        return float(np.partition(self._values, len(self._values) // 2)[len(self._values) // 2])
