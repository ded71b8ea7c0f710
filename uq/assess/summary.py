"""Summary of a result: status and regimes of rows, and the statistics of each output."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain

import numpy as np

from uq.assess.failed_rows import failed_share_bounds
from uq.assess.integrated_inputs import elements_with_laws
from uq.assess.life_fit import Fit, fits_of
from uq.assess.reweighting import Weighting
from uq.assess.sample import in_categories, share, share_of
from uq.assess.statistic import Context, Statistic, StatisticKind
from uq.assess.statistics.table import STATISTICS
from uq.assess.stopping import why_ended
from uq.contract import Mask
from uq.result.element import Element
from uq.result.elements import flags
from uq.result.nesting import size_in_words
from uq.result.result import Result
from uq.result.weights import ONLY_INSPECTED
from uq.stats.estimate import Estimate
from uq.stats.importance_weights import ImportanceWeights
from uq.stats.intervals import share_interval
from uq.stats.order_statistics import finite_part
from uq.stats.weighted_means import weighted_share
from uq.study.file import AnalysisTable
from uq.text.units import ReadableUnit, typical, unit_of

NO_INTERVALS = (
    "no intervals: the rows of a '{design}' design are not independent, and a single replicate"
    " cannot show the scatter of its estimates; set replicates = 8"
)

NOT_STATED = (
    "no intervals: how the imported rows were drawn is unknown; if they are independent draws from"
    " the laws, set independent = true in [design]"
)

SEVERAL_ROWS = (
    "the rows of one sample are not independent ({size}): intervals are computed from samples"
)
NO_STATISTICS = "no statistics: the rows of a '{design}' design {why}; see 'uq sensitivity'"

SOME_FAILED = (
    "{most} of {rows} independent rows are invalid. Estimates use the others; each probability,"
    " quantile and B-life also has bounds with the invalid rows at best and at worst"
)


SHARE = StatisticKind(form="share")

_DIGITS = 5  # of numbers in tables
_FEWEST_STEPS = 10  # of the last digit, within the range of the values

REGIME = "regime"
"""The category that distinguishes rows in tables and figures."""

Shares = Mapping[str, Statistic]
"""Label -> its share."""


@dataclass(frozen=True)
class Described:
    """An element of an output.

    Attributes
    ----------
    units : str
    parts : dict of str to tuple of Statistic
        Name in `uq.assess.statistics.table.STATISTICS` -> its statistics, in that order.
    middle : tuple of float, optional
        The 5 %, 50 % and 95 % order statistics of its finite values; empty without one.
    recurs : bool
        Whether rows have equal values.
    fits : dict of str to Fit, optional
        Law -> its fit or refusal.
    """

    units: str
    parts: Mapping[str, tuple[Statistic, ...]]
    middle: tuple[float, ...] = ()
    recurs: bool = False
    fits: Mapping[str, Fit] = field(default_factory=dict)

    @property
    def statistics(self) -> tuple[Statistic, ...]:
        """All of them in order."""
        return tuple(chain.from_iterable(self.parts.values()))

    @property
    def readable_unit(self) -> ReadableUnit:
        """The unit in which its values are shown, from the size of its quantiles.

        Where censoring leaves all of them open, from their estimates and those of B-lives.
        """
        quantiles = self.parts.get("quantiles", ())
        size = typical(statistic.estimate.value for statistic in quantiles)
        guesses = (*quantiles, *self.parts.get("b_lives", ()))
        lives = (guess for guess in guesses if guess.unit == self.units)
        return unit_of(self.units, size or typical(life.best.estimate.value for life in lives))

    def find(self, *key: str) -> Statistic | None:
        """Return the statistic with this key."""
        return next((statistic for statistic in self.statistics if statistic.key == key), None)


@dataclass(frozen=True, kw_only=True)
class Summary:
    """The summary of a result.

    Attributes
    ----------
    result : Result
        All rows, or those in a regime.
    rows : Result
        The independent rows, on which everything but `status` is based.
    status : dict of str to int
        Number of rows with each status, of all rows.
    shares : dict of str to dict
        Of each element of a category that is shown, such as the period, and of the regime in any
        case: label -> `Statistic` of its share, with ``count`` among its facts.
    outputs : dict of str to Described
        By name of the element.
    most_failed : int
        The largest number of rows that lack an element because they failed.
    notes : list of str
        Sentences on missing estimates.
    why_ended : str
        Why a run with `until` ended, in a few words; "" for others.
    weights : ImportanceWeights, optional
        Of the rows, where inspections have weighted them.
    beside : dict of str to Described
        By name of the element, what was asked for beside.
    """

    result: Result
    rows: Result
    status: Mapping[str, int]
    shares: Mapping[str, Shares]
    outputs: Mapping[str, Described]
    most_failed: int
    notes: list[str]
    why_ended: str = ""
    weights: ImportanceWeights | None = None
    beside: Mapping[str, Described] = field(default_factory=dict)

    @property
    def samples(self) -> int:
        """Number of all rows."""
        return len(self.result)

    @property
    def rows_used(self) -> int:
        """Number of independent rows."""
        return len(self.rows)

    @property
    def regimes(self) -> Shares:
        """Share of each declared regime, 0 if it does not occur; empty without regimes."""
        return self.shares.get(REGIME, {})

    @property
    def categories(self) -> dict[str, Shares]:
        """Shares of the labels that occur, of categories other than the regime."""
        return {
            name: {
                label: statistic for label, statistic in shares.items() if statistic.facts["count"]
            }
            for name, shares in self.shares.items()
            if name != REGIME
        }


def summarise(
    result: Result,
    analysis: AnalysisTable | None = None,
    *,
    regime: str | None = None,
    fits: bool = False,
    plain: bool = False,
    weighting: Weighting | None = None,
    parts: Collection[str] = STATISTICS,
    beside: tuple[AnalysisTable, Collection[str]] | None = None,
) -> Summary:
    """Describe a result.

    Parameters
    ----------
    result : Result
        A result.
    analysis : AnalysisTable, optional
        Statistics to report; by default those of the study of the result.
    regime : str, optional
        Describe only the rows in this regime; rows that failed without one count as failed.
    fits : bool
        Whether each lifetime also has the laws fitted to it.
    plain : bool
        Whether lives are taken as computed, and nothing that only scales them is integrated.
    weighting : Weighting, optional
        Makes the rows those of another study; none within a regime.
    parts : collection of str
        Names in `STATISTICS` of the statistics to compute.
    beside : tuple of AnalysisTable and collection of str, optional
        Other statistics to report of the same outputs, and the names of those to compute.

    Returns
    -------
    Summary
    """
    analysis = analysis or result.analysis
    if fits:
        result.refuse_if_weighted("laws fitted to lives")
    why_ended, notes = _notes(result)
    if regime is not None:
        result = result.within_regime(regime)
    rows = result.independent
    of_all = rows.weights if weighting is None else weighting.all_inputs
    context = Context(rows, analysis, of_all)
    other = None if beside is None else (replace(context, analysis=beside[0]), beside[1])
    outputs, others, most = dict[str, Described](), dict[str, Described](), 0
    plain = plain or regime is not None  # within a regime, inputs have another law
    names = result.shown_outputs(analysis)
    elements = (
        elements_with_laws(rows, names, plain=plain) if not weighting else weighting.elements(names)
    )
    for element in elements:  # one at a time in memory
        outputs[element.name] = _described(element, context, fits, parts)
        if other is not None:
            others[element.name] = _described(element, other[0], False, other[1])
        most = max(most, int(element.failed.sum()))
        context.samples.clear()
    if most:
        notes.append(SOME_FAILED.format(most=most, rows=len(rows)))
    return Summary(
        result=result,
        rows=rows,
        status=status_counts(result),
        shares={name: category_shares(rows, name, of_all) for name in _categories(result, names)},
        outputs=outputs,
        most_failed=most,
        notes=notes,
        why_ended=why_ended,
        weights=of_all if weighting is None else None,
        beside=others,
    )


def _described(
    element: Element, context: Context, fits: bool, wanted: Collection[str]
) -> Described:
    parts = {
        name: tuple(
            statistic if statistic.by else replace(statistic, by=(STATISTICS[name],))
            for statistic in STATISTICS[name](element, context)
        )
        for name in wanted
    }
    middle = middle_of(element)
    if step := resolution(middle, _FEWEST_STEPS * 10.0**-_DIGITS):
        for name, statistics in parts.items():
            parts[name] = tuple(
                replace(statistic, resolution=step)
                if statistic.is_value_in(element.units)
                else statistic
                for statistic in statistics
            )
    fitted = {}
    if fits and element.is_lifetime:
        fitted = fits_of(element, context.rows.dependence.is_none, context.rows.is_field_record)
    return Described(element.units, parts, middle, _recurs(element), fitted)


def middle_of(element: Element) -> tuple[float, ...]:
    """Return the 5 %, 50 % and 95 % order statistics of its finite values, if it has any."""
    values = finite_part(element.ascending)
    if not len(values):
        return ()
    return tuple(values[[int(p * (len(values) - 1)) for p in (0.05, 0.5, 0.95)]].tolist())


def _recurs(element: Element) -> bool:
    """Return whether rows have equal values, of an angle equal magnitudes."""
    if element.is_angle or element.censored.any():
        ascending = np.sort(element.for_thresholds[element.present & ~element.censored])
    else:
        ascending = element.ascending
    values = finite_part(ascending)
    return bool((values[1:] == values[:-1]).any())


def resolution(middle: tuple[float, ...], least: float) -> float:
    """Return the difference that digits must show where an output is far from 0 for its scatter.

    Parameters
    ----------
    middle : tuple of float
        See `middle_of`.
    least : float
        Range of the middle 90 % over their median from which the usual digits suffice.

    Returns
    -------
    float
        A hundredth of that range; 0 where the usual digits suffice.
    """
    if not middle:
        return 0.0
    low, median, high = middle
    return (high - low) / 100 if high - low < least * abs(median) else 0.0


def status_counts(result: Result) -> dict[str, int]:
    """Return the number of rows, of all, with each status that occurs and with ``ok``."""
    codes = result.dataset["status"].values
    counts = {label: int((codes == code).sum()) for code, label in flags(result.dataset["status"])}
    return {label: count for label, count in counts.items() if count or label == "ok"}


def _categories(result: Result, shown: Collection[str]) -> list[str]:
    """Return the elements of the categories that are shown, and the regime."""
    return [
        element
        for name, output in result.outputs.items()
        if output.is_category and (name in shown or name == REGIME)
        for element in result.codes(name)
    ]


def category_shares(
    rows: Result, name: str, weights: ImportanceWeights | None = None
) -> dict[str, Statistic]:
    """Return the share of each label of a category among the independent rows that did not fail.

    The name is an output, or one element of it.
    """
    dependence = rows.dependence

    def estimate(hits: Mask, kept: Mask) -> Estimate:
        if weights is None:
            return share_of(hits[kept], dependence[kept])
        if weights.refusal:
            return Estimate(reason=weights.refusal)
        return weighted_share(hits[kept].astype(float), weights.weights[kept], dependence[kept])

    return {
        label: Statistic(
            (name, label) if name == REGIME else ("categories", name, label),
            label,
            estimate(hits, kept),
            kind=SHARE,
            failed=failed_share_bounds(hits, ~kept, dependence) if weights is None else None,
            facts={"count": int(hits[kept].sum())},
            estimator=share(),
            by=(share_of, share_interval) if weights is None else (weighted_share,),
        )
        for label, (kept, numbers) in in_categories(rows, name).items()
        for hits in [numbers > 0]
    }


def _notes(result: Result) -> tuple[str, list[str]]:
    """Return why a run with `until` ended, in a few words, and sentences on missing estimates."""
    if why := result.why_no_statistics:
        return "", [NO_STATISTICS.format(design=result.design_name, why=why)]
    design = result.study.design
    brief, notes = "", list[str]()
    if design.until is not None and not result.has_weights:
        brief, in_full = why_ended(design, result)
        notes.append(in_full)
    if result.is_nested:
        place = result.nesting
        size = size_in_words(place.samples, place.units, place.repeats)
        notes.append(SEVERAL_ROWS.format(size=size))
    notes += filter(None, [result.dataset.attrs.get(ONLY_INSPECTED, ""), why_no_intervals(result)])
    return brief, notes + result.notes_on_places


def why_no_intervals(result: Result) -> str:
    """Return why the rows of a result support no intervals, or ""."""
    if result.has_independent_samples or result.dataset.attrs["replicates"] > 1:
        return ""
    reason = NOT_STATED if result.design.imported else NO_INTERVALS
    return reason.format(design=result.design_name)
