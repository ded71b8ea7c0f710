"""Declarations of a model: the only module of ``uq`` that a model may import.

For model authors
-----------------
Write one ``NamedTuple`` of floats (the parameters), one frozen dataclass (the numerical
settings), a dict of `Output` and two functions, ``batch`` and ``simulate``; put them into a
`Model` and name it in the entry-point group ``vibrolife.models``. Nothing in ``uq`` changes.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from enum import IntEnum
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

Kind = Literal["value", "lifetime", "angle", "category"]

Scales = Callable[[Any, Mapping[str, float]], Mapping[str, float]]
"""``scales(settings, constants)`` -> scaling exponent of each parameter; see `Output`."""

NO_CONSTANTS: Mapping[str, float] = MappingProxyType({})
"""No parameter is known not to vary."""

LARGEST_VALUE = 1e300
"""Largest magnitude of an output; larger values count as missing, since sums could overflow."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A physical input of a model, declared with its field.

    Attributes
    ----------
    symbol : str
        Symbol in the source paper.
    unit : str
        CF unit string, ``"1"`` for a pure number.
    meaning : str
        One-line description for readers of a result.
    bounds : tuple of float
        Admissible (not plausible) range, both ends included.
    source : str
        Source of the nominal value, and whether it is given, inferred, fitted or assumed.
    initial : bool
        Whether it belongs to the initial conditions of the motion rather than to the machine.
    """

    symbol: str
    unit: str
    meaning: str
    bounds: tuple[float, float]
    source: str
    initial: bool = False


Table = tuple[tuple[str, str | float], ...]
"""A table of a study file as part of a setting: pairs of a key and its value, in their order."""


@dataclass(frozen=True, slots=True)
class Setting:
    """A numerical choice of a model: a tolerance, a mesh, a horizon; never random.

    Attributes
    ----------
    meaning : str
    unit : str
        ``"1"`` for a pure number.
    bounds : tuple of float, optional
        Both ends included; for a list of numbers, or nested lists, they apply to each number,
        not to texts beside them.
    choices : tuple of str
        Allowed values of a setting that is a word.
    optional : bool
        For a list that is empty by default. While it is empty, studies behave as without this
        setting. If it holds the coordinates of a dimension, the model then has no outputs along it.
    """

    meaning: str
    unit: str = "1"
    bounds: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()
    optional: bool = False


@dataclass(frozen=True, slots=True)
class Output:
    """An output of a model, declared with its unit and kind.

    Attributes
    ----------
    unit : str
    meaning : str
    kind : {"value", "lifetime", "angle", "category"}
        A ``lifetime`` is +inf if the event never occurs; unless `may_be_censored` is false,
        ``batch`` also returns ``<name>_censored`` (bool). Thresholds are compared with the
        magnitude of an ``angle``. A ``category`` is an index into `categories`.
    dims : tuple of str
        Names of the dimensions beyond the row; their coordinates come from `Model.coordinates`.
    may_be_undefined : bool
        Whether NaN is valid, for rows whose regime has no such output.
    may_be_censored : bool
        For lifetimes only.
    categories : tuple of str
        For categories only.
    accuracy : str
        Name of the setting that requests a relative accuracy of this output, if there is one. The
        output ``<name>_error``, with the same dims, then gives an absolute error bound of each
        value, which nine in ten errors do not exceed.
    success : str
        For lifetimes only: description of a desired event, such as ``the motors have locked``; by
        default the end of a lifetime is a failure.
    never_known_at_once : bool
        For lifetimes only: whether a life that never ends is recognised before any row is
        censored, so that every censored row would end later.
    causes : tuple of str
        For lifetimes only: the events that may end it. The model then has the category
        ``<name>_cause``, the cause that ended the life of each row, or why it never ends; -1 if it
        is censored, or no cause is known.
    may_be_between : bool
        For lifetimes only: ``batch`` also returns ``<name>_high``, the upper bound of a life known
        to end between two times; +inf or the life itself for all others. The value is then the
        lower bound, and ``<name>_censored`` is true.
    shown : bool
        Whether tables that name no outputs show it; if not, it is for `Model.again`.
    scales : dict of str to float, or callable
        For lifetimes only: scaling exponent of each parameter. Within the bounds of these
        parameters the life is exactly proportional to the product of their powers, except for
        rounding, for any values of all other parameters. A life that never ends does so for any
        value of these parameters. If the exponents depend on the study: ``scales(settings,
        constants)``, where `constants` has the value of each parameter that is known not to vary;
        they must hold for any values of the others.
    """

    unit: str
    meaning: str
    kind: Kind = "value"
    dims: tuple[str, ...] = ()
    may_be_undefined: bool = False
    may_be_censored: bool = True
    categories: tuple[str, ...] = ()
    accuracy: str = ""
    success: str = ""
    never_known_at_once: bool = True
    shown: bool = True
    scales: Mapping[str, float] | Scales = field(default_factory=dict, hash=False)
    causes: tuple[str, ...] = ()
    may_be_between: bool = False

    @property
    def exponents(self) -> Mapping[str, float]:
        """Its `scales`, which `given` has resolved; empty if they still depend on a study."""
        return {} if callable(self.scales) else self.scales

    def given(self, settings: Any, constants: Mapping[str, float] = NO_CONSTANTS) -> "Output":
        """Return the output with the `scales` that hold under settings and constants."""
        if not callable(self.scales):
            return self
        return replace(self, scales=self.scales(settings, constants))

    @property
    def is_lifetime(self) -> bool:
        """Whether it is the time of an event, +inf if the event never occurs."""
        return self.kind == "lifetime"

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle, whose sign is only a direction."""
        return self.kind == "angle"

    @property
    def is_category(self) -> bool:
        """Whether it is an index into `categories` instead of a number."""
        return self.kind == "category"

    @property
    def has_censored_flag(self) -> bool:
        """Whether ``batch`` also returns ``<name>_censored``."""
        return self.is_lifetime and self.may_be_censored

    def is_absent(self, values: NDArray[Any]) -> NDArray[np.bool_]:
        """Return the mask of missing or impossible values, in the shape of `values`."""
        if self.is_category:
            return values < 0
        if self.is_lifetime:
            return ~(((values >= 0) & (values <= LARGEST_VALUE)) | np.isposinf(values))
        return ~(np.abs(values) <= LARGEST_VALUE)

    def is_invalid(self, values: NDArray[Any]) -> NDArray[np.bool_]:
        """Return the mask of values that a model must not return: absent, except a valid NaN."""
        absent = self.is_absent(values)
        return absent & ~np.isnan(values) if self.may_be_undefined else absent

    def absence(self, value: float) -> str:
        """Return the reason why a value is absent, as the predicate of a sentence."""
        why = ""
        if self.is_lifetime and -np.inf < value < 0:
            why = ": a life cannot be negative"
        elif np.isfinite(value):
            why = f": the sum of several numbers beyond {LARGEST_VALUE:g} may overflow"
        return f"is {value}{why}"

    def for_thresholds(self, values: Floats) -> Floats:
        """Return the numbers to compare with thresholds: magnitudes of angles, else `values`."""
        return np.abs(values) if self.is_angle else values


