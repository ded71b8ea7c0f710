"""Terminal output of ``uq check`` and ``uq plan``, before a run."""

import shlex
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

from uq.assess.expected_widths import Widths, expected_widths
from uq.assess.joint_bounds import Needed, rows_needed
from uq.cli.printing import grid, heading, note, number, paragraph, print_json
from uq.cli.progress import say, say_compiling
from uq.execution import runner
from uq.execution.loading import load_study
from uq.execution.planning import Cost, pilot
from uq.indices.methods import fed_by
from uq.machines.row_by_row import RowByRow
from uq.result.result import Result
from uq.sampling.designs import DESIGNS
from uq.sampling.levels import OWN
from uq.study.definition import Study
from uq.study.file import DesignTable
from uq.study.hints import hints
from uq.study.row_sampling import group_size, rows
from uq.text.literals import plain_line
from uq.text.numbers import counted, elapsed, grouped, in_brackets, law, listed, quantity, threshold
from uq.text.units import powers, typical, unit_of


def check(path: str, model: str | None) -> None:
    """Print the planned run of a study, if the study is valid."""
    study = load_study(path, model, say)
    design = study.design
    heading(f"{path}: valid", study.description)
    kind = DESIGNS[design.method]
    factors = {
        "replicates": design.replicates,
        "rows each": group_size(study),
        "units": design.units,
        "repeats": design.repeats,
    }
    parts = [counted(design.samples, "sample")]
    parts += [f"{count} {name}" for name, count in factors.items() if count > 1]
    stated = ", stated to be independent" * design.independent
    if design.rows_of_a_sample > 1 and kind.independent:
        stated += "; rows of one sample are not"
    dependent = study.dependence is not None or (kind.imported and not design.independent)
    shared = study.random and kind.shares_seeds
    asked = [path, *(("--model", model) if model else ())]
    seeds = "the model is random: rows that are compared share a seed"
    seeds += "; one more row of each gives the share of noise" * kind.crossed
    grid(
        [
            ("model", f"{study.model.name}, version {study.model.version}"),
            ("design", f"{design.method}: {kind.meaning}{stated}"),
            ("rows", f"{rows(study)} = {' x '.join(parts)}" if parts[1:] else str(rows(study))),
            *([("until", _until(design))] if design.until else ()),
            *([("seeds", seeds)] * shared),
            ("outputs", ", ".join(study.analysis.outputs)),
            *([("thresholds", _thresholds(study))] if study.analysis.thresholds else ()),
            *([("tolerance", _tolerance(study))] if study.analysis.tolerance else ()),
            ("sensitivity", f"this design can provide {', '.join(fed_by(kind, dependent))}"),
            ("result", str(runner.output_path(study))),
            ("cost", f"'uq plan {plain_line(shlex.join(asked))}' estimates time and disk"),
        ]
    )
    heading("\nUncertain inputs")
    laws = [(name, law(stated), _unit(study, name)) for name, stated in study.uncertain.items()]
    ties = [(name, f"equals {tied.equals}", "") for name, tied in study.tied.items()]
    header = ("parameter", "distribution", "unit")
    by_level = design.rows_of_a_sample > 1 or set(study.levels) != {OWN}
    levels = [(study.level(line[0]),) * by_level for line in laws + ties]
    lines = [line + level for line, level in zip(laws + ties, levels, strict=True)]
    grid(lines, header=header + ("level",) * by_level)
    _show_constants(study)
    _show_sampled(study)
    if lacking := hints(study):
        heading("\nBefore you run it")
        for sentence in lacking:
            paragraph(sentence, indent=2)


def _thresholds(study: Study) -> str:
    """Return the thresholds as the study gives them, with their units."""
    units = {name: output.unit for name, output in study.model.outputs.items()}
    given = (
        f"{name}: {', '.join(threshold(t, units.get(name, '1')) for t in values)}"
        for name, values in study.analysis.thresholds.items()
    )
    return "; ".join(given)


def _tolerance(study: Study) -> str:
    assert study.analysis.tolerance is not None
    coverage, confidence = study.analysis.tolerance
    return f"bounds that cover {100 * coverage:g} % with {100 * confidence:g} % confidence"


