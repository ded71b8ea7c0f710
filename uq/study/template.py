"""Template of a study file for a model."""

import re
from collections.abc import Iterable, Iterator
from itertools import islice
from math import isfinite
from typing import Any

from pydantic import BaseModel

from uq.contract import Model, Parameter
from uq.errors import InputError, nearest
from uq.sampling.copulas import COPULAS, NORMAL
from uq.sampling.designs import DESIGNS, PLAIN, Design
from uq.sampling.law import Law
from uq.sampling.laws import LAWS, law_of
from uq.sampling.named_values import bounds_of
from uq.sampling.truncation import law_problem
from uq.study.definition import Study
from uq.study.file import AnalysisTable, DesignTable
from uq.text.literals import toml

_DESIGN: dict[str, Any] = {"method": "monte-carlo", "samples": 1000, "seed": 1}
_UNCERTAIN = 3
_SOURCE = "assumed: an example, replace it with your own"


def template(
    model: Model, reference: str = "", method: str | None = None, name: str | None = None
) -> str:
    """Return a commented study file that runs unchanged.

    A line that starts with ``#`` and a key is an entry with its default: remove the ``#`` to
    change it. The inputs that the model declares uncertain have the declared laws, and its headline
    outputs are reported. For a model that declares none, the first parameters for which an example
    law is valid are uncertain.

    Parameters
    ----------
    model : Model
    reference : str
        Reference to the model on the command line; it is not part of a study.
    method : str, optional
        Design; by default Monte Carlo.
    name : str, optional
        Name of the study; by default that of the model.

    Returns
    -------
    str
        TOML.

    Raises
    ------
    InputError
        When there is no such design, or it needs a file of rows.
    """
    laws = {name: law_of(law) for name, law in model.uncertain.items()} or _example_laws(model)
    outputs = model.given(model.settings()).outputs
    numbers = [name for name, output in outputs.items() if not output.is_category]
    given_by = [] if reference in ("", model.name) else [f"# run with --model {_line(reference)}"]
    designs = (f"# {name}: {design.meaning}" for name, design in DESIGNS.items())
    chosen = _design(method, len(laws), model.random)
    design = _entries(DesignTable, chosen, {"until": {"output": numbers[0], "half_width": 1.0}})
    tolerance = {"coverage": 0.95, "confidence": 0.95}
    headline: dict[str, Any] = {"outputs": list(model.headline)} if model.headline else {}
    if headline and DESIGNS[chosen["method"]].independent:
        headline["tolerance"] = tolerance
    examples = {
        "outputs": list(outputs),
        "tolerance": tolerance,
        "thresholds": {numbers[0]: 1.0},
        "sensitivity": ["first-order"],
    }
    return f"""\
#:schema vibrolife-study.schema.json
# The line above lets an editor help; 'uq schema' writes that file.
# '#key = value' shows a default: remove the '#' and change it.

[study]
name = {toml(name or re.sub(r"[^A-Za-z0-9_-]", "-", model.name) + "-study")}
{_lines(given_by)}model = {toml(model.name)}
description = {toml(_line(model.title))}

[design]
{_lines(designs)}{_lines(design)}
[fixed]
# Parameters with a fixed value: the nominal one unless given here.
{_lines(_fixed(model, laws))}
{_lines(_uncertain(model, laws))}# Other laws and their arguments, in the parameter's unit:
{_lines(_menu())}
[settings]
{_lines(_settings(model))}
[analysis]
{_lines(_entries(AnalysisTable, headline, examples))}"""


def _design(method: str | None, inputs: int, random: bool) -> dict[str, Any]:
    """Return the entries of a design, with replicates where only these give intervals."""
    if method is None:
        return _DESIGN
    refuse_unknown(method)
    design = DESIGNS[method]
    if design.imported:
        raise InputError(f"--design {method}: needs a file of rows; state it in [design]")
    if design.independent:
        return _DESIGN | {"method": method}
    samples = samples_of(design, design.blocks(inputs, False, random), _DESIGN["samples"])
    return {"method": method, "samples": samples, "replicates": REPLICATES, "seed": 1}