def censored_name(output: str) -> str:
    """Return the name of the censoring flag of a lifetime."""
    return f"{output}_censored"


def high_name(output: str) -> str:
    """Return the name of the upper bounds of a lifetime that may be known within an interval."""
    return f"{output}_high"


def entered_name(output: str) -> str:
    """Return the name of the times from which rows were under observation (late entry)."""
    return f"{output}_entered"


def cause_name(output: str) -> str:
    """Return the name of the category with the cause that ended a lifetime."""
    return f"{output}_cause"


class Status(IntEnum):
    """Status of a row; the names, in lower case with hyphens, are part of the result's schema."""

    OK = 0
    OUT_OF_BUDGET = 1
    NON_FINITE = 2
    RAISED = 3
    BAD_SHAPE = 4
    CRASHED = 5
    TIMED_OUT = 6

    @property
    def label(self) -> str:
        """Name in files and tables, such as ``out-of-budget``."""
        return self.name.lower().replace("_", "-")

    @property
    def meaning(self) -> str:
        """One-sentence description for readers."""
        return _STATUS_MEANING[self]


_STATUS_MEANING = {
    Status.OK: "The row was computed.",
    Status.OUT_OF_BUDGET: "The model's step budget ended before the row was finished.",
    Status.NON_FINITE: "The model returned a value that is not finite where it must be.",
    Status.RAISED: "The model raised an exception on this row.",
    Status.BAD_SHAPE: "The model returned an array of the wrong shape for this row.",
    Status.CRASHED: "The row killed the worker process that computed it.",
    Status.TIMED_OUT: "The row outlived its time limit and was stopped from outside.",
}


