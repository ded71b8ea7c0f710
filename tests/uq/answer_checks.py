"""What is wrong with an answer: sentences whose numbers the rows deny, or that deny each other."""

import re
from functools import partial

import numpy as np
from scipy.stats import binomtest

import uq
from uq.analysis.findings import Findings
from uq.rows.elements import (
    are_independent,
    independent_rows,
    labels,
    named_elements,
    replicates_of,
)

NUMBER = re.compile(r"(?<![\w.])-?\d[\d.]*(?:e[-+]?\d+)?")


def numbers_in(text):
    """Return the numbers of a sentence, without those of names such as x1."""
    return [float(one.rstrip(".")) for one in NUMBER.findall(text)]


class Checker:
    """The rows of a result, and what they say of the sentences of an answer."""

    def __init__(self, ds):
        self.ds, self.rows = ds, independent_rows(ds)
        self.findings = Findings(ds)

    def wrong(self, found):
        """Return what is wrong with an answer, in words."""
        return [*self._denied_by_rows(found), *denied_by_each_other(found)]

    def _denied_by_rows(self, found):
        for one in found.quantities:
            checks = (self.promise, self.range, self.ranking, self.repeated, self.earliest)
            for check in checks:
                yield from (f"{one.name}: {text}" for text in check(one))
            for event in one.events:
                hits = self.hits(one, event)
                yield from (f"{event.name}: {text}" for text in self.event(event, hits))
        for regime in found.regimes:
            hits = (labels(self.rows["regime"]).values == regime.said).astype(float)
            yield from (f"{regime.said}: {text}" for text in self.event(regime, hits))
        for advice in found.advice:
            yield from (f"{advice.rule}: {text}" for text in self.advice(advice, found))
        shown = [self.ds.sizes["sample"], *([found.failed] if found.failed else [])]
        if sorted(numbers_in(found.rows_sentence)) != sorted(shown):
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

    def event(self, event, hits):
        """Count how often it happens, everywhere, and where it does least and most."""
        if not event.sentence or "not known" in event.sentence:
            return
        shown = numbers_in(event.sentence)
        share = 100 * np.nan_to_num(hits).mean()
        if event.share.has_interval:
            value, low, high = shown[:3]
            if not (low <= value <= high and low - 0.06 <= share <= high + 0.06):
                yield event.sentence
            far = 0.15 if are_independent(self.rows) else 0.35
            exact = binomtest(round(np.nansum(hits)), len(hits)).proportion_ci()
            ends = 100 * exact.low, 100 * exact.high
            if not np.allclose((low, high), ends, atol=far * (ends[1] - ends[0]), rtol=0):
                yield f"interval of {event.sentence}"
        elif abs(shown[0] - share) > 0.06:
            yield event.sentence
        if event.undefined and abs(shown[-1] - 100 * np.isnan(hits).mean()) > 0.06:
            yield event.sentence
        if event.curve is not None:
            x = self.rows[event.over].values / event.over_unit.per
            pattern = r"([\d.]+) % where it is (above|below|between) (\S+)(?: and (\S+))?"
            for percent, side, first, last in re.findall(pattern, event.decided_by):
                first, last = (float(end.rstrip(".")) if end else np.nan for end in (first, last))
                inside = {
                    "above": x > first,
                    "below": x < first,
                    "between": (x > first) & (x < last),
                }
                there = np.isfinite(hits) & inside[side]
                if abs(100 * hits[there].mean() - float(percent)) > 8:
                    yield f"{percent} % of {event.decided_by}"

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
            if not all(map(is_about_even, each.indices)):
                yield f"interval of {each.words}: {each.size}"
            for name, change in zip(each.inputs, each.changes, strict=False):
                yield from self.change(one, name, change)

    def change(self, one, name, change):
        """Compare a change with the slope of a regression on this input alone."""
        text = change.sentence()
        if not change.step or not change.by.has_interval or "direction" in text:
            return
        _, by, *ends = numbers_in(text.replace("one standard deviation", "1"))
        if ends and not ends[0] <= by <= ends[1] or not is_about_even(change.by):
            yield f"interval of {text}"
        (element,) = named_elements(self.rows, one.name)
        if element.is_angle and "its signed value" not in text:
            yield f"of the magnitude: {text}"
        x, y = self.rows[name].values, element.values
        if change.unit.name == "%":
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

    def advice(self, advice, found):
        if advice.rule == "rows" and advice.rows is not None:
            wanted, now = re.match(r"\D*([\d ]+) rows .*instead of ([\d ]+):", advice.text).groups()
            if int(now.replace(" ", "")) != self.ds.sizes["sample"]:
                yield advice.text
            if not 0 <= int(wanted.replace(" ", "")) - advice.rows + 1 < 0.11 * advice.rows + 1:
                yield advice.text
        one = advice.tightened
        if one is None or one.reason:
            return
        first, then, *ends = numbers_in(one.sentence.split(" from ")[1])
        known = [
            event.share.value for event in found.quantities[0].events if event.said in one.what
        ]
        if known and abs(first - 100 * known[0]) > 0.06:
            yield one.sentence
        if ends and not ends[0] <= then <= ends[1]:
            yield one.sentence
        fresh = uq.trace(self.ds, one.key)["value"] * (100 if one.is_share else 1 / one.unit.per)
        if abs(then - fresh) > 0.01 * abs(fresh) + 0.06:
            yield f"{one.sentence} {fresh}"


