"""What is wrong with what an answer says of events and advises: the rows deny it."""

import re

import numpy as np
from answered import numbers_in
from scipy.stats import binomtest

import uq
from uq.result.result import Result
from uq.result.result_file import failed


def denied_event(rows, event, hits):
    """Count how often it happens, everywhere, and where it does least and most."""
    if not event.sentence or "cannot be estimated" in event.sentence:
        return
    shown = numbers_in(event.sentence)
    share = 100 * np.nan_to_num(hits).mean()
    if event.share.has_interval:
        value, low, high = shown[:3]
        if not (low <= value <= high and low - 0.06 <= share <= high + 0.06):
            yield event.sentence
        far = 0.15 if Result(rows).has_independent_rows else 0.35
        exact = binomtest(round(np.nansum(hits)), len(hits)).proportion_ci()
        ends = 100 * exact.low, 100 * exact.high
        if not np.allclose((low, high), ends, atol=far * (ends[1] - ends[0]), rtol=0):
            yield f"interval of {event.sentence}"
    elif abs(shown[0] - share) > 0.06:
        yield event.sentence
    if event.undefined and abs(shown[-1] - 100 * np.isnan(hits).mean()) > 0.06:
        yield event.sentence
    if event.curve is not None:
        x = rows[event.over].values / event.over_unit.per
        pattern = r"([\d.]+) % (above|below|between) (\S+)(?: and (\S+))?"
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
        yield from _denied_limit(event, x, hits)


def _denied_limit(event, x, hits):
    """Count how often the unwanted side happens within a range where it is rare, and before it."""
    if event.limit is None or event.limit.why:
        return
    few, share, *place = re.fullmatch(
        r"With 95 % confidence, (fewer|more) than (\S+) % .* if .* is"
        r" (?:at (least|most) ([\d.e-]+)|between ([\d.e-]+) and ([\d.e-]+))\D*\.",
        event.limited,
    ).groups()
    unwanted = 1 - hits if few == "more" else hits
    is_defined, at = np.isfinite(hits), event.limit.at / event.over_unit.per  # in the unit of `x`
    beyond = is_defined & ((x > at) if event.limit.is_lower else (x < at))
    if (
        share != ("95" if few == "more" else "5")
        or beyond.sum() < 30
        or beyond.sum() == is_defined.sum()
    ):
        yield event.limited
        return
    shown = [float(number) for number in place[1:] if number is not None]
    if not any(abs(number - at) <= 0.006 * abs(number) for number in shown):
        yield event.limited
    outer = x[is_defined].max() if event.limit.is_lower else x[is_defined].min()
    if len(shown) > 1 and not any(abs(end - outer) <= 0.006 * abs(end) for end in shown):
        yield event.limited
    if unwanted[beyond].mean() >= 0.05:
        yield event.limited
    if unwanted[beyond].mean() >= unwanted[is_defined & ~beyond].mean():
        yield event.limited


def denied_advice(ds, advice, conclusions):
    if advice.rule == "rows" and advice.rows is not None:
        wanted, now = re.match(r"\D*([\d ]+) rows .*instead of ([\d ]+):", advice.text).groups()
        if int(now.replace(" ", "")) != ds.sizes["row"]:
            yield advice.text
        if not 0 <= int(wanted.replace(" ", "")) - advice.rows + 1 < 0.11 * advice.rows + 1:
            yield advice.text
    tolerance = advice.tightened
    if tolerance is None or tolerance.reason:
        return
    first, then, *ends = numbers_in(tolerance.sentence.split(" from ")[1])
    shares = [
        event.share.value
        for event in conclusions.quantities[0].events
        if event.predicate in tolerance.statistic
    ]
    if shares and abs(first - 100 * shares[0]) > 0.06:
        yield tolerance.sentence
    if ends and not ends[0] <= then <= ends[1]:
        yield tolerance.sentence
    for each in (tolerance, *advice.tolerances):
        per = 100 if each.is_share else 1 / each.unit.per
        fresh, shown = uq.trace(ds, each.key)["value"] * per, numbers_in(each.text(each.after))[0]
        if abs(shown - fresh) > 0.01 * abs(fresh) + 0.06:
            yield f"{each.sentence} {fresh}"
        before = _before(conclusions.lead, each)
        if abs(each.before.value - before) > 1e-9 * abs(before):
            yield f"before: {each.sentence}"
        yield from _denied_law(ds, each)
    told = (
        re.findall(
            r"The (\w+) end of the 95 % interval of the (\S+) % quantile",
            advice.sure.bound_sentence,
        )
        if advice.sure
        else [("lower", "5")]
    )
    if (
        told not in ([("lower", "5")], [("upper", "95")])
        or conclusions.lead.tolerance_bound.coverage != 0.95
    ):
        yield advice.sure.bound_sentence if advice.sure else f"coverage of {tolerance.sentence}"
    if tolerance.harms or (
        tolerance.wants_more is not None and tolerance.rises != tolerance.wants_more
    ):
        yield tolerance.sentence
    yield from _denied_besides(ds, advice, conclusions.lead)
    yield from _not_alike(advice)


