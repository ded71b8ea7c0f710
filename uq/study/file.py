"""Schema of a study file: its tables and keys, independent of the model.

Pydantic validates files with these classes (`uq.study.reading`), and the JSON Schema for editors is
generated from them (`uq.study.schema`).
"""

import re
from collections.abc import Mapping
from contextlib import suppress
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    Discriminator,
    Field,
    GetPydanticSchema,
    Tag,
    TypeAdapter,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
    WrapValidator,
    model_validator,
)
from pydantic_core.core_schema import no_info_plain_validator_function

from uq.errors import InputError, nearest
from uq.indices.methods import METHODS
from uq.sampling.copulas import (
    COPULAS,
    LEAST_FREEDOM,
    MOST_FREEDOM,
    NORMAL,
    PairCopula,
    copula_of_rank,
    copula_problem,
)
from uq.sampling.dependence import Joint, matrix_problem
from uq.sampling.designs import DESIGNS, MAX_SAMPLES
from uq.sampling.input_faults import InputFault
from uq.sampling.law import LEVEL_SCHEMA, LIST, STRICT, Law, Level
from uq.sampling.laws import any_law, law_of
from uq.sampling.levels import MAX_ROWS_OF_A_SAMPLE
from uq.text.literals import shown
from uq.text.quantities import EXAMPLE, SHAPE, Written, converted, read_quantity

_MOST_LISTED = 200  # each is a row of every table


def _one_of(kind: str, choices: Mapping[str, Any]) -> AfterValidator:
    def check(name: str) -> str:
        if name not in choices:
            allowed = f"(allowed: {', '.join(choices)})"
            raise ValueError(f"no such {kind}{nearest(name, choices)} {allowed}")
        return name

    return AfterValidator(check)


def _numbers(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(value)
    if isinstance(value, str):
        with suppress(ValueError):
            return (read_quantity(value),)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"must be a number or a list of numbers, or have its unit: {EXAMPLE}")
    return (value,)


def _quantity(value: Any, number: ValidatorFunctionWrapHandler) -> Any:
    if isinstance(value, Written):
        return value
    return read_quantity(value) if isinstance(value, str) else number(value)


def _distinct(values: tuple[Any, ...]) -> tuple[Any, ...]:
    if len(values) > _MOST_LISTED:
        raise ValueError(f"has {len(values)} entries (allowed: at most {_MOST_LISTED})")
    for value in values:
        if values.count(value) > 1:
            raise ValueError(f"{shown(value)} is listed twice")
    return values


def _needs_table(value: Any) -> Any:
    if not isinstance(value, dict):
        raise ValueError("must be a table, such as {coverage = 0.95, confidence = 0.95}")
    return value


def _name_or_settings(value: Any) -> Any:
    if not isinstance(value, str | dict):
        raise ValueError("must name an output, or be a table of settings, such as {modes = 4}")
    return value


_DISTINCT = AfterValidator(_distinct)
Share = Annotated[float, Field(gt=0, lt=1)]
_Text = Annotated[str, Field(pattern=SHAPE)]
Quantity = Annotated[float, WrapValidator(_quantity, json_schema_input_type=float | _Text)]
"""A number in the unit of the output, or text with a number and its unit."""
NAME = r"^[A-Za-z0-9_-]+$"
Name = Annotated[str, Field(pattern=NAME, max_length=100)]


def _positive(value: float) -> float:
    if not value > 0:
        raise ValueError("must be greater than 0")
    return value


_Count = Annotated[int, Field(ge=1, le=MAX_ROWS_OF_A_SAMPLE)]
_B_LIFE = r"^B(\d{1,2}(\.\d{1,9})?)$"


def _share_ended(name: str) -> str:
    match = re.match(_B_LIFE, name)
    if match is None or not float(match[1]) > 0:
        raise ValueError('must be "B" and a percentage, such as "B10": the time by which 10 % end')
    return name


class _Table(BaseModel):
    model_config = STRICT


class StudyTable(_Table):
    """What the study is."""

    name: Name = Field(description="names the result file: letters, digits, '-' and '_'")
    model: Name = Field(description="name of an installed model, as 'uq models' lists them")
    description: str = Field("", description="one line for readers of the result")


