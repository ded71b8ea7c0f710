"""Rows computed one after the other by a function of numbers that returns a dict."""

import keyword
import os
import re
from collections import namedtuple
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from inspect import isfunction
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Model, Output, Parameter, Status, censored_name, high_name
from uq.errors import InputError, described
from uq.machines.returned import Returned, RowError, checked, dimensions
from uq.machines.study_defaults import StudyDefaults
from uq.sampling.input_faults import unknown
from uq.text.quantities import fault_of_unit, read_quantity

if TYPE_CHECKING:
    from uq.machines.queue_table import QueueTable

_NO_PROPOSALS = StudyDefaults()

SEED = "seed"
"""Name of the argument that receives the seed of a row."""

_TAKEN = (
    "row replicate group block world unit repeat status rerun".split()  # of a result itself
)

_PURE = ("1", "cycles")  # units in which a life may be counted
_LIFE = re.compile(
    r"(?!.*_(error|sd|ratio|share|fraction)$)"
    r"((.*_)?(life|lives|lifetimes?|ttf)(_(s|h|min|seconds|minutes|hours|days|years|cycles))?"
    r"|(.*_)?(time|hours|days|years|cycles)_(to|until)_.+|(.*_)?(failure|survival)_time)",
    re.IGNORECASE,
)

Fields = Mapping[str, tuple[Parameter, float]]
"""Parameters, in order: name -> declaration and nominal value."""


def model_from(
    name: str,
    title: str,
    version: str,
    fields: Fields,
    returned: Mapping[str, Returned],
    batch: "RowByRow",
    random: bool,
    defaults: StudyDefaults = _NO_PROPOSALS,
) -> Model:
    """Return a model without settings; arguments as those of `uq.contract.Model`.

    Raises
    ------
    InputError
        When a nominal value, a name or a unit cannot be used.
    """
    checks = _nominal_faults, _name_faults, _unit_faults, _scale_faults
    faults = [fault for check in checks for fault in check(fields, returned)]
    parameters = {field: parameter for field, (parameter, _) in fields.items()}
    if faults := [*faults, *defaults.faults(parameters, returned)]:
        raise InputError(*(f"machine '{name}': {fault}" for fault in faults))
    axes: dict[str, list[int]] = {}
    for output, declaration in returned.items():
        axes |= dimensions(output, declaration.shape)
    return Model(
        name,
        title,
        version,
        parameters_of(fields),
        NoSettings,
        {output: declaration.output(output) for output, declaration in returned.items()},
        batch,
        coordinates=lambda settings: axes,
        random=random,
        headline=tuple(defaults.headline),
        row_name=(defaults.row_name[0], defaults.row_name[1]),
        uncertain=defaults.uncertain,
    )


def parameters_of(fields: Fields) -> type:
    """Return the type of the parameters of a model (`uq.contract.Model`)."""
    nominal = [value for _, value in fields.values()]
    made: Any = namedtuple("Parameters", fields, defaults=nominal)  # type: ignore[misc]
    made.__annotations__ = {field: Annotated[float, fields[field][0]] for field in fields}
    return made


def _nominal_faults(fields: Fields, returned: Mapping[str, Returned]) -> Iterator[str]:
    for name, (parameter, nominal) in fields.items():
        low, high = parameter.bounds
        if not low < high:
            yield f"bounds of '{name}' must be a lower and a higher number, not ({low:g}, {high:g})"
        elif not (isfinite(nominal) and low <= nominal <= high):
            within = (
                f"between {low:g} and {high:g}" if isfinite(high - low) else "within its bounds"
            )
            yield f"nominal value {nominal:g} of '{name}' must be a finite number {within}"


def _unit_faults(fields: Fields, returned: Mapping[str, Returned]) -> Iterator[str]:
    units = {f"'{name}'": parameter.unit for name, (parameter, _) in fields.items()}
    units |= {f"output '{name}'": declaration.unit for name, declaration in returned.items()}
    for owner, unit in units.items():
        if fault := fault_of_unit(unit):
            yield f"unit '{unit}' of {owner}: {fault}"


def _scale_faults(fields: Fields, returned: Mapping[str, Returned]) -> Iterator[str]:
    for output, declaration in returned.items():
        if declaration.scales and not declaration.life:
            yield f"output '{output}': only a life has scales: life = true"
        for name, exponent in declaration.scales.items():
            if name not in fields:
                yield f"output '{output}': scales: {unknown('parameter', name, fields)}"
            elif not (isinstance(exponent, int | float) and isfinite(exponent) and exponent):
                yield f"output '{output}': scales: {name} = {exponent!r} must be a number but 0"
            elif not fields[name][1] > 0:
                yield f"output '{output}': scales: nominal value of '{name}' must be positive"


def _name_faults(fields: Fields, returned: Mapping[str, Returned]) -> Iterator[str]:
    """Yield faults of names: parameters and outputs share the variables of a result."""
    reserved = "of one of a result's own variables"
    taken = dict.fromkeys(fields, "of a parameter") | dict.fromkeys(_TAKEN, reserved)
    for name in fields:
        if not name.isidentifier() or keyword.iskeyword(name) or name.startswith("_"):
            yield f"parameter '{name}' cannot have this name in Python; choose another"
        if name in _TAKEN:
            yield f"parameter '{name}' is the name {taken[name]}; choose another"
    for name, declaration in returned.items():
        made = [
            name,
            *dimensions(name, declaration.shape),
            *([censored_name(name)] if declaration.life else []),
            *([high_name(name)] if declaration.life and declaration.between else []),
        ]
        for new in made:
            if new in taken:
                yield f"output '{name}': '{new}' is the name {taken[new]}; choose another"
            taken[new] = f"of output '{name}' or of a part of it"