def _before(lead, tolerance):
    """Return the same number of the answer."""
    if tolerance.is_share:
        return next(
            event.share.value for event in lead.events if event.predicate in tolerance.statistic
        )
    return lead.tolerance_bound.quantiles["95 %" in tolerance.statistic].value


def _denied_law(ds, tolerance):
    """Compare half the scatter with the law of the study, and the numbers behind the key."""
    laws = {name: Result(ds).study.uncertain[name] for name in tolerance.inputs}
    texts = dict(re.findall(r"(?:^|; )([^:;]+): ([^:;]+)", tolerance.law)) or dict.fromkeys(
        (name.replace("_", " ") for name in laws), tolerance.law
    )
    for name, law in laws.items():
        then, now = (numbers_in(text) for text in texts[name.replace("_", " ")].split("instead of"))
        widths = [getattr(law, key, None) for key in ("sd", "cv", "sigma")]
        wide = next((width for width in widths if width is not None), None)
        if wide is None:
            ratio = (then[1] - then[0]) / (now[1] - now[0])
            if law.distribution != "loguniform" and abs(ratio - 0.5) > 0.01:
                yield f"{name}: {tolerance.law}"
        elif abs(then[0] / now[0] - 0.5) > 0.01 or f"{wide:.2e}"[:4] != f"{now[0]:.2e}"[:4]:
            yield f"{name}: {tolerance.law}"


def _denied_besides(ds, advice, lead):
    """Compare what could be promised, and what gets worse, with the same rows weighted anew."""
    for sure in [
        tolerance for tolerance in advice.effects if tolerance.tolerance_bound is not None
    ]:
        document, p = uq.trace(ds, sure.key), re.search(r"quantiles/(\S+)", sure.key)[1]
        plain = uq.trace(ds, sure.key.partition("]/")[2])  # the same key, of the study's own laws
        end, away = ("low", -1) if float(p) < 0.5 else ("high", 1)
        fresh, before = document[end] / sure.unit.per, plain[end] / sure.unit.per
        if not failed(ds).any() and bool(sure.bound_sentence) != (away * (fresh - before) < 0):
            yield f"{sure.sentence} {fresh} {before}"
        if not sure.bound_sentence:
            continue
        *_, bound, studied = numbers_in(sure.bound_sentence)
        if not failed(ds).any() and not 0 <= away * (studied - before) <= 0.01 * abs(before):
            yield f"{sure.bound_sentence} {before}"
        value = document["value"] / sure.unit.per
        if not 0 <= away * (bound - fresh) <= 0.01 * abs(fresh) or away * (bound - value) < 0:
            yield f"{sure.bound_sentence} {fresh}"
    for each in advice.harmed:
        then = numbers_in(re.split(r" would \w+ to ", each.besides)[1])
        document, per = uq.trace(ds, each.key), 100 if each.is_share else 1 / each.unit.per
        first = _before(lead, each) * per
        fresh = [document[name] * per for name in ("value", "low", "high")]
        is_more = "would rise" in each.besides
        if is_more != (then[0] > first) or (then[0] > first) == each.wants_more:
            yield each.besides
        if (
            first > then[1]
            and first < then[2]
            or not np.allclose(then, fresh, atol=0.06, rtol=0.01)
        ):
            yield f"{each.besides} {fresh}"


def _not_alike(advice):
    """Yield tolerances that are said to help as much as the best one, and do not."""
    best = advice.tightened
    for each in advice.alike:
        gains = [abs(tolerance.after.value - tolerance.before.value) for tolerance in (best, each)]
        wide = max((tolerance.after.high - tolerance.after.low) for tolerance in (best, each))
        if (
            each.statistic != best.statistic
            or gains[1] > gains[0]
            or gains[0] - gains[1] > gains[0] / 3 + wide
        ):
            yield advice.also