class _History(NamedTuple):
    time: Floats
    quantities: Mapping[str, tuple[str, str, Floats]]


class Trajectory(_History):
    """A labelled time history, as returned by ``simulate``: a pair with notes for its plot.

    Attributes
    ----------
    time : ndarray, shape (k,)
        [s]
    quantities : dict of str to tuple
        Name -> (unit, meaning, values of shape (k,)).
    period : float
        Period of the drive at the end [s]; NaN if there is none.
    shown : tuple of str
        Quantities shown in a plot, at most six; by default the first ones.
    stops : dict of str to tuple
        Quantity -> (lower, upper) values of its mechanical stops, NaN if there is none.
    angles : tuple of str
        Angles [rad] of rotating parts; a plot shows them wrapped to half a turn on each side.
    """

    period: float
    shown: tuple[str, ...]
    stops: Mapping[str, tuple[float, float]]
    angles: tuple[str, ...]

    def __new__(
        cls,
        time: Floats,
        quantities: Mapping[str, tuple[str, str, Floats]],
        *,
        period: float = math.nan,
        shown: tuple[str, ...] = (),
        stops: Mapping[str, tuple[float, float]] | None = None,
        angles: tuple[str, ...] = (),
    ) -> "Trajectory":
        """Create the pair (time, quantities), with its notes."""
        self = super().__new__(cls, time, quantities)
        self.period, self.shown, self.stops, self.angles = period, shown, stops or {}, angles
        return self


Batch = Callable[
    [Floats, NDArray[np.uint64], Any],
    tuple[Mapping[str, NDArray[Any]], NDArray[np.int8]]
    | tuple[Mapping[str, NDArray[Any]], NDArray[np.int8], Mapping[int, str]],
]
"""``batch(x, seed, settings)``: x (n, d) in declared order, seed (n,), a settings object ->
({output name: (n, *dims)}, status (n,) int8), and optionally {i: sentence} for failed rows.
Row i depends only on x[i], seed[i] and settings."""


class Kept(NamedTuple):
    """Rows of a result, from which a model computes them again under other inputs and settings.

    Attributes
    ----------
    x : ndarray, shape (n, d)
    settings : object
    outputs : dict of str to ndarray, shape (n, *dims)
        All outputs, with the flags of censored lives.
    """

    x: Floats
    settings: Any
    outputs: Mapping[str, NDArray[Any]]


Again = Callable[
    [Floats, NDArray[np.uint64], Any, Kept],
    tuple[Mapping[str, NDArray[Any]], NDArray[np.int8], Mapping[int, str]],
]
"""``again(x, seed, settings, kept)``: as `Batch`, from `kept` rows with the same seeds; a
ValueError, in one line, where an input or a setting differs that it cannot change."""


def _no_refusal(settings: Any, constants: Mapping[str, float]) -> str:
    return ""


def _no_coordinates(settings: Any) -> Mapping[str, Sequence[Any]]:
    return {}


ROW_NAME = ("run", "runs")
"""Singular and plural of what a row represents, by default."""


