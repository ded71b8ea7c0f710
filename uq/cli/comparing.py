"""What ``uq compare`` shows."""

from pathlib import Path
from typing import Any

from uq.analysis.comparison import comparison, estimates_of
from uq.cli.printing import console, grid, heading, paragraph, print_json
from uq.rows.results import open_result
from uq.wording import Entry, estimated, interval, known, number, time_unit

_TOLD = 6
"""Outputs of which it is said what a change of one input did."""


def compare(first: Path, second: Path, json: bool) -> None:
    """Compare two results and show what was found."""
    found = comparison(open_result(first), open_result(second))
    for key, path in (("a", first), ("b", second)):
        found[key] = {"file": str(path)} | found[key]
    print_json(found) if json else _show(found)


def _show(found: dict[str, Any]) -> None:
    grid([(name.upper(), *_about(found[name])) for name in "ab"], indent=0)
    heading("\nWhat differs in the studies")
    for change in found["changed"]:
        what = change["name"] if change["kind"] == "input" else f"{change['kind']} {change['name']}"
        heading(f"  {what.removeprefix('design design').strip() or 'design'}")
        grid([("A", change["a"]), ("B", change["b"])], indent=4)
    if not found["changed"]:
        paragraph("nothing", indent=2)
    if found["regime"]:
        heading("\nregime")
        grid([(label, *_cells(one)) for label, one in found["regime"].items()], header=_HEADER)
    for name, output in found["outputs"].items():
        unit, per = _unit(output)
        heading(f"\n{name}{f' [{unit}]' if unit != '1' else ''}")
        lines = []
        for label, one in estimates_of(output):
            if label.startswith("P("):
                lines.append((estimated(label, per), *_cells(one)))
                continue
            lines.append((label, *_cells(one, per)))
            if label == "sd" and one["ratio"]["value"] is not None:
                lines.append(("sd, B over A", "", "", *_apart(one["ratio"], 1.0, 1.0)))
        grid(lines, header=_HEADER)
    console.print()
    paragraph("*: this interval excludes no difference. " + _MANY, indent=0)
    for note in [*bought(found), *found["notes"]]:
        console.print()
        paragraph(note, indent=0)


_HEADER = ("", "A", "B", "B - A", "95 % interval", "")
_MANY = "Of twenty intervals one misses the truth."


def _about(one: dict[str, Any]) -> tuple[str, str]:
    rows = f"{one['samples']} rows"
    if one["rows_used"] < one["samples"]:
        rows += f", {one['rows_used']} independent"
    lost = ", ".join(f"{count} {label}" for label, count in one["status"].items() if label != "ok")
    return one["file"], f"{one['title']} ({rows}{f'; {lost}' if lost else ''})"


def _unit(output: Entry) -> tuple[str, float]:
    """Return the unit that an output is told in, and its length: that of the times to be told."""
    medians = [one["a"]["value"] for one in output["quantiles"].values()]
    typical = medians[len(medians) // 2] if medians else None
    if output["units"] != "s" or typical is None:
        return output["units"], 1.0
    unit = time_unit(abs(typical))
    return unit.name, unit.seconds


def _cells(one: Entry, per: float = 1.0) -> tuple[str, ...]:
    return (known(one["a"], per=per), known(one["b"], per=per), *_apart(one["difference"], per))


def _apart(one: Entry, per: float, nothing: float = 0.0) -> tuple[str, str, str]:
    """Return value and interval of a difference, and a mark where it excludes `nothing`."""
    low, high = one["low"], one["high"]
    sure = (low is not None and low > nothing) or (high is not None and high < nothing)
    ends = "identical rows" if one.get("identical") else interval(one, per)
    return known(one, per=per), ends, "*" if sure else ""


def bought(found: dict[str, Any]) -> list[str]:
    """Return in sentences what the change of a single input did to the scatter of the outputs."""
    only = found["only"]
    if only is None:
        return []
    unit = "" if only["units"] == "1" else f" {only['units']}"
    sds, means = only["sd"], only["mean"]
    told = f"sd {number(sds['a'])} to {number(sds['b'])}{unit}"
    if abs(means["b"] - means["a"]) > 0.1 * max(sds.values()):
        told += f", mean {number(means['a'])} to {number(means['b'])}{unit}"
    sentences = [f"Only {only['name']} differs ({told})."]
    for name, output in list(found["outputs"].items())[:_TOLD]:
        ratio = output["sd"]["ratio"]
        if ratio["value"] is None:
            continue
        ends = interval(ratio)
        change = 1 - ratio["value"] ** 2
        words = f"{abs(change):.0%} {'less' if change > 0 else 'more'} variance"
        sentences.append(
            f"sd of {name}: {number(ratio['value'])} times what it was"
            f"{f' ({ends})' if ends else ''}, {words}."
        )
    return [" ".join(sentences)]
