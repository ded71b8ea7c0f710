"""What is wrong with an answer: sentences whose numbers the rows deny, or that deny each other."""

import re
from functools import partial

import numpy as np
from answer_contradictions import denied_by_each_other
from answer_event_checks import denied_advice, denied_event
from answer_whole_checks import denied_enough, denied_levels, denied_mixing
from answered import numbers_in
from scipy.stats import binomtest

from uq.result.result import Result
from uq.assess.findings import Findings
from uq.result.elements import independent_rows, labels, named_elements, replicates_of
from uq.result.result_file import failed


class Checker:
    """The rows of a result, and what they say of the sentences of an answer."""

    def __init__(self, ds):
        self.ds, self.rows = ds, independent_rows(ds)
        self.findings = Findings(Result(ds))

    def wrong(self, found):
        """Return what is wrong with an answer, in words."""
        return [*self._denied_by_rows(found), *denied_by_each_other(found)]

    def _denied_by_rows(self, found):
        for one in found.quantities:
            checks = (
                self.promise,
                self.own_error,
                self.range,
                self.ranking,
                self.repeated,
                self.earliest,
            )
            for check in checks:
                yield from (f"{one.name}: {text}" for text in check(one))
            for event in one.events:
                hits = self.hits(one, event)
                yield from (
                    f"{event.name}: {text}" for text in denied_event(self.rows, event, hits)
                )
        for event in found.events:
            yield from (f"{event.name}: {text}" for text in self.alone(event))
        for regime in found.regimes:
            hits = (labels(self.rows["regime"]).values == regime.said).astype(float)
            yield from (f"{regime.said}: {text}" for text in denied_event(self.rows, regime, hits))
        for advice in found.advice:
            yield from (f"{advice.rule}: {text}" for text in denied_advice(self.ds, advice, found))
        yield from denied_mixing(self.ds, found)
        yield from denied_levels(self.ds, found)
        yield from denied_enough(self.ds, found)
        shown = [self.ds.sizes["sample"], *([found.failed] if found.failed else [])]
        counts = re.sub(r"(?<=\d) (?=\d{3}\b)", "", found.rows_sentence)
        if sorted(numbers_in(counts)) != sorted(shown):
            yield found.rows_sentence

    def values(self, one):
        (element,) = named_elements(self.rows, one.name)
        return element.for_thresholds if element.is_angle else element.values

    def known(self, one):
        values = self.values(one)
        return values[~np.isnan(values)]

    def promise(self, one):
        """Count the rows beyond a bound; compare a quantile with that of the rows."""
        if one.promise is None or not one.promise.sentence:
            return
        text, values = one.promise.sentence, self.known(one)
        piles = r"([\d.]+) % of the rows share the (largest|smallest) value, (\S+)"
        for share, which, last in re.findall(piles, text):
            end = values.max() if which == "largest" else values.min()
            there = 100 * (values == end).mean()
            if abs(there - float(share)) > 0.06 or there < 5:
                yield text
            if not np.isclose(float(last.rstrip(".,")) * one.promise.unit.per, end, rtol=0.01):
                yield text
        text = re.sub(rf" ?{piles}[^.]*\.", "", text)
        if not text:
            return
        if "confidence" in text:
            if numbers_in(text)[0] != 95:
                yield text
            pattern = r"at least (\S+) % (\D+?) (-?[\d.e+-]+)"
            for coverage, side, bound in re.findall(pattern, text):
                below = (values < float(bound.rstrip(".")) * one.promise.unit.per).mean()
                share = below if re.search("within|below", side) else 1 - below
                if coverage != "95" or not 0.94 < share < 0.995:
                    yield f"{text} {share}"
        else:
            for part, p in zip(text.split(";"), self._probabilities(text), strict=True):
                coverage, value, *end = numbers_in(part)
                if coverage != 95 or not self._is_quantile(values, p, value, one):
                    yield part
                outwards = (end[0] - value) * (1 if p > 0.5 else -1) if end else 0.0
                spread = (one.range.high.value - one.range.low.value) / one.range.unit.per
                if not 0 <= outwards < spread / 3:
                    yield f"cautious: {part}"

    def own_error(self, one):
        """Move each row by its error: the bound keeps its rank, and quantiles their share."""
        if one.own_error is None or not (said := one.own_error.sentence):
            return
        values = self.values(one)
        (error,) = named_elements(self.rows, f"{one.output}_error{one.name[len(one.output) :]}")
        sizes, per = np.abs(error.values), one.promise.unit.per
        moved = re.findall(r"would be (\S+)(?:.*? and (\S+))?", said.split(". ")[0])
        shown = [float(each.rstrip(".")) for each in (moved[0] if moved else ()) if each]
        lower = np.sort(values - sizes), one.promise.lower, -1
        upper = np.sort(values + sizes), one.promise.upper, 1
        known = [each for each in (lower, upper) if np.isfinite(each[1])]
        for bound, (there, now, _) in zip(shown, known, strict=False):
            rank = np.searchsorted(np.sort(values), now * (1 + 1e-12))
            if not np.isclose(bound * per, there[max(rank - 1, 0)], rtol=0.01):
                yield said
        logs = one.is_life
        share = np.mean((sizes / values if logs else sizes) ** 2)
        share /= np.var(np.log(values) if logs else values)
        told = re.search(r"error is (\S+) %", said)
        if bool(told) != (0.01 <= share < 1) or told and abs(float(told[1]) - 100 * share) > 0.06:
            yield f"{said} {share}"

    def _probabilities(self, text):
        return [0.95 if re.search("within|below", part) else 0.05 for part in text.split(";")]

    def _is_quantile(self, values, p, shown, one):
        """Whether the share of rows below is that of the quantile, but for chance."""
        away = 4 * np.sqrt(p * (1 - p) / len(values)) + 0.005
        return abs((values < shown * one.range.unit.per).mean() - p) < away

    def range(self, one):
        if one.range is None or not one.range.sentence:
            return
        text, values = one.range.sentence, self.known(one)
        shown = numbers_in(text)
        if text.startswith("90 %"):
            places = dict(zip((0.05, 0.95, 0.5), shown[1:], strict=False))
        elif text.startswith("5 %"):
            median = re.search(r"median (\S+)", text)
            places = {0.05: shown[1]} | ({0.5: float(median[1].rstrip(";"))} if median else {})
        else:
            places = {}
        yield from self.never(one, text)
        missing = 100 * np.isnan(self.values(one)[~failed(self.rows)]).mean()
        said = re.search(r"(\S+) % of the rows have none", text)
        if abs((float(said[1]) if said else 0.0) - missing) > 0.06:
            yield text
        for p, value in places.items():
            if not self._is_quantile(values, p, value, one):
                yield f"{p} of {text}"

    def never(self, one, text):
        """Count the rows that never end; without any, bound them as no hit in as many rows does."""
        never = np.isposinf(self.known(one))
        if found := re.search(r"([\d.]+) % \((\S+) to (\S+) %\) never", text):
            exact = binomtest(int(never.sum()), len(never)).proportion_ci()
            ends = [100 * never.mean(), 100 * exact.low, 100 * exact.high]
            if not np.allclose([float(each) for each in found.groups()], ends, atol=1.5):
                yield text
        elif found := re.search(r"at most (\S+) % never", text):
            bound = 100 * (1 - 0.025 ** (1 / len(never)))
            if never.any() or not 0.98 * bound <= float(found[1]) <= 1.6 * bound:
                yield text

    def repeated(self, one):
        """Compare the scatter among seeds with that of the rows drawn again, with replacement."""
        known = one.repeated
        if not known.what:
            return
        if known.is_share:
            numbers, per = np.nan_to_num(self.hits(one, one.first)).astype(float), 100
            estimate = np.mean
        else:
            numbers, per = self.values(one), 1 / known.unit.per
            p = numbers_in(known.what)[0] / 100
            if round(p, 6) not in (0.05, 0.95):
                yield known.sentence
                return
            estimate = partial(np.nanquantile, q=p, method="inverted_cdf")
        random, part = np.random.default_rng(0), replicates_of(self.rows)
        groups = np.arange(len(numbers)) if part is None else part
        rows = [np.flatnonzero(groups == one) for one in np.unique(groups)]
        drawn = (random.integers(len(rows), size=len(rows)) for _ in range(200))
        again = [estimate(numbers[np.concatenate([rows[i] for i in each])]) for each in drawn]
        wide = 2 * 1.96 * 2**0.5 * np.std(again) * per
        shown = numbers_in(known.sentence.split(known.what)[0 if known.is_share else 1])
        if "would again be" in known.sentence:
            if wide > 0.02 * abs(shown[0]):
                yield f"{known.sentence} {wide}"
            return
        low, high = shown[:2]
        if not 0.6 * wide < high - low < 2.2 * wide or not low <= estimate(numbers) * per <= high:
            yield f"{known.sentence} {wide}"

    def hits(self, one, event):
        side, at = re.fullmatch(r"P\(.*([<>])(.*)\)", event.name).groups()
        values = self.values(one)
        found = values < float(at) if side == "<" else values > float(at)
        return np.where(np.isnan(values), np.nan, found)

    def ranking(self, one):
        if one.ranking is None or one.ranking.leader is None:
            return
        fresh = self.findings.indices(one.ranking.method, one.ranking.target).kinds()
        kind = next(each for each in fresh if each.key == one.ranking.kind)
        for each in one.ranking.contributions:
            values = [fresh[kind][name].value for name in each.inputs]
            per = 100 if each.share_of_variance else 1
            shown = [numbers_in(text)[0] for text in map(each._size, each.indices)]
            if not np.allclose(shown, np.multiply(values, per), atol=0.6 * per / 100, rtol=0.01):
                yield f"{each.words}: {each.size}"
            seen = 0.001 if each.share_of_variance else 0.0  # shares are shown in whole per cent
            if not all(is_about_even(index, seen) for index in each.indices):
                yield f"interval of {each.words}: {each.size}"
            for name, change in zip(each.inputs, each.changes, strict=False):
                yield from self.change(one, name, change)

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

    def change(self, one, name, change):
        """Compare a change with the slope of a regression on this input alone."""
        text = change.sentence()
        if not change.step or not change.by.has_interval or "direction" in text:
            return
        text = text.replace(f" ({change.amount})", "") if change.amount else text
        _, by, *ends = numbers_in(text.replace("one standard deviation", "1"))
        if ends and not ends[0] <= by <= ends[1] or not is_about_even(change.by):
            yield f"interval of {text}"
        (element,) = named_elements(self.rows, one.name)
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

    def earliest(self, one):
        if (said := one.earliest) is None:
            return
        values = self.values(one)
        (every,) = named_elements(self.ds, one.name)  # rows that are not independent are named, too
        everything, everywhere = every.values, self.ds["sample"].values
        for number, life in re.findall(r"(\d+) \(([\d.e+-]+)", said.first):
            (own,) = everything[everywhere == int(number)]
            rank = (everything < own).sum()
            if rank >= 3 or not np.isclose(float(life) * one.range.unit.per, own, rtol=0.01):
                yield said.first
        if not said.inputs:
            return
        first = np.argsort(values, kind="stable")[: said.size]
        mask = np.isin(np.arange(len(values)), first)
        share, size = numbers_in(said.why)[:2]
        if size != said.size or abs(share - 100 * size / np.isfinite(values).sum()) > 0.5:
            yield said.why
        for each, unit in zip(said.inputs, said.units, strict=True):
            x = self.rows[each.name].values / unit.per
            known = {
                word: (np.median(x[mask]), np.median(x[~mask])) for word in ("higher", "lower")
            }
            pattern = (
                rf"a (higher|lower) {each.name.replace('_', ' ')} \(median (\S+) against (\S+)"
            )
            for side, median, others in re.findall(pattern, said.why):
                shown = [float(median), float(others.rstrip(")."))]
                if (side == "higher") != (shown[0] > shown[1]) or not np.allclose(
                    shown, known[side], rtol=0.01
                ):
                    yield said.why


def is_about_even(one, seen=0.0):
    """Whether a number is near the middle of its interval, if it has one that can be seen."""
    if not one.has_interval or 0 <= one.high - one.low < seen:
        return True
    uneven = abs(one.high + one.low - 2 * one.value)
    return uneven <= 0.3 * (one.high - one.low) + 1e-6 * abs(one.value)
