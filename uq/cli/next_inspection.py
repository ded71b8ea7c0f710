"""Terminal output of ``uq next-inspection``."""

from collections.abc import Sequence
from math import exp
from pathlib import Path
from typing import Any

from uq.cli.printing import grid, heading, note, print_json, title
from uq.learning.next_inspection import Worth, unit_of_time, worth
from uq.result.result import Result
from uq.stats import estimate_json
from uq.text.numbers import counted, percent, threshold
from uq.text.quantities import read_threshold


def next_inspection(
    result: Path,
    output: str,
    times: Sequence[str],
    units: Sequence[int],
    cv: float,
    life: str | None,
    json: bool,
) -> None:
    """Show how far inspections of more units would narrow what units share."""
    opened = Result.open(result)
    at = [read_threshold("--at", text, "a life", unit_of_time(opened, output)) for text in times]
    expected = worth(opened, output, at, units, cv, life)
    if json:
        print_json(_as_json(expected))
        return
    title(opened)
    heading(f"\n{expected.life}", f"expected narrowing by inspecting {expected.output}")
    lines = []
    for time in at or (None,):
        when = "at any time" if time is None else f"at {threshold(time, expected.time_unit)}"
        shares = (expected.narrowing[time, count] for count in units)
        lines.append((when, *(percent(share) if share == share else "-" for share in shares)))
    grid(lines, header=("", *(counted(count, "unit") for count in units)))
    note(
        f"What units share scatters this life by a factor of {exp(expected.spread):.3g} (one"
        " standard deviation); each cell is the share by which the logarithm of that factor is"
        " expected to fall. The scatter between units remains."
    )
    for text in expected.notes:
        note(text)


def _as_json(expected: Worth) -> dict[str, Any]:
    return {
        "life": expected.life,
        "inspect": expected.output,
        "spread": estimate_json.number(expected.spread),
        "time_units": expected.time_unit,
        "notes": expected.notes,
        "narrowing": [
            {"time": time, "units": units, "value": estimate_json.number(share)}
            for (time, units), share in expected.narrowing.items()
        ],
    }
