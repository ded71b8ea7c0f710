"""What a report says of the rows: how they ended, and the statistics of the outputs."""

from collections.abc import Iterator, Mapping
from typing import Any

import xarray as xr

from uq.contract import Output, Status
from uq.drawing.figure import place_in_words, powers
from uq.indices.targets import FORMS, split_name
from uq.report.cells import Cell, Table, count, estimate, without_empty_columns
from uq.rows.elements import elements_of, independent_rows
from uq.wording import TimeUnit, number, percent, percent_interval, time_unit, variance_between

Summary = Mapping[str, Any]
"""What `uq.analysis.statistics.summarise` returns."""

_COUNTS = ("never", "censored", "undefined", "failed")


def status_table(ds: xr.Dataset, summary: Summary) -> Table:
    """Return how many rows ended how, what that means, and what the first of them said."""
    meaning = {status.label: status.meaning for status in Status}
    rows = []
    for label, found in summary["status"].items():
        example = str(ds["status"].attrs.get(f"example_{label.replace('-', '_')}", ""))
        share = found / max(summary["samples"], 1)
        cells = (Cell(str(found), key=float(found)), Cell(percent(share), key=share))
        rows.append((Cell(label), *cells, Cell(meaning.get(label, "")), Cell(example)))
    header = ("status", "rows", "share", "meaning", "the first such row said")
    return without_empty_columns(Table("Status of all rows", header, rows))


def regime_table(summary: Summary) -> Table:
    """Return the share of each regime among the independent rows."""
    rows = [
        (Cell(label), Cell(f"{one['count']}", key=float(one["count"])), _share(one))
        for label, one in summary["regime"].items()
    ]
    return Table("Regimes, with 95 % intervals", ("regime", "rows", "share"), rows)


def _share(entry: Mapping[str, Any]) -> Cell:
    if entry["share"] is None:
        return Cell("-")
    ends = [entry[end] for end in ("low", "high")]
    below = "" if None in ends else percent_interval(*ends)
    return Cell(percent(entry["share"]), below, entry["share"])


