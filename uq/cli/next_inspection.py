"""What ``uq next-inspection`` shows."""

from collections.abc import Sequence
from math import exp
from pathlib import Path
from typing import Any

from uq import json_form
from uq.cli.printing import grid, heading, note, print_json
from uq.learning.next_inspection import Worth, worth
from uq.rows.results import open_result
from uq.wording import counted, duration, number, percent


def next_inspection(
    result: Path,
    output: str,
    times: Sequence[float],
    units: Sequence[int],
    cv: float,
    life: str | None,
    json: bool,
) -> None:
    """Show how far inspections of more units would narrow what units share."""
    ds = open_result(result)
    found = worth(ds, output, times, units, cv, life)
    if json:
        print_json(_as_json(found))
        return
    heading(str(ds.attrs["title"]), f"{ds.attrs['source']}")
    heading(f"\n{found.life}", f"expected narrowing by inspecting {found.output}")
    grid(
        [(_when(t), *(_share(found, t, n) for n in units)) for t in times or (None,)],
        header=("", *(counted(n, "unit") for n in units)),
    )
    note(
        f"What units share scatters this life by a factor of {exp(found.spread):.3g} (one standard"
        " deviation); each cell is the share by which the logarithm of that factor is expected to"
        " fall. The scatter between units remains."
    )


def _when(time: float | None) -> str:
    if time is None:
        return "at any time"
    return f"at {number(time)} s" + (f" ({duration(time)})" if duration(time) else "")


def _share(found: Worth, time: float | None, units: int) -> str:
    share = found.narrowing[time, units]
    return percent(share) if share == share else "-"


def _as_json(found: Worth) -> dict[str, Any]:
    return {
        "life": found.life,
        "inspect": found.output,
        "spread": json_form.number(found.spread),
        "narrowing": [
            {"time": time, "units": units, "value": json_form.number(share)}
            for (time, units), share in found.narrowing.items()
        ],
    }
