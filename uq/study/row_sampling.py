"""Rows of a study: any range, from the unit cube to physical inputs, reproducible to the bit.

Further samples append rows: row = (j * replicates + r) * blocks + b for base point j, replicate r
and block b of its group. Where a sample has units and repeats, it has one block, and
row = ((j * replicates + r) * units + u) * repeats + v for unit u and repeat v.
"""

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.sampling.data_files import numbers
from uq.sampling.dependence import conditional_paths, correlated
from uq.sampling.designs import DESIGNS
from uq.sampling.levels import coordinates, dimension
from uq.sampling.truncation import cell_of, factor_ends, ppf_between, ppf_within
from uq.sampling.unit_cube import splitmix64

if TYPE_CHECKING:
    from uq.study.definition import Study


class Rows(NamedTuple):
    """A block of rows of a study.

    Attributes
    ----------
    x : ndarray, shape (n, d)
        All parameters of the model, uncertain or fixed, in declared order; C-contiguous.
    seed : ndarray of uint64, shape (n,)
        Seeds of random models; rows that the design compares share a seed.
    replicate : ndarray of int32, shape (n,)
    group : ndarray of int64, shape (n,)
        Base point of the replicate's design.
    block : ndarray of int16, shape (n,)
        Position in the group.
    """

    x: Floats
    seed: NDArray[np.uint64]
    replicate: NDArray[np.int32]
    group: NDArray[np.int64]
    block: NDArray[np.int16]

    @classmethod
    def without_design(cls, x: Floats, seed: NDArray[np.uint64]) -> "Rows":
        """Return rows that do not belong to a design."""
        zeros = np.zeros(len(x), np.int64)
        return cls(x, seed, zeros.astype(np.int32), zeros, zeros.astype(np.int16))

    def part(self, first: int, last: int) -> "Rows":
        """Return the rows first..last, without `last`."""
        fields: list[NDArray[Any]] = [field[first:last] for field in self]
        return Rows(*fields)


def block_labels(study: "Study") -> tuple[str, ...]:
    """Return the labels of the rows of a group, in order."""
    table = study.design
    layout = DESIGNS[table.method].layout
    return layout.labels(tuple(study.uncertain), table.second_order, study.random)


def group_size(study: "Study") -> int:
    """Return the number of rows per group for sensitivity indices: 1 for plain designs."""
    return len(block_labels(study))


def rows(study: "Study") -> int:
    """Return the number of rows of a study."""
    return study.design.samples * rows_per_sample(study)


def rows_per_sample(study: "Study") -> int:
    """Return the number of rows added by one more sample of each replicate."""
    design = study.design
    return design.replicates * group_size(study) * design.rows_of_a_sample


def row_block(study: "Study", start: int, stop: int) -> Rows:
    """Return the rows start..stop of a study.

    Parameters
    ----------
    study : Study
    start, stop : int
        Any range within 0..rows(study); it may divide groups.

    Returns
    -------
    Rows
        Row i depends only on the study and on i, not on the range, to the bit.
    """
    table, labels = study.design, block_labels(study)
    place, within = np.divmod(np.arange(start, stop), table.rows_of_a_sample)
    place, block = np.divmod(place, len(labels))
    group, replicate = np.divmod(place, table.replicates)
    keys = group, block
    if study.random:
        keys = DESIGNS[table.method].layout.shared_seeds(group, block, labels)
    nested = np.divmod(within, table.repeats) if table.rows_of_a_sample > 1 else ()
    seeds = row_seeds(table.seed, replicate, *keys, *nested)
    if study.imported:
        columns = {name: numbers(text)[start:stop] for name, text in study.imported.items()}
        x = _all_parameters(study, stop - start, columns)
    else:
        x = _drawn(study, start, stop)
    return Rows(x, seeds, replicate.astype(np.int32), group, block.astype(np.int16))