@dataclass(frozen=True)
class Model:
    """A model of a machine: its parameters, settings, outputs and functions.

    Attributes
    ----------
    name : str
    title : str
        One line.
    version : str
        Version, which changes whenever the same input may give different numbers; part of the
        identity of a study.
    parameters : type
        A NamedTuple class; each field ``Annotated[float, Parameter(...)] = nominal``.
    settings : type
        A frozen dataclass; each field ``Annotated[type, Setting(...)] = default``.
    outputs : dict of str to Output
    batch : callable
        See `Batch`.
    simulate : callable, optional
        ``simulate(params, settings, seed=0) -> Trajectory``.
    coordinates : callable
        ``coordinates(settings) -> {dimension: values}`` for every dimension of the outputs. If a
        dimension is empty, ``batch`` returns no outputs along it.
    refusal : callable
        ``refusal(settings, constants)`` -> the reason why no row of a study with these settings and
        values of parameters that do not vary can be computed; "" if there is none.
    dimensions : dict of str to tuple
        Dimension -> (unit, meaning), for coordinates that are quantities.
    cheap : dict of str to Batch
        Output that can be computed separately at a fraction of the cost of a row -> a batch that
        returns only this output, with the same bits.
    random : bool
        Whether rows depend on their seed. Rows that a design compares with each other then share a
        seed, so that noise is not attributed to an input.
    random_unless : dict of str to float
        Parameter -> the value at which a random model is deterministic, such as a noise level of 0.
    again : callable, optional
        See `Again`: computes rows again from what earlier ones kept, at a fraction of the cost.
    block : int
        Number of rows that the kernel advances together; shorter chunks are less efficient.
    references : tuple of str
        References to cite.
    headline : tuple of str
        Outputs that a new study reports, the most important first.
    row_name : tuple of str
        Singular and plural of what a row represents: ``rod``, ``rods``.
    uncertain : dict of str to dict
        Input -> its law in a new study, as in a study file, with its source.
    """

    name: str
    title: str
    version: str
    parameters: type
    settings: type
    outputs: Mapping[str, Output]
    batch: Batch
    simulate: Callable[..., Trajectory] | None = None
    coordinates: Callable[[Any], Mapping[str, Sequence[Any]]] = field(default=_no_coordinates)
    refusal: Callable[[Any, Mapping[str, float]], str] = _no_refusal
    dimensions: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    cheap: Mapping[str, Batch] = field(default_factory=dict)
    random: bool = False
    random_unless: Mapping[str, float] = field(default_factory=dict)
    again: Again | None = None
    block: int = 1
    references: tuple[str, ...] = ()
    headline: tuple[str, ...] = ()
    row_name: tuple[str, str] = ROW_NAME
    uncertain: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Add the category ``<name>_cause`` of each lifetime with causes."""
        outputs = dict(self.outputs)
        for name, output in self.outputs.items():
            if output.causes:
                outputs[cause_name(name)] = Output(
                    "1",
                    f"cause of the end of {name}",
                    "category",
                    output.dims,
                    may_be_undefined=True,
                    categories=output.causes,
                    shown=output.shown,
                )
        if len(outputs) > len(self.outputs):
            object.__setattr__(self, "outputs", outputs)

    def alone(self, output: str) -> "Model":
        """Return a model that computes only one of the `cheap` outputs."""
        return replace(
            self, outputs={output: self.outputs[output]}, batch=self.cheap[output], cheap={}
        )

    def given(self, settings: Any, constants: Mapping[str, float] = NO_CONSTANTS) -> "Model":
        """Return the model with only the outputs that it computes with these settings.

        Outputs along a dimension without coordinates are excluded; scaling exponents that depend on
        the settings are resolved.

        Parameters
        ----------
        settings : object
        constants : dict of str to float, optional
            Values of the parameters that do not vary.
        """
        axes = self.coordinates(settings)
        some = {
            name: output.given(settings, constants)
            for name, output in self.outputs.items()
            if all(len(axes[dim]) for dim in output.dims)
        }
        return self if some == self.outputs else replace(self, outputs=some)

    def choices_of(self, settings: Any) -> dict[str, Any]:
        """Return the settings by name, except empty settings that are `Setting.optional`."""
        return {
            name: value
            for name, value in asdict(settings).items()
            if value or not self.setting(name).optional
        }

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names in declared order: the columns of ``x``."""
        return self.parameters._fields  # type: ignore[attr-defined]

    @property
    def nominal(self) -> dict[str, float]:
        """Nominal value of every parameter, in declared order."""
        return dict(self.parameters._field_defaults)  # type: ignore[attr-defined]

    def parameter(self, name: str) -> Parameter:
        """Return the declaration of one parameter."""
        return _declaration(self.parameters, name, Parameter)

    def setting(self, name: str) -> Setting:
        """Return the declaration of one setting."""
        return _declaration(self.settings, name, Setting)

    @property
    def setting_names(self) -> tuple[str, ...]:
        """Names of the settings in declared order."""
        return tuple(f.name for f in fields(self.settings))


def _declaration(owner: type, name: str, kind: type) -> Any:
    hint = get_type_hints(owner, include_extras=True)[name]
    for extra in get_args(hint)[1:]:
        if isinstance(extra, kind):
            return extra
    raise TypeError(f"{owner.__name__}.{name} is declared without a {kind.__name__}")
