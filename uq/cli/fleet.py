"""Terminal output of ``uq fleet``."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from uq.assess.fleet import fleet_of, reasons, the_life
from uq.assess.fleet_json import fleet_facts
from uq.assess.fleet_numbers import Banded
from uq.cli.printing import CELLS, cells, grid, heading, note, paragraph, print_json, title
from uq.result.result import Result
from uq.stats.estimate_text import failed_bounds_text
from uq.text.numbers import in_brackets, threshold
from uq.text.quantities import read_threshold
from uq.text.units import typical, unit_of


def fleet(
    result: Path,
    size: int,
    by: Sequence[str],
    allow: int,
    output: str | None,
    plain: bool,
    json: bool,
) -> None:
    """Show when the first of some units ends, and how many have ended by a time."""
    opened = Result.open(result)
    units = the_life(opened.independent, output).declared.unit if by else ""
    times = [read_threshold("--by", text, "a life", units) for text in by]
    first_ends = fleet_of(opened, size, times, allow, output, plain=plain)
    if json:
        print_json(fleet_facts(first_ends).json)
        return
    title(opened, first_ends.design)
    unit = unit_of(
        first_ends.units, typical(banded.estimate.value for banded in first_ends.first.values())
    )
    heading(
        f"\n{first_ends.output}{in_brackets(unit)}", f"the first of {size} has {first_ends.ended}"
    )
    _show([(f"quantile {p!r}", banded) for p, banded in first_ends.first.items()], unit.size)
    for time, (failed, at_most) in first_ends.by.items():
        heading(f"\nby {threshold(time, first_ends.units)}")
        kept = f"at most {allow} {'has' if allow == 1 else 'have'} {first_ends.ended}"
        kept = kept if allow else f"none has {first_ends.ended}"
        _show([(f"have {first_ends.ended}", failed), (f"P({kept})", at_most)])
    for text in first_ends.sentences:
        note(text)


def _show(lines: Sequence[tuple[str, Banded]], per: float = 1.0) -> None:
    grid([line for label, banded in lines for line in _lines(label, banded, per)], CELLS)
    for reason in dict.fromkeys(reason for _, banded in lines for reason in reasons(banded)):
        paragraph(reason, indent=2)


def _lines(label: str, banded: Banded, per: float) -> Iterator[tuple[str, str, str]]:
    ends = (("5 % of samples", banded.low), ("95 % of samples", banded.high))
    for name, end in ((label, banded.estimate), *(("  " + text, end) for text, end in ends)):
        yield name, *cells(end, per)
    if worst := failed_bounds_text(banded.failed, per):
        yield "  with failed rows", "", worst