def _lines(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


def _example_laws(model: Model) -> dict[str, Law]:
    """Return an example law of the first parameters that it suits."""
    suited = ((n, _example_law(model.parameter(n), x)) for n, x in model.nominal.items())
    return dict(islice(((name, law) for name, law in suited if law), _UNCERTAIN))


def _example_law(parameter: Parameter, nominal: float) -> Law | None:
    """Return an example law around the nominal value within the bounds, 10 % scatter if possible.

    None for a parameter that is infinite by default.
    """
    if not isfinite(nominal):
        return None
    low, high = parameter.bounds
    candidates: list[dict[str, Any]] = [{"distribution": "normal", "mean": nominal, "sd": 1.0}]
    if low < high and isfinite(high - low):
        candidates.insert(0, {"distribution": "uniform", "lower": low, "upper": high})
    if nominal > 0:
        candidates.insert(0, {"distribution": "lognormal", "mean": nominal, "cv": 0.1})
    laws: Iterator[Law] = (law_of(candidate | {"source": _SOURCE}) for candidate in candidates)
    return next((law for law in laws if law_problem(law, parameter) is None), None)


def _fixed(model: Model, laws: dict[str, Law]) -> Iterator[str]:
    for name, nominal in model.nominal.items():
        if name not in laws:
            yield _about(model.parameter(name))
            yield f"#{name} = {toml(nominal)}"


def _uncertain(model: Model, laws: dict[str, Law]) -> Iterator[str]:
    for name, law in laws.items():
        yield f"[uncertain.{name}]"
        yield _about(model.parameter(name))
        for key, value in law.model_dump(exclude={"source"}, exclude_none=True).items():
            if key != "level" or value != Law.model_fields["level"].default:
                yield f"{key} = {toml(value)}"
        yield f"source = {toml(law.source)}"
        yield ""


def _menu() -> Iterator[str]:
    common = ("distribution", *Law.model_fields)
    for name, law in LAWS.items():
        keys = [key for key in law.model_fields if key not in common]
        arguments = ", or ".join(", ".join(names) for names in law.either or [keys])
        yield f"# {name}: {arguments}"
    yield "# Any of them may be truncated: truncate = [lower, upper]"
    yield '# A parameter may be another times a factor with this law: times = "other"'
    yield '# A parameter may equal another, instead of having a law: equals = "other"'
    yield ""
    yield "# Rank correlations, with ones on the diagonal:"
    yield "# [dependence]"
    yield '# parameters = ["one", "other"]'
    yield "# rank_correlation = [[1.0, 0.5], [0.5, 1.0]]"
    yield f"# copula = {toml(NORMAL)}  # for two: {', '.join(COPULAS)}"


def _settings(model: Model) -> Iterator[str]:
    if not model.setting_names:
        yield "# This model has none."
    default = model.settings()
    for name in model.setting_names:
        declared = model.setting(name)
        allowed = f"; one of {', '.join(declared.choices)}" if declared.choices else ""
        if declared.bounds is not None and not allowed:
            allowed = f"; {declared.bounds[0]!r} to {declared.bounds[1]!r}"
        unit = "" if declared.unit == "1" else f" [{declared.unit}]"
        yield f"# {_line(declared.meaning)}{unit}{allowed}"
        yield f"#{name} = {toml(getattr(default, name))}"


def _entries(
    table: type[BaseModel], given: dict[str, Any], examples: dict[str, Any]
) -> Iterator[str]:
    for name, field in table.model_fields.items():
        value = (examples | given).get(name, field.default)
        if value is not None:  # the others are rarely used, and TOML has no null
            yield f"# {field.description}"
            yield f"{'' if name in given else '#'}{name} = {toml(value)}"


def _about(parameter: Parameter) -> str:
    return _line(f"# {parameter.symbol}: {parameter.meaning}; {bounds_of(parameter)}")


def _line(text: str) -> str:
    return " ".join(text.split())


REPLICATES = 8
"""Replicates of a design for indices, so that its indices have intervals."""

_ROWS = 8192
"""Approximate number of rows of a design for indices."""

_FEWEST = 16  # points of a replicate


def variant(study: Study, method: str | None = None, name: str | None = None) -> str:
    """Return the file of a study with another design, without comments.

    A design whose rows are not independent gets eight replicates, for intervals; its number of
    samples is a power of two. Tolerance bounds, which assume independent rows, and sensitivity
    methods of the design before are left out.

    Parameters
    ----------
    study : Study
    method : str, optional
        By default the design of the study.
    name : str, optional
        By default the name of the study, followed by the design.

    Returns
    -------
    str
        TOML.

    Raises
    ------
    InputError
        When there is no such design, or the study cannot have it.
    """
    changes: dict[str, Any] = {}
    if method is not None:
        refuse_unknown(method)
        changes["design.method"] = method
        changes |= _for_design(study, method)
    changes["study.name"] = name or f"{study.name}-{method or 'copy'}"
    return study.with_changes(changes).text


def refuse_unknown(method: str) -> None:
    """Raise `InputError` if there is no such design."""
    if method not in DESIGNS:
        allowed = ", ".join(DESIGNS)
        raise InputError(
            f"--design {method}: no such design{nearest(method, DESIGNS)} (allowed: {allowed})"
        )


def _for_design(study: Study, method: str) -> dict[str, Any]:
    """Return the changes that another design needs."""
    design, given, asked = DESIGNS[method], study.design, study.analysis
    changes: dict[str, Any] = {}
    if asked.sensitivity:  # chosen for the design before
        changes["analysis.sensitivity"] = None
    if design.independent:
        return changes
    for bound in ("tolerance", "joint_bounds"):  # their confidence assumes independent rows
        if getattr(asked, bound):
            changes[f"analysis.{bound}"] = None
    group = design.blocks(len(study.uncertain), given.second_order, study.random)
    changes["design.samples"] = samples_of(design, group, given.samples * given.replicates)
    changes["design.replicates"] = REPLICATES
    if given.until is not None and design.layout is not PLAIN:
        changes["design.until"] = None
    return changes


def samples_of(design: Design, group: int, plain_rows: int) -> int:
    """Return a power of two of samples of each replicate.

    Parameters
    ----------
    design : Design
    group : int
        Rows of a sample.
    plain_rows : int
        Wanted number of rows in all, of a design that is not for indices.
    """
    rows = _ROWS if design.layout is not PLAIN else plain_rows
    fitting = max(rows // (REPLICATES * group), design.least, _FEWEST)
    return int(2 ** (fitting - 1).bit_length())