class Outcome:
    """An element of an output: its entry in the summary, its words, the unit it is told in.

    Parameters
    ----------
    name : str
    words : str
        Which element it is: ``time to wear depth, left, 250 µm``.
    declared : Output
    entry : dict
        Of ``outputs`` in what `uq.analysis.statistics.summarise` returns.
    """

    def __init__(self, name: str, words: str, declared: Output, entry: Mapping[str, Any]):
        self.name, self.words, self.declared, self.entry = name, words, declared, entry
        found = [one["value"] for one in entry["quantiles"].values() if one["value"] is not None]
        typical = abs(found[len(found) // 2]) if found else 0.0
        is_time = entry["units"] == "s"
        self.unit = (
            time_unit(typical)
            if is_time
            else TimeUnit(powers(entry["units"]).replace(" ", "\u00a0"), 1.0, 0.0)
        )

    @property
    def label(self) -> Cell:
        """The name, with its words below."""
        return Cell(self.name, self.words)

    @property
    def unit_cell(self) -> Cell:
        """The unit of the other cells; nothing for a pure number."""
        return Cell("" if self.unit.name == "1" else self.unit.name)

    def in_its_unit(self, value: float) -> str:
        """Return a number of this element, and its unit."""
        return f"{number(value / self.unit.seconds)} {self.unit_cell.text}".strip()

    def cell(self, entry: Mapping[str, Any], key: str = "value") -> Cell:
        """Return the cell of an estimate in the unit of this element."""
        return estimate(entry, self.unit.seconds, key)

    def moment(self, name: str) -> Cell:
        """Return the cell of mean or sd, with the reason where its tail forbids one."""
        found = {"value": self.entry[name], **self.entry[f"{name}_interval"]}
        reason = self.entry["reasons"].get(name)
        if reason is not None:
            return Cell("none", reason)
        cell = self.cell(found)
        if name == "mean" and self.entry["caution"]:
            cell = cell._replace(more=f"{cell.more}; {self.entry['caution']}")
        return cell


def outcomes(ds: xr.Dataset, summary: Summary) -> list[Outcome]:
    """Return the elements that a summary describes, in its order."""
    names = dict.fromkeys(name.partition("[")[0] for name in summary["outputs"])
    found = []
    for element in elements_of(independent_rows(ds), list(names)):
        place = place_in_words(element, ds[element.output])
        words = f"{element.meaning}{', ' if place else ''}{place}"
        entry = summary["outputs"][element.name]
        found.append(Outcome(element.name, words, element.declared, entry))
    return found


def result_tables(found: list[Outcome], tolerance: tuple[float, float] | None) -> Iterator[Table]:
    """Yield the tables of statistics, of tolerance bounds and of thresholds; no empty ones.

    Parameters
    ----------
    found : list of Outcome
    tolerance : tuple of float, optional
        Coverage and confidence of the bounds.
    """
    if not found:
        return
    probabilities = list(found[0].entry["quantiles"])
    quantiles = (f"{100 * float(p):g} % quantile" for p in probabilities)
    header = (
        "output",
        "unit",
        "mean",
        "sd",
        *quantiles,
        "variance between regimes",
        *_COUNTS,
        _MISSED,
    )
    rows = [tuple(_statistics(one)) for one in found]
    yield without_empty_columns(Table("Statistics, with 95 % intervals", header, rows))
    bounded = [one for one in found if one.entry["tolerance"]]
    if bounded and tolerance is not None:
        rows = [
            (one.label, one.unit_cell, *(one.cell(one.entry["tolerance"], end) for end in _ENDS))
            + (count(one.entry["tolerance"]["rows_needed"]),)
            for one in bounded
        ]
        coverage, confidence = (f"{100 * share:g} %" for share in tolerance)
        caption = (
            f"Tolerance bounds: with {confidence} confidence each, {coverage} of all lie above the "
            f"lower, and {coverage} below the upper"
        )
        yield Table(caption, ("output", "unit", *_ENDS, "rows needed"), rows)
    rows = [row for one in found for row in _thresholds(one)]
    if rows:
        header = ("output", "threshold", "P(above)", "P(below)", "note")
        yield without_empty_columns(Table("Probabilities, with 95 % intervals", header, rows))


_ENDS = ("lower", "upper")
_MISSED = "rows short of the accuracy"


def _statistics(one: Outcome) -> Iterator[Cell]:
    entry = one.entry
    yield one.label
    yield one.unit_cell
    for moment in ("mean", "sd"):
        yield one.moment(moment)
    yield from (one.cell(quantile) for quantile in entry["quantiles"].values())
    split = entry.get("between_regimes")
    yield _between(split) if split else Cell("")
    yield from (count(entry[name]) for name in _COUNTS)
    yield _missed(entry.get("accuracy"))


def _missed(accuracy: Mapping[str, Any] | None) -> Cell:
    if not accuracy or not accuracy["missed"]:
        return Cell("")
    return count(accuracy["missed"])._replace(more=percent(accuracy["share"]))


def _between(split: Mapping[str, Any]) -> Cell:
    form, *_ = split_name(split["of"])
    of = f", of the {FORMS[form]}" if form else ""
    return estimate(split)._replace(text=variance_between(split) + of)


def _thresholds(one: Outcome) -> Iterator[tuple[Cell, ...]]:
    for threshold, entry in one.entry["thresholds"].items():
        value = float(threshold)
        told = Cell(one.in_its_unit(value), key=value)
        sides, note = entry, entry.get("reason", "")
        if note:
            sides = entry["kaplan_meier"]
            note += "; after Kaplan and Meier, if censoring says nothing of the life left"
            if none := sides["below"].get("reason"):
                note += f"; {none}"
        yield one.label, told, estimate(sides["above"]), estimate(sides["below"]), Cell(note)


def life_table(found: list[Outcome]) -> Table | None:
    """Return the times by which 1, 10 and 50 % have ended; None where nothing is a lifetime."""
    lives = [one for one in found if one.entry["b_lives"]]
    if not lives:
        return None
    names = tuple(lives[0].entry["b_lives"])
    rows = [
        (one.label, one.unit_cell, *(one.cell(one.entry["b_lives"][name]) for name in names))
        + (count(one.entry["never"]), count(one.entry["censored"]))
        for one in lives
    ]
    header = ("lifetime", "unit", *names, "rows never ending", "rows censored")
    caption = "B-lives: B10 is the time by which 10 % have ended"
    return without_empty_columns(Table(caption, header, rows))