class Until(_Table):
    """The precision at which a run stops before its budget is spent."""

    output: str = Field(description="an output, all its elements, or one element of it")
    half_width: Annotated[Quantity, AfterValidator(_positive)] = Field(
        description='of the interval, in the estimate\'s unit, or text with its own: "2 days"',
        json_schema_extra={"exclusiveMinimum": 0},
    )
    above: Quantity | None = Field(None, description="of the probability of exceeding this")
    below: Quantity | None = Field(None, description="of the probability of staying below this")
    quantile: Share | None = Field(None, description="of this quantile; if nothing, of the mean")
    b_life: Annotated[str, AfterValidator(_share_ended)] | None = Field(
        None,
        description='of this B-life: `"B10"` is the time by which 10 % have ended',
        json_schema_extra={"pattern": _B_LIFE},
    )
    index: str | None = Field(
        None, description='of this index, such as `"ST"`, of each input; the design must provide it'
    )
    input: str | None = Field(None, description="with `index`: of this input only")
    difference: Annotated[tuple[str, str], LIST, _DISTINCT] | None = Field(
        None, description="with `index`: of the difference between the indices of two inputs"
    )

    @model_validator(mode="after")
    def _check_one(self) -> Self:
        given = self.model_fields_set
        if len({"above", "below", "quantile", "b_life", "index"} & given) > 1:
            raise ValueError("takes at most one of above, below, quantile, b_life and index")
        if len({"input", "difference"} & given) > 1:
            raise ValueError("takes at most one of input and difference")
        if {"input", "difference"} & given and self.index is None:
            raise ValueError('input and difference need index, such as index = "ST"')
        return self

    def in_unit(self, units: str) -> Self:
        """Return the rule with its quantities in the unit of its output."""
        keys = [key for key in ("above", "below") if getattr(self, key) is not None]
        if not keys and self.index is None:
            keys = ["half_width"]
        return self.model_copy(update={key: converted(getattr(self, key), units) for key in keys})

    @property
    def threshold(self) -> float | None:
        """The threshold of a probability; None if the rule is for another estimate."""
        return self.below if self.above is None else self.above

    @property
    def probability(self) -> float | None:
        """The probability of a quantile or B-life; None if the rule is for another estimate."""
        return self.quantile if self.b_life is None else float(self.b_life[1:]) / 100

    @property
    def label(self) -> str:
        """The input of an index, or the two inputs of a difference; "" for all inputs."""
        return self.input or " - ".join(self.difference or ())

    @property
    def estimate(self) -> str:
        """The name of the estimate of an element in tables."""
        if self.index is not None:
            return f"{self.index} {self.label}".strip()
        if self.b_life is not None:
            return self.b_life
        if self.quantile is not None:
            return f"quantile {self.quantile}"
        if self.threshold is not None:
            return f"P({'<' if self.above is None else '>'}{self.threshold!r})"
        return "mean"


class DesignTable(_Table):
    """Which rows are computed."""

    method: Annotated[str, _one_of("design", DESIGNS)] = Field(
        description="how rows are chosen",
        json_schema_extra=lambda schema: schema.update(enum=list(DESIGNS)),
    )
    samples: int = Field(
        default_factory=lambda: 0,  # all rows of an imported file; required for other designs
        ge=1,
        le=MAX_SAMPLES,
        description="points drawn in each replicate; see 'uq check' for the rows made of them",
    )
    replicates: int = Field(
        1,
        ge=1,
        le=10_000,
        description="independent scrambles of the design: the source of confidence intervals",
    )
    units: _Count = Field(1, description="of each sample: they have its shared inputs")
    repeats: _Count = Field(1, description="of each unit: they differ by chance")
    second_order: bool = Field(False, description="saltelli only: also pairs of parameters")
    seed: int = Field(0, ge=0, lt=2**63, description="the same seed gives the same rows")
    file: str | None = Field(
        None, description="imported only: CSV or netCDF with a column for each uncertain parameter"
    )
    independent: bool = Field(
        False,
        description="imported only: you state that the rows are independent draws of the laws;"
        " they then feed what a monte-carlo sample feeds",
    )
    until: Until | None = Field(
        None,
        description="stop as soon as this estimate is precise enough; samples is then the budget",
    )

    @property
    def has_independent_samples(self) -> bool:
        """Whether samples are independent, by design or as stated in the study."""
        return self.independent or DESIGNS[self.method].independent

    @property
    def rows_of_a_sample(self) -> int:
        """Number of rows per sample: units times repeats."""
        return self.units * self.repeats


