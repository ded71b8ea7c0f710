"""What is wrong with an answer: sentences whose numbers the rows deny, or that deny each other."""

import re
from functools import partial

import numpy as np
from answer_contradictions import denied_by_each_other
from answer_event_checks import denied_advice, denied_event
from answer_whole_checks import denied_enough, denied_levels, denied_mixing
from answered import numbers_in
from scipy.stats import binomtest

from uq.assess.answer.repeat_interval import OPENING
from uq.assess.findings import Findings
from uq.result.elements import dependence_of, independent_rows, labels, named_elements
from uq.result.result import Result
from uq.result.result_file import failed


class Checker:
    """The rows of a result, and what they say of the sentences of an answer."""

    def __init__(self, ds):
        self.ds, self.rows = ds, independent_rows(ds)
        self.findings = Findings(Result(ds))

    def wrong(self, conclusions):
        """Return what is wrong with an answer, in words."""
        return [*self._denied_by_rows(conclusions), *denied_by_each_other(conclusions)]

    def _denied_by_rows(self, conclusions):
        for quantity in conclusions.quantities:
            checks = (
                self.tolerance_bound,
                self.own_error,
                self.range,
                self.ranking,
                self.repeated,
                self.earliest,
            )
            for check in checks:
                yield from (f"{quantity.name}: {text}" for text in check(quantity))
            for event in quantity.events:
                hits = self.hits(quantity, event)
                yield from (
                    f"{event.name}: {text}" for text in denied_event(self.rows, event, hits)
                )
        for event in conclusions.events:
            yield from (f"{event.name}: {text}" for text in self.alone(event))
        for regime in conclusions.regimes:
            hits = (labels(self.rows["regime"]).values == regime.predicate).astype(float)
            yield from (
                f"{regime.predicate}: {text}" for text in denied_event(self.rows, regime, hits)
            )
            if conclusions.regimes_first:
                yield from self.regime_repeated(conclusions.enough.again, regime, hits)
        for advice in conclusions.advice:
            yield from (
                f"{advice.rule}: {text}" for text in denied_advice(self.ds, advice, conclusions)
            )
        yield from denied_mixing(self.ds, conclusions)
        yield from denied_levels(self.ds, conclusions)
        yield from denied_enough(self.ds, conclusions)
        shown = [self.ds.sizes["row"], *([conclusions.failed] if conclusions.failed else [])]
        counts = re.sub(r"(?<=\d) (?=\d{3}\b)", "", conclusions.rows_sentence)
        if sorted(numbers_in(counts)) != sorted(shown):
            yield conclusions.rows_sentence

    def values(self, quantity):
        (element,) = named_elements(self.rows, quantity.name)
        return element.for_thresholds if element.is_angle else element.values

    def defined_values(self, quantity):
        values = self.values(quantity)
        return values[~np.isnan(values)]

    def tolerance_bound(self, quantity):
        """Count the rows beyond a bound; compare a quantile with that of the rows."""
        if quantity.tolerance_bound is None or not quantity.tolerance_bound.sentence:
            return
        text, values = quantity.tolerance_bound.sentence, self.defined_values(quantity)
        piles = r"([\d.]+) % of the rows have the (largest|smallest) value, ([^\s:]+)"
        for share, which, last in re.findall(piles, text):
            end = values.max() if which == "largest" else values.min()
            there = 100 * (values == end).mean()
            if abs(there - float(share)) > 0.06 or there < 5:
                yield text
            if not np.isclose(
                float(last.rstrip(".,")) * quantity.tolerance_bound.unit.per, end, rtol=0.01
            ):
                yield text
        text = re.sub(rf" ?{piles}[^.]*\.", "", text)
        if not text:
            return
        if "confidence" in text:
            if numbers_in(text)[0] != 95:
                yield text
            pattern = r"at least (\S+) % (\D+?) (-?[\d.e+-]+)"
            for coverage, side, bound in re.findall(pattern, text):
                below = (
                    values < float(bound.rstrip(".")) * quantity.tolerance_bound.unit.per
                ).mean()
                share = below if re.search("within|below", side) else 1 - below
                if coverage != "95" or not 0.94 < share < 0.995:
                    yield f"{text} {share}"
        else:
            for part, p in zip(text.split(";"), self._probabilities(text), strict=True):
                coverage, value, *end = numbers_in(part)
                if coverage != 95 or not self._is_quantile(values, p, value, quantity):
                    yield part
                outwards = (end[0] - value) * (1 if p > 0.5 else -1) if end else 0.0
                spread = (
                    quantity.range.high.value - quantity.range.low.value
                ) / quantity.range.unit.per
                if not 0 <= outwards < spread / 3:
                    yield f"conservative: {part}"

    def own_error(self, quantity):
        """Move each row by its error: the bound keeps its rank, and quantiles their share."""
        if quantity.own_error is None or not (sentence := quantity.own_error.sentence):
            return
        values = self.values(quantity)
        (error,) = named_elements(
            self.rows, f"{quantity.output}_error{quantity.name[len(quantity.output) :]}"
        )
        sizes, per = np.abs(error.values), quantity.tolerance_bound.unit.per
        moved = re.findall(r"gives (\S+)(?:.*? and (\S+))?", sentence.split(". ")[0])
        shown = [float(each.rstrip(".")) for each in (moved[0] if moved else ()) if each]
        lower = np.sort(values - sizes), quantity.tolerance_bound.lower, -1
        upper = np.sort(values + sizes), quantity.tolerance_bound.upper, 1
        defined = [each for each in (lower, upper) if np.isfinite(each[1])]
        for bound, (there, now, _) in zip(shown, defined, strict=False):
            rank = np.searchsorted(np.sort(values), now * (1 + 1e-12))
            if not np.isclose(bound * per, there[max(rank - 1, 0)], rtol=0.01):
                yield sentence
        logs = quantity.is_life
        share = np.mean((sizes / values if logs else sizes) ** 2)
        share /= np.var(np.log(values) if logs else values)
        told = re.search(r"error is (\S+) %", sentence)
        if bool(told) != (0.01 <= share < 1) or told and abs(float(told[1]) - 100 * share) > 0.06:
            yield f"{sentence} {share}"

    def _probabilities(self, text):
        return [0.95 if re.search("within|below", part) else 0.05 for part in text.split(";")]

    def _is_quantile(self, values, p, shown, quantity):
        """Whether the share of rows below is that of the quantile, but for chance."""
        away = 4 * np.sqrt(p * (1 - p) / len(values)) + 0.005
        return abs((values < shown * quantity.range.unit.per).mean() - p) < away

    def range(self, quantity):
        if quantity.range is None or not quantity.range.sentence:
            return
        text, values = quantity.range.sentence, self.defined_values(quantity)
        shown = numbers_in(text)
        if text.startswith("90 %"):
            places = dict(zip((0.05, 0.95, 0.5), shown[1:], strict=False))
        elif text.startswith("5 %"):
            median = re.search(r"median (\S+)", text)
            places = {0.05: shown[1]} | ({0.5: float(median[1].rstrip(";"))} if median else {})
        else:
            places = {}
        yield from self.never(quantity, text)
        missing = 100 * np.isnan(self.values(quantity)[~failed(self.rows)]).mean()
        match = re.search(r"(\S+) % of the rows have no value", text)
        if abs((float(match[1]) if match else 0.0) - missing) > 0.06:
            yield text
        for p, value in places.items():
            if not self._is_quantile(values, p, value, quantity):
                yield f"{p} of {text}"

    def never(self, quantity, text):
        """Count the rows that never end; without any, bound them as no hit in as many rows does."""
        never = np.isposinf(self.defined_values(quantity))
        if match := re.search(r"([\d.]+) % \((\S+) to (\S+) %\) never", text):
            exact = binomtest(int(never.sum()), len(never)).proportion_ci()
            ends = [100 * never.mean(), 100 * exact.low, 100 * exact.high]
            if not np.allclose([float(each) for each in match.groups()], ends, atol=1.5):
                yield text
        elif match := re.search(r"at most (\S+) % (?:survive|never)", text):
            bound = 100 * (1 - 0.025 ** (1 / len(never)))
            if never.any() or not 0.98 * bound <= float(match[1]) <= 1.6 * bound:
                yield text

    def repeated(self, quantity):
        """Compare the scatter among seeds with that of the rows drawn again, with replacement."""
        prediction, is_share = quantity.repeated, quantity.first is not None
        if "expected" not in prediction.members:
            return
        shown = numbers_in(prediction.sentence.removeprefix(OPENING))
        if is_share:
            numbers, per = np.nan_to_num(self.hits(quantity, quantity.first)).astype(float), 100
            estimate = np.mean
        else:
            numbers, per = self.values(quantity), 1 / quantity.tolerance_bound.unit.per
            p = shown.pop(0) / 100
            if round(p, 6) not in (0.05, 0.95):
                yield prediction.sentence
                return
            estimate = partial(np.nanquantile, q=p, method="inverted_cdf")
        wide = self.width_again(numbers, estimate) * per
        if "would again be" in prediction.sentence:
            if wide > 0.02 * abs(shown[0]):
                yield f"{prediction.sentence} {wide}"
            return
        low, high = shown[:2]
        if not 0.6 * wide < high - low < 2.2 * wide or not low <= estimate(numbers) * per <= high:
            yield f"{prediction.sentence} {wide}"

    def width_again(self, numbers, estimate):
        """Return the width of the prediction interval, from rows drawn with replacement."""
        random, labels = np.random.default_rng(0), dependence_of(self.rows).labels
        groups = np.arange(len(numbers)) if labels is None else labels
        rows = [np.flatnonzero(groups == group) for group in np.unique(groups)]
        drawn = (random.integers(len(rows), size=len(rows)) for _ in range(200))
        again = [estimate(numbers[np.concatenate([rows[i] for i in each])]) for each in drawn]
        return 2 * 1.96 * 2**0.5 * np.std(again)

    def regime_repeated(self, prediction, regime, hits):
        """Compare the predicted share of a regime with its scatter over rows drawn again."""
        if f"would be {regime.predicate}" not in prediction.sentence:
            return
        low, high, level = numbers_in(prediction.sentence.removeprefix(OPENING))[:3]
        wide = 100 * self.width_again(hits, np.mean)
        if (
            level != 95
            or not 0.6 * wide < high - low < 2.2 * wide
            or not low <= 100 * np.mean(hits) <= high
        ):
            yield f"{prediction.sentence} {wide}"

    def hits(self, quantity, event):
        side, at = re.fullmatch(r"P\(.*([<>])(.*)\)", event.name).groups()
        values = self.values(quantity)
        is_hit = values < float(at) if side == "<" else values > float(at)
        return np.where(np.isnan(values), np.nan, is_hit)

    def ranking(self, quantity):
        if quantity.ranking is None or quantity.ranking.leader is None:
            return
        fresh = self.findings.indices(quantity.ranking.method, quantity.ranking.target).kinds()
        kind = next(each for each in fresh if each.key == quantity.ranking.kind)
        for each in quantity.ranking.contributions:
            values = [fresh[kind][name].value for name in each.inputs]
            per = 100 if each.share_of_variance else 1
            shown = [numbers_in(text)[0] for text in map(each.size_of, each.indices)]
            if not np.allclose(shown, np.multiply(values, per), atol=0.6 * per / 100, rtol=0.01):
                yield f"{each.words}: {each.size}"
            seen = 0.001 if each.share_of_variance else 0.0  # shares are shown in whole per cent
            if not all(is_about_even(index, seen) for index in each.indices):
                yield f"interval of {each.words}: {each.size}"
            for name, change in zip(each.inputs, each.changes, strict=False):
                yield from self.change(quantity, name, change)

    def alone(self, event):
        """Estimate again what the input that decides most explains alone, where that is little."""
        leader = None if event.ranking is None else event.ranking.leader
        if leader is None or not leader.share_of_variance or len(leader.inputs) > 1:
            return
        fresh = self.findings.indices(event.ranking.method, event.ranking.target).kinds()
        kind = next(each for each in fresh if each.key == event.ranking.kind)
        share = 100 * fresh[kind][leader.inputs[0]].value
        told = re.search(r"alone explains only (\S+) %", event.decided_by)
        if bool(told) != (share < 25) or told and abs(float(told[1]) - share) > 0.6:
            yield f"{event.decided_by} {share}"

    def change(self, quantity, name, change):
        """Compare a change with the slope of a regression on this input alone."""
        text = change.sentence()
        if not change.step or not change.by.has_interval or "direction" in text:
            return
        text = text.replace(f" ({change.amount})", "") if change.amount else text
        _, by, *ends = numbers_in(text.replace("one standard deviation", "1"))
        if ends and not ends[0] <= by <= ends[1] or not is_about_even(change.by):
            yield f"interval of {text}"
        (element,) = named_elements(self.rows, quantity.name)
        if element.is_angle and "its signed value" not in text:
            yield f"of the magnitude: {text}"
        x, y = self.rows[name].values, element.values
        if change.unit.name == "%" and change.step == "one standard deviation":
            expected = 100 * abs(np.exp(np.polyfit(x, np.log(y), 1)[0] * x.std()) - 1)
        elif change.unit.name == "%":
            slope = np.polyfit(np.log(x), np.log(y), 1)[0]
            per_cent = float(change.step.removesuffix(" %"))
            expected = 100 * abs((1 + per_cent / 100) ** slope - 1)
        elif change.step == "one standard deviation":
            expected = abs(np.polyfit(x, y, 1)[0]) * x.std() / change.unit.per
        else:
            return
        if abs(by - expected) > 0.15 * expected + 0.01:
            yield f"{name}: {text} {expected}"

    def earliest(self, quantity):
        if (earliest_rows := quantity.earliest) is None:
            return
        values = self.values(quantity)
        # Rows that are not independent are named, too.
        (every,) = named_elements(self.ds, quantity.name)
        everything, everywhere = every.values, self.ds["row"].values
        for number, life in re.findall(r"(\d+) \(([\d.e+-]+)", earliest_rows.first):
            (row_value,) = everything[everywhere == int(number)]
            rank = (everything < row_value).sum()
            if rank >= 3 or not np.isclose(
                float(life) * quantity.range.unit.per, row_value, rtol=0.01
            ):
                yield earliest_rows.first
        if not earliest_rows.inputs:
            return
        first = np.argsort(values, kind="stable")[: earliest_rows.size]
        mask = np.isin(np.arange(len(values)), first)
        share, size = numbers_in(earliest_rows.why)[:2]
        if size != earliest_rows.size or abs(share - 100 * size / np.isfinite(values).sum()) > 0.5:
            yield earliest_rows.why
        for each, unit in zip(earliest_rows.inputs, earliest_rows.units, strict=True):
            x = self.rows[each.name].values / unit.per
            medians = {
                word: (np.median(x[mask]), np.median(x[~mask])) for word in ("higher", "lower")
            }
            pattern = (
                rf"a (higher|lower) {each.name.replace('_', ' ')} \(median (\S+) against (\S+)"
            )
            for side, median, others in re.findall(pattern, earliest_rows.why):
                shown = [float(median), float(others.rstrip(")."))]
                if (side == "higher") != (shown[0] > shown[1]) or not np.allclose(
                    shown, medians[side], rtol=0.01
                ):
                    yield earliest_rows.why


def is_about_even(effect, seen=0.0):
    """Whether a number is near the middle of its interval, if it has one that can be seen."""
    if not effect.has_interval or 0 <= effect.high - effect.low < seen:
        return True
    uneven = abs(effect.high + effect.low - 2 * effect.value)
    return uneven <= 0.3 * (effect.high - effect.low) + 1e-6 * abs(effect.value)