def is_about_even(one):
    """Whether a number is near the middle of its interval, if it has one."""
    if not one.has_interval:
        return True
    uneven = abs(one.high + one.low - 2 * one.value)
    return uneven <= 0.3 * (one.high - one.low) + 1e-6 * abs(one.value)


def denied_by_each_other(found):
    """Yield pairs of sentences that cannot both be true."""
    rules = {one.rule for one in found.advice}
    if "nothing" in rules and rules & {"rows", "measure", "failed"}:
        yield "nothing to do, and something"
    texts = [one.text for one in found.advice]
    if sum(one.share.value for one in found.regimes) > 1 + 1e-9:
        yield "regimes that are more than all"
    for one in found.quantities:
        yield from (f"{one.name}: {text}" for text in _of_quantity(one))
    if (lead := found.lead) is None:
        return
    for advice in found.advice:
        for event in lead.events:
            flat = event.ranking is not None and event.ranking.denies_a_leader
            if flat and advice.rule == "tighten" and event.said in advice.text:
                yield f"{event.decided_by} {advice.text}"
            if advice.rule == "measure" and f"how many {event.said}" in advice.text:
                named = event.ranking and event.ranking.leader and event.ranking.leader.inputs
                if not set(advice.inputs) <= set(named or ()):
                    yield f"{event.decided_by} {advice.text}"
    own = f"({lead.words})"
    for text in texts:
        alone = len(found.quantities) == 1
        if "which inputs matter is not settled" in text and (own in text or alone):
            if lead.ranking is not None and lead.ranking.leader is not None:
                yield f"{lead.ranking.sentence} {text}"


def _of_quantity(one):
    low, median, high = (
        (one.range.low.value, one.range.median.value, one.range.high.value)
        if one.range is not None
        else (np.nan,) * 3
    )
    if low > median or median > high:
        yield "a range that is no range"
    if one.promise is not None and (one.promise.lower > low or one.promise.upper < high):
        if one.promise.coverage == 0.95:
            yield f"{one.promise.sentence} {one.range.sentence}"
    for event in one.events:
        at, below = float(re.search(r"[<>]([^<>]*)\)$", event.name)[1]), "<" in event.name
        share = event.share.value if below else 1 - event.share.value - event.undefined
        for p, value in ((0.05, low), (0.5, median), (0.95, high)):
            if np.isfinite(value) and event.undefined == 0 and abs(value - at) > 1e-3 * abs(at):
                if (share > p + 0.02) if at < value else (share < p - 0.02):
                    yield f"{event.sentence} {one.range.sentence}"
        if event.curve is not None:
            ends = [event.curve.shares[i].value for i in (event.curve.least, event.curve.most)]
            if event.undefined == 0 and not ends[0] - 1e-9 <= event.share.value <= ends[1] + 1e-9:
                yield f"{event.sentence} {event.decided_by}"
    moved = {}
    for each in one.ranking.contributions if one.ranking else ():
        moved |= {n: c.direction for n, c in zip(each.inputs, each.changes, strict=False)}
    for apart in (one.earliest.inputs or ()) if one.earliest else ():
        if apart.direction * moved.get(apart.name, 0) > 0:  # what shortens it is higher, not lower
            yield f"{one.ranking.with_effect} {one.earliest.why}"