@dataclass(frozen=True)
class NoSettings:
    """Settings of a model without any."""


@dataclass(frozen=True)
class RowByRow:
    """A batch that computes rows one after the other, each with its own status.

    Attributes
    ----------
    function : callable
        Takes the parameters of a row as keywords, and returns a dict of outputs. A dataclass with a
        field ``row_limit`` stops a row after this time [s].
    names : tuple of str
        Of the parameters, in order.
    returned : dict of str to Returned
    wants_seed : bool
        Whether the function takes the seed of the row too.
    leave : callable
        Called after some rows.
    keep : callable
        Called with the numbers of a row that was lost with its process: its parameters, then its
        seed if it is wanted; returns the folder in which its files are kept, or None.
    loads_first : bool
        Whether its first row may take longer than others, as it imports or compiles something.
    queue : QueueTable or None
        Jobs of a cluster that compute the rows, unless a run asks for other workers.
    """

    function: Callable[..., Any]
    names: tuple[str, ...]
    returned: Mapping[str, Returned]
    wants_seed: bool
    leave: Callable[[], object] = lambda: None
    keep: Callable[[list[float | int]], Path | None] = lambda numbers: None
    loads_first: bool = True
    queue: "QueueTable | None" = None

    @property
    def stops_rows(self) -> bool:
        """Whether it can stop a row at its time limit."""
        return hasattr(self.function, "row_limit")

    def limited(self, seconds: float) -> Self:
        """Return a batch that stops rows after a time [s]; only one that `stops_rows` can."""
        function: Any = self.function
        return replace(self, function=replace(function, row_limit=seconds))

    def __call__(
        self, x: Floats, seed: NDArray[np.uint64], settings: object
    ) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8], dict[int, str]]:
        """Compute rows; see `uq.contract.Batch`."""
        columns = self.blank(len(x))
        status, messages = np.zeros(len(x), np.int8), dict[int, str]()
        for i, row in enumerate(x.tolist()):
            try:
                for name, numbers, cut in checked(self.row(row, int(seed[i])), self.returned):
                    columns[name][i] = numbers
                    if name in self.returned and self.returned[name].life:
                        columns[censored_name(name)][i] = cut
            except RowError as error:
                status[i], messages[i] = error.status, str(error)
            except BaseException as error:  # Ctrl-C reaches another thread or process
                status[i], messages[i] = Status.RAISED, described(error)
                if self.wants_seed and _is_too_long(error):
                    messages[i] += "; the seed of a row has 64 bits: shorten it to seed % 2**32"
        self.leave()
        return columns, status, messages

    def blank(self, rows: int) -> dict[str, NDArray[Any]]:
        """Return the columns of rows that are not computed yet."""
        columns: dict[str, NDArray[Any]] = {}
        for name, declaration in self.returned.items():
            columns[name] = np.full((rows, *declaration.shape), np.nan)
            if declaration.life:
                columns[censored_name(name)] = np.full(columns[name].shape, False)
            if declaration.life and declaration.between:
                columns[high_name(name)] = np.full(columns[name].shape, np.nan)
        return columns

    def kept(self, row: list[float], seed: int) -> str:
        """Return where the files of a row that was lost with its process are, for its message."""
        folder = self.keep([*row, seed] if self.wants_seed else row)
        return f"; see {folder}" if folder else ""

    def row(self, row: list[float], seed: int) -> Any:
        """Call the function on a row; the current folder stays as it was."""
        given: dict[str, Any] = dict(zip(self.names, row, strict=True))
        if self.wants_seed:
            given[SEED] = seed
        here = os.getcwd()
        try:
            return self.function(**given)
        finally:
            os.chdir(here)


def _is_too_long(error: BaseException) -> bool:
    """Whether a generator of random numbers takes no seed of 64 bits."""
    text = str(error).lower()
    return isinstance(error, ValueError | OverflowError) and ("seed" in text or "too large" in text)


def undeclared_lives(model: Model, names: tuple[str, ...] = ()) -> Iterator[str]:
    """Yield a hint for each output that is named like a life but not declared as a lifetime.

    Parameters
    ----------
    model : Model
    names : tuple of str
        Outputs; all if not given.
    """
    for name in names or model.outputs:
        output = model.outputs[name]
        if output.kind == "value" and _LIFE.fullmatch(name) and _may_be_time(output):
            yield (
                f"output '{name}' is not declared as a life: no survival curve, no B-lives, no"
                f" hours or days; if it is one, {_declaration_of_life(model, name)}"
            )


def _declaration_of_life(model: Model, name: str) -> str:
    if not isinstance(model.batch, RowByRow):
        return "give its Output kind = 'lifetime'"
    function = model.batch.function
    if isfunction(getattr(function, "py_func", function)):
        return f"write @uq.machine(returns={{'{name}': uq.Returned('s', life=True)}})"
    return "state life = true, unit = 's' where the machine describes it"


def _may_be_time(output: Output) -> bool:
    if output.unit in _PURE:
        return True
    with suppress(ValueError):
        return read_quantity(f"1 {output.unit}").dimensions == {"s": 1}
    return False