def _show_constants(study: Study) -> None:
    """Print the values that do not vary: those of the study, and nominal values of the model."""
    varied = {*study.uncertain, *study.tied}
    nominal = [name for name in study.model.nominal if name not in {*varied, *study.fixed}]
    of_study = {name: study.fixed[name] for name in study.fixed}
    of_model = {name: study.model.nominal[name] for name in nominal}
    for title, values in (("of the study", of_study), ("nominal", of_model)):
        if values:
            heading(f"\nFixed values, {title}")
            units = {name: study.model.parameter(name).unit for name in values}
            shown = (f"{name} = {quantity(value, units[name])}" for name, value in values.items())
            paragraph(", ".join(shown), indent=2)


def _until(design: DesignTable) -> str:
    """Return the interim sizes at which a run may stop, and the stopping criterion."""
    from uq.assess.stopping import confidence, interim_sizes

    assert design.until is not None
    until, *sizes = design.until, *map(str, interim_sizes(design))
    half_width = threshold(until.half_width, "1")
    return (
        f"{until.estimate} of {until.output} is known to +-{half_width}; checked at"
        f" {listed(sizes)} samples, each time with a confidence of {confidence(design):.2%}"
    )


def _unit(study: Study, name: str) -> str:
    times = study.uncertain[name].times
    return powers(study.model.parameter(name).unit) if times is None else f"x {times}"