class Tied(_Table):
    """A parameter that has the value of another in every row."""

    equals: str = Field(description="another uncertain parameter, which has a law of its own")
    source: str = Field("", description="why they are the same; shown in every result")
    level: Level | None = Field(
        None, description="the level of the other parameter", json_schema_extra=LEVEL_SCHEMA
    )


def _kind(entry: Any) -> str:
    tied = isinstance(entry, Tied) or (isinstance(entry, dict) and "equals" in entry)
    return "equals" if tied else "distribution"


# Laws are looked up when a file is read or a schema is written, so that later ones are included.
_ANY_LAW = GetPydanticSchema(
    lambda law, handler: no_info_plain_validator_function(law_of),
    lambda schema, handler: handler(any_law().core_schema),
)

Entry = Annotated[
    Annotated[Law, _ANY_LAW, Tag("distribution")] | Annotated[Tied, Tag("equals")],
    Discriminator(_kind),
]
"""Variation of a parameter: by its own law, or tied to another parameter."""

ENTRY: TypeAdapter[Law | Tied] = TypeAdapter(Entry)


class DependenceTable(_Table):
    """Rank correlations of uncertain parameters, and the copula that imposes them."""

    parameters: Annotated[tuple[str, ...], LIST, _DISTINCT, Field(min_length=2)] = Field(
        description="the dependent ones, in the order of the matrix; others are independent"
    )
    rank_correlation: Annotated[tuple[Annotated[tuple[float, ...], LIST], ...], LIST] = Field(
        description="Spearman's, a row for each parameter; of the law itself, before it is cut"
        " into discrete values"
    )
    copula: Annotated[str, _one_of("copula", COPULAS)] = Field(
        NORMAL,
        description="how the parameters depend on each other; other than normal for two only: "
        + "; ".join(f'`"{name}"`, {tails}' for name, tails in COPULAS.items()),
        json_schema_extra=lambda schema: schema.update(enum=list(COPULAS)),
    )
    degrees_of_freedom: float | None = Field(
        None,
        description="of Student's copula: the fewer, the more dependent its tails",
        json_schema_extra={"minimum": LEAST_FREEDOM, "maximum": MOST_FREEDOM},
    )
    survival: bool = Field(
        False, description="clayton and gumbel: lower and upper tails exchanged (survival copula)"
    )
    source: str = Field("", description="where the numbers come from")

    @property
    def pair(self) -> PairCopula | None:
        """The copula of two parameters; None for the normal one.

        Raises
        ------
        InputError
            When the table is not valid: the study of a result may be from anyone.
        """
        if self.copula == NORMAL:
            return None
        if (wrong := self.fault) is not None:
            raise InputError(wrong.within("dependence").line)
        rank = self.rank_correlation[0][1]
        return copula_of_rank(self.copula, rank, self.degrees_of_freedom, self.survival)

    @property
    def joint(self) -> Joint:
        """What the parameters are drawn from: rank correlations, or the copula of a pair."""
        return self.pair or self.rank_correlation

    @property
    def fault(self) -> InputFault | None:
        """The fault of the correlations and the copula together; None if they are valid."""
        if wrong := matrix_problem(self.parameters, self.rank_correlation):
            return wrong.within("rank_correlation")
        return copula_problem(
            self.parameters,
            self.rank_correlation[0][1],
            self.copula,
            self.degrees_of_freedom,
            self.survival,
        )

    @property
    def words(self) -> str:
        """The copula in words, "" for the normal one."""
        if self.copula == NORMAL:
            return ""
        if self.degrees_of_freedom is not None:
            return f"Student's copula with {self.degrees_of_freedom:g} degrees of freedom"
        return f"{'survival ' * self.survival}{self.copula.capitalize()} copula"


_NearlyAll = Annotated[float, Field(gt=0, le=0.999999999)]  # more needs over 10^9 rows


class Tolerance(NamedTuple):
    """Coverage and confidence of a tolerance bound."""

    coverage: _NearlyAll
    confidence: _NearlyAll


USUAL = Tolerance(0.95, 0.95)
"""Default coverage and confidence."""

_SURE_SCHEMA = {"type": "number", "exclusiveMinimum": 0, "maximum": 0.999999999}


