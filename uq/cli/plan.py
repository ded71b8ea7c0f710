"""The command ``uq plan``."""

from collections.abc import Iterator, Mapping
from typing import Any

from uq.assess.expected_widths import Widths, expected_widths
from uq.assess.joint_bounds import Needed, rows_needed
from uq.cli.printing import grid, heading, note, print_json
from uq.cli.progress import say, say_compiling
from uq.execution.planning import Cost, pilot
from uq.machines.row_by_row import RowByRow
from uq.result.result import Result
from uq.study.definition import Study
from uq.text.numbers import counted, in_brackets, quantity, threshold
from uq.text.units import typical, unit_of

_SURE = 1.2  # a forecast with a wider margin is shown with its band


def plan(study: Study, workers: int | None, json: bool) -> None:
    """Run a few rows of a study; show what the whole will cost, and how wide intervals will be."""
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
    pilot_rows = f"from {cost.pilot_rows} of them" + (f", {failures} failed" if failures else "")
    sure = cost.seconds_high < _SURE * cost.seconds
    compiled = "" if isinstance(study.model.batch, RowByRow) else ", once the model is compiled"
    band = "" if sure else f"; {_clock(cost.seconds_low)} to {_clock(cost.seconds_high)}"
    grid(
        [
            ("rows", str(cost.rows), pilot_rows),
            ("a row", quantity(cost.row_seconds, "s"), "of one process"),
            ("time", _clock(cost.seconds), f"with {processes}{compiled}{band}"),
            ("result", _size(cost.result_bytes), f"{_size(cost.run_bytes)} while it is made"),
            *(
                (name.replace("_", " "), counted(need.rows, "row"), _why_needed(need, cost))
                for name, need in needed.items()
            ),
        ]
    )


def _why_needed(needed: Needed, cost: Cost) -> str:
    bounds = f"the {needed.bounds} bounds that hold at once" if needed.bounds > 1 else "a bound"
    short = ": more than the study has" if needed.rows > cost.rows else ""
    return f"needed for {bounds}, if none fails{short}"


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


def _clock(seconds: float) -> str:
    if seconds < 120:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 120 else f"{seconds / 3600:.1f} h"


def _size(count: int) -> str:
    for unit in ("B", "kB", "MB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count //= 1000
    return f"{count:.3g} GB"