def _show_sampled(study: Study) -> None:
    """Print the law of each input as stated and in the rows."""
    from uq.assess.sampled_laws import MAX_ROWS, sampled_inputs, sampled_ranks

    count = -(-min(rows(study), MAX_ROWS) // study.design.rows_of_a_sample)
    inputs = sampled_inputs(study)
    if not inputs:
        print(f"\nThe rows of a '{study.design.method}' design do not follow these laws.")
        return
    nested = study.design.rows_of_a_sample > 1
    heading(
        f"\nIn {counted(count, 'row')}{', one of each sample' * nested}",
        f"(independent rows would be less than {1.36 / count**0.5:.2g} off in 19 of 20 cases)",
    )
    lines = []
    for name, sampled_input in inputs.items():
        is_factor = name in study.uncertain and study.uncertain[name].times is not None
        units = "1" if is_factor else study.model.parameter(name).unit
        unit = unit_of(units, typical(sampled_input.stated))
        law_ends, row_ends = (
            map(number, quantiles / unit.size)
            for quantiles in (sampled_input.stated, sampled_input.sampled)
        )
        lines.append((name, "stated", *law_ends, ""))
        lines.append((f" {in_brackets(unit)}", "rows", *row_ends, f"{sampled_input.distance:.2g}"))
    grid(lines, header=("parameter", "", "5 %", "50 %", "95 %", "largest distance"))
    if study.dependence is not None:
        pair = study.dependence.pair
        more = "" if pair is None else _tails(study.dependence.words, pair.tails)
        heading("\nRank correlations", more)
        ranks, names = sampled_ranks(study), study.dependence.parameters
        stated = study.dependence.rank_correlation
        grid(
            [
                (f"{names[i]}, {names[j]}", number(stated[i][j]), f"{ranks[i, j]:.3f}")
                for i, j in combinations(range(len(names)), 2)
            ],
            header=("", "stated", "rows"),
        )


def _tails(words: str, tails: tuple[float, float]) -> str:
    """Return a copula in words with its coefficients of tail dependence."""
    lower, upper = map(number, tails)
    return f"{words}; tail dependence: lower {lower}, upper {upper}"


_SURE = 1.2  # a forecast with a wider margin is shown with its band


def plan(study: Study, workers: int | None, json: bool) -> None:
    """Run a pilot of a study; show the expected cost and interval widths of the full run."""
    cost, dataset = pilot(study, workers, say_compiling, say)
    rows = Result(dataset)
    failures, widths = int(rows.failed.sum()), expected_widths(rows)
    needed = rows_needed(rows, study.analysis)
    if json:
        print_json(as_json(cost, failures, widths, needed))
    else:
        _show(study, cost, failures, needed)
        _show_widths(widths, rows.has_independent_samples)


def as_json(
    cost: Cost, failures: int, widths: Mapping[str, Widths], needed: Mapping[str, Needed]
) -> dict[str, Any]:
    """Return the JSON of ``uq plan``."""
    return {
        "rows": cost.rows,
        "workers": cost.workers,
        "pilot": {"rows": cost.pilot_rows, "failed": failures},
        "row_seconds": cost.row_seconds,
        "seconds": cost.seconds,
        "seconds_low": cost.seconds_low,
        "seconds_high": cost.seconds_high,
        "disk": {"result": cost.result_bytes, "run": cost.run_bytes},
        "rows_needed": {name: need.rows for name, need in needed.items()},
        "widths": {
            name: {
                "units": width.units,
                "mean": width.mean,
                "quantiles": {repr(p): value for p, value in width.quantiles.items()},
                "thresholds": {repr(t): value for t, value in width.thresholds.items()},
                **width.indices,
            }
            for name, width in widths.items()
        },
    }


def _show(study: Study, cost: Cost, failures: int, needed: Mapping[str, Needed]) -> None:
    heading(study.path, study.description)
    processes = "one process" if cost.workers == 1 else f"{cost.workers} processes"
    invalid = f", {failures} invalid" if failures else ""
    pilot_rows = f"estimated from {grouped(cost.pilot_rows)} of them{invalid}"
    sure = cost.seconds_high < _SURE * cost.seconds
    compiled = "" if isinstance(study.model.batch, RowByRow) else ", once the model is compiled"
    band = "" if sure else f"; {elapsed(cost.seconds_low)} to {elapsed(cost.seconds_high)}"
    grid(
        [
            ("rows", grouped(cost.rows), pilot_rows),
            ("a row", quantity(float(f"{cost.row_seconds:.2g}"), "s"), "in one process"),
            ("run", elapsed(cost.seconds), f"with {processes}{compiled}{band}"),
            (
                "result",
                _size(cost.result_bytes),
                f"on disk; {_size(cost.run_bytes)} during the run",
            ),
            *(
                (name.replace("_", " "), counted(need.rows, "row"), _why_needed(need, cost))
                for name, need in needed.items()
            ),
        ]
    )


def _why_needed(needed: Needed, cost: Cost) -> str:
    bounds = f"the {needed.bounds} bounds that hold at once" if needed.bounds > 1 else "a bound"
    short = ": more than the study has" if needed.rows > cost.rows else ""
    return f"needed for {bounds}, if no row is invalid{short}"


def _show_widths(widths: Mapping[str, Widths], independent: bool) -> None:
    asked = [repr(probability) for width in widths.values() for probability in width.quantiles]
    expected = "Expected width" if independent else "Largest width to expect"
    heading(f"\n{expected} of the 95 % intervals of mean and quantiles")
    grid(_widths(widths), header=("", "mean", *dict.fromkeys(asked)))
    others = []
    for name, width in widths.items():
        for t, share in width.thresholds.items():
            others.append((f"P({name} > {threshold(t, width.units)})", _short(share)))
        for kind, index in width.indices.items():
            others.append((f"{kind} of {name}, the widest", _short(index)))
    if others:
        heading("\nand of")
        grid(others)
    if any(width.mean is None for width in widths.values()):
        note("A dash: too few rows, not from this design, or too heavy a tail.")


def _widths(widths: Mapping[str, Widths]) -> Iterator[tuple[str, ...]]:
    """Yield a line for each output, or one with its name and then one for each element."""
    before = ""
    numbers_of: dict[str, list[float]] = {}
    for name, width in widths.items():
        numbers = (
            number for number in (width.mean, *width.quantiles.values()) if number is not None
        )
        numbers_of.setdefault(name.partition("[")[0], []).extend(numbers)
    for name, width in widths.items():
        output, _, place = name.partition("[")
        unit = unit_of(width.units, typical(numbers_of[output]))
        label = f"{output}{in_brackets(unit)}"
        if place and output != before:
            yield label, *[""] * (1 + len(width.quantiles))
        before = output
        cells = (_short(value, unit.size) for value in (width.mean, *width.quantiles.values()))
        yield f"  {place.removesuffix(']')}" if place else label, *cells


def _short(width: float | None, per: float = 1.0) -> str:
    return "-" if width is None else f"{width / per:.3g}"


def _size(count: int) -> str:
    for unit in ("B", "kB", "MB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count //= 1000
    return f"{count:.3g} GB"