class AnalysisTable(_Table):
    """Analysis of the rows; may change without a row being computed again."""

    outputs: Annotated[tuple[str, ...], LIST, _DISTINCT] = Field(
        (), description="outputs to show; all if not given"
    )
    quantiles: Annotated[tuple[Share, ...], LIST, _DISTINCT] = Field(
        (0.05, 0.5, 0.95), description="probabilities, each between 0 and 1"
    )
    max_failed: float = Field(
        0.1, ge=0, le=1, description="share of invalid rows above which a run counts as failed"
    )
    tolerance: Annotated[
        Tolerance | None,
        BeforeValidator(_needs_table),
        WithJsonSchema(
            {
                "type": "object",
                "properties": {"coverage": _SURE_SCHEMA, "confidence": _SURE_SCHEMA},
                "required": ["coverage", "confidence"],
                "additionalProperties": False,
            }
        ),
    ] = Field(None, description="bounds that cover a share of all values, monte-carlo only")
    joint_bounds: dict[str, Literal["lower", "upper", "both"]] = Field(
        {},
        description='output = "lower", "upper" or "both": bounds that hold for all of these outputs'
        " simultaneously, with the coverage and confidence of `tolerance` (0.95 if not given),"
        " monte-carlo only",
    )
    thresholds: dict[
        str,
        Annotated[
            tuple[Quantity, ...],
            BeforeValidator(_numbers, json_schema_input_type=float | _Text | list[float | _Text]),
            _DISTINCT,
        ],
    ] = Field(
        {},
        description="output = t: probability of exceeding and of staying below t, a number in the"
        ' unit of the output, or text with its own: "24 hours"',
    )
    wanted: dict[str, Literal["above", "below"]] = Field(
        {},
        description='output = "above" or "below": which values are good; decides which bound the'
        " answer promises, and what it advises",
    )
    twin: Annotated[str | dict[str, Any], BeforeValidator(_name_or_settings)] = Field(
        "",
        description="a cheap output, or settings that make rows cheap: many such rows sharpen the"
        " estimates, monte-carlo only",
    )
    sensitivity: Annotated[
        tuple[Annotated[str, _one_of("method", METHODS)], ...], LIST, _DISTINCT
    ] = Field(
        (),
        description="sensitivity methods; the design's own if not given",
        json_schema_extra=lambda schema: schema.update(items={"enum": list(METHODS)}),
    )


class Sourced(float):
    """A fixed value with its `source`."""

    source = ""


def source_of_fixed(value: float) -> str:
    """Return the source that a study states for a value in [fixed], or ""."""
    return value.source if isinstance(value, Sourced) else ""


def _fixed_value(entry: Any, number: ValidatorFunctionWrapHandler) -> Any:
    if not isinstance(entry, Mapping):
        return entry if isinstance(entry, Sourced) else number(entry)
    for key in entry:
        if key not in ("value", "source"):
            raise ValueError(
                f"has no key '{key}'{nearest(key, ('value', 'source'))} (allowed: value, source)"
            )
    if "value" not in entry or not isinstance(entry.get("source", ""), str):
        raise ValueError('must be a number, or {value = 1.5, source = "data sheet: given"}')
    value = Sourced(number(entry["value"]))
    value.source = entry.get("source", "")
    return value


class StudyFile(_Table):
    """A study: model, laws of inputs, design and analysis."""

    study: StudyTable
    design: DesignTable
    # The bounds of a parameter determine whether it may be infinite.
    fixed: dict[str, Annotated[float, Field(allow_inf_nan=True), WrapValidator(_fixed_value)]] = (
        Field(
            {},
            description="parameter = value: overrides the nominal; a table {value, source} states"
            " where the value comes from",
        )
    )
    uncertain: dict[str, Entry] = Field(description="one table per parameter that varies")
    dependence: DependenceTable | None = Field(None, description="rank correlations of inputs")
    settings: dict[str, Any] = Field({}, description="numerical settings of the model")
    analysis: AnalysisTable = Field(default_factory=AnalysisTable)
    data: dict[str, dict[str, str]] = Field(
        {}, description="file -> column -> numbers: what files held, kept in results by 'uq run'"
    )

    def in_units(self, units: Mapping[str, str]) -> Self:
        """Return the file with its quantities in the units of the outputs, given by name."""
        until, given = self.design.until, self.analysis.thresholds
        thresholds = {
            name: tuple(converted(value, units.get(name, "1")) for value in values)
            for name, values in given.items()
        }
        update: dict[str, Any] = {
            "analysis": self.analysis.model_copy(update={"thresholds": thresholds})
        }
        if until is not None:
            until = until.in_unit(units.get(until.output.partition("[")[0], "1"))
            update["design"] = self.design.model_copy(update={"until": until})
        return self.model_copy(update=update)