def _drawn(study: "Study", start: int, stop: int) -> Floats:
    """Return the inputs of the rows start..stop, shape (n, all parameters)."""
    if study.dependence is None or not DESIGNS[study.design.method].layout.given_the_rest:
        return physical(study, unit_block(study, start, stop))
    size = group_size(study)
    first, last = start // size, -(-stop // size)
    unit = unit_block(study, size * first, size * last)
    columns = _dependent(study)
    laws = [study.uncertain[name] for name in study.dependence.parameters]
    bounds = map(study.bounds, study.dependence.parameters)
    cells = [
        partial(cell_of, law, bounds=ends) if law.discrete else None
        for law, ends in zip(laws, bounds, strict=True)
    ]
    paths = unit[:, columns].reshape(-1, size, len(columns))
    conditional = conditional_paths(paths, study.dependence.joint, cells)
    unit[:, columns] = conditional.reshape(-1, len(columns))
    return _by_their_laws(study, unit[start - size * first : stop - size * first])


def unit_block(study: "Study", start: int, stop: int) -> Floats:
    """Return the points of the unit cube of the rows start..stop, shape (n, uncertain).

    Parameters
    ----------
    study : Study
        Not of imported rows.
    start, stop : int
    """
    table = study.design
    levels, per_sample = study.levels, rows_per_sample(study)
    first, last = start // per_sample, -(-stop // per_sample)
    cube = DESIGNS[table.method].unit_rows(
        seed=table.seed,
        replicates=table.replicates,
        d=dimension(levels, table.units, table.repeats),
        samples=table.samples,
        second_order=table.second_order,
        start=first,
        stop=max(first, last),
        random=study.random,
    )
    if table.rows_of_a_sample > 1:
        cube = cube[..., coordinates(levels, table.units, table.repeats)]
    offset = first * per_sample
    return np.asarray(cube.reshape(-1, len(levels))[start - offset : stop - offset])


def physical(study: "Study", unit: Floats) -> Floats:
    """Map points of the unit cube to all parameters of the model.

    Parameters
    ----------
    study : Study
        Not of imported rows.
    unit : ndarray, shape (n, len(study.uncertain))
        Inside the open unit cube; independent coordinates.

    Returns
    -------
    ndarray, shape (n, d)
        In declared order and unit, with the dependence, scaled and tied inputs of the study;
        C-contiguous.
    """
    if study.dependence is not None:
        columns = _dependent(study)
        unit = unit.copy()
        unit[:, columns] = correlated(unit[:, columns], study.dependence.joint)
    return _by_their_laws(study, unit)


def _dependent(study: "Study") -> list[int]:
    """Return the columns of the dependent inputs, in the order of their correlation matrix."""
    assert study.dependence is not None
    return [list(study.uncertain).index(name) for name in study.dependence.parameters]


def _by_their_laws(study: "Study", unit: Floats) -> Floats:
    """Map points of the unit cube, with their dependence, to all parameters of the model."""
    points = dict(zip(study.uncertain, unit.T, strict=True))
    columns: dict[str, Floats] = {}
    # Factors are computed after the inputs that they scale.
    for name, law in sorted(study.uncertain.items(), key=lambda entry: entry[1].times is not None):
        # A contiguous copy: for strided data numpy may use another loop with different last bits.
        u, bounds = np.ascontiguousarray(points[name]), study.bounds(name)
        if law.times is None:
            columns[name] = ppf_within(law, u, bounds)
        else:
            other = columns[law.times]
            factor = ppf_between(law, u, *factor_ends(other, bounds))
            columns[name] = np.clip(factor * other, *bounds)
    return _all_parameters(study, len(unit), columns)


def _all_parameters(study: "Study", count: int, columns: Mapping[str, Floats]) -> Floats:
    """Return rows of all parameters: given columns, constants, and tied parameters."""
    names = study.model.parameter_names
    x = np.empty((count, len(names)))
    x[:] = [study.fixed.get(name, value) for name, value in study.model.nominal.items()]
    for name, column in columns.items():
        x[:, names.index(name)] = column
    for name, tied in study.tied.items():
        x[:, names.index(name)] = x[:, names.index(tied.equals)]
    return x


def row_seeds(seed: int, *keys: NDArray[np.int64]) -> NDArray[np.uint64]:
    """Return one seed per row: a hash of the study's seed and the keys of the row.

    Parameters
    ----------
    seed : int
        0 to 2^63 - 1.
    *keys : ndarray of int, shape (n,)
        Keys that identify a row.

    Returns
    -------
    ndarray of uint64, shape (n,)
    """
    state = np.full(len(keys[0]), seed, np.uint64)
    for key in keys:
        state = splitmix64(state) ^ key.astype(np.uint64)
    return splitmix64(state)
