"""What ``uq fleet`` shows."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from uq.analysis.fleet import fleet_of, reasons
from uq.analysis.fleet_json import fleet_json
from uq.analysis.fleet_numbers import Banded
from uq.cli.printing import grid, heading, note, paragraph, print_json
from uq.rows.results import open_result
from uq.wording import duration, failed_interval, interval, known, number


def fleet(
    result: Path, size: int, by: Sequence[float], allow: int, output: str | None, json: bool
) -> None:
    """Show when the first of some units ends, and how many have ended by a time."""
    ds = open_result(result)
    found = fleet_of(ds, size, by, allow, output)
    if json:
        print_json(fleet_json(found))
        return
    heading(str(ds.attrs["title"]), f"{ds.attrs['source']}, {found.design}")
    heading(f"\n{found.output}", f"the first of {size} ends [s]")
    _show([(f"quantile {p!r}", one) for p, one in found.first.items()], is_time=True)
    for time, (failed, at_most) in found.by.items():
        more = f" ({duration(time)})" if duration(time) else ""
        heading(f"\nby {number(time)} s{more}")
        kept = "none has ended" if allow == 0 else f"at most {allow} have ended"
        _show([("have ended", failed), (f"P({kept})", at_most)])
    for text in found.sentences:
        note(text)


def _show(lines: Sequence[tuple[str, Banded]], is_time: bool = False) -> None:
    grid(
        [line for label, one in lines for line in _lines(label, one, is_time)],
        header=("", "value", "95 % interval", ""),
    )
    for reason in dict.fromkeys(reason for _, one in lines for reason in reasons(one)):
        paragraph(reason, indent=2)


def _lines(label: str, one: Banded, is_time: bool) -> Iterator[tuple[str, str, str, str]]:
    ends = (("5 % of samples", one.low), ("95 % of samples", one.high))
    for name, end in ((label, one.estimate), *(("  " + text, end) for text, end in ends)):
        yield name, known(end), interval(end), duration(end.value) if is_time else ""
    if worst := failed_interval(one.failed):
        yield "  with failed rows", "", worst, ""
