"""What ``uq fleet`` shows."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from uq.assess.fleet import fleet_of, reasons, the_life
from uq.assess.fleet_json import fleet_json
from uq.assess.fleet_numbers import Banded
from uq.cli.printing import grid, heading, note, paragraph, print_json
from uq.result.elements import independent_rows
from uq.result.result_file import open_result
from uq.stats.estimate_text import failed_bounds_text, interval_text, value_text
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
    ds = open_result(result)
    units = the_life(independent_rows(ds), output).declared.unit if by else ""
    times = [read_threshold("--by", text, "a life", units) for text in by]
    found = fleet_of(ds, size, times, allow, output, plain=plain)
    if json:
        print_json(fleet_json(found))
        return
    heading(str(ds.attrs["title"]), f"{ds.attrs['source']}, {found.design}")
    unit = unit_of(found.units, typical(one.estimate.value for one in found.first.values()))
    heading(f"\n{found.output}{in_brackets(unit)}", f"the first of {size} has {found.ended}")
    _show([(f"quantile {p!r}", one) for p, one in found.first.items()], unit.size)
    for time, (failed, at_most) in found.by.items():
        heading(f"\nby {threshold(time, found.units)}")
        kept = f"at most {allow} {'has' if allow == 1 else 'have'} {found.ended}"
        kept = kept if allow else f"none has {found.ended}"
        _show([(f"have {found.ended}", failed), (f"P({kept})", at_most)])
    for text in found.sentences:
        note(text)


def _show(lines: Sequence[tuple[str, Banded]], per: float = 1.0) -> None:
    grid(
        [line for label, one in lines for line in _lines(label, one, per)],
        header=("", "value", "95 % interval"),
    )
    for reason in dict.fromkeys(reason for _, one in lines for reason in reasons(one)):
        paragraph(reason, indent=2)


def _lines(label: str, one: Banded, per: float) -> Iterator[tuple[str, str, str]]:
    ends = (("5 % of samples", one.low), ("95 % of samples", one.high))
    for name, end in ((label, one.estimate), *(("  " + text, end) for text, end in ends)):
        yield name, value_text(end, per=per), interval_text(end, per)
    if worst := failed_bounds_text(one.failed, per):
        yield "  with failed rows", "", worst
