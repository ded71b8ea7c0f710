"""The table as a page."""

import math

from benchmarks.coverage.tally import OURS, Line

HEAD = """# How often each interval holds the truth

Written by `make coverage`. Every interval that is printed says 95 %. Here each is computed again
and again from fresh rows of problems whose answers are known, and counted: how often did it hold
the truth? Beside it stand the intervals that other libraries print for the same rows, or for as
many.

- **covered**: share of the intervals given that held the truth, with the interval of that share
  (Clopper and Pearson, 95 %). Where ours lies outside 93 to 97 %, the last column says why. A
  tolerance bound has one side, and holds in 95 % of cases or more.
- **of**: how many were given; a remark where a part of the repetitions gave none. `make coverage`
  repeats 2,000 times; where this number is smaller, so is what the share is known to.
- **width**: median width of the intervals given, in the unit of the estimate.

Problems: *Ishigami's function*; a *function of two regimes* that jumps by 3 where x1 + x2 passes
1.2, added to x1 + x3; a *life with a heavy tail*, whose P(T > t) falls as t^-3, so that it has a
variance but no skewness; the same life *never ending* in some rows, *censored* at a horizon or at
random times; lives of which 60 % *never end*, known at once, while the others, Weibull, may be
censored; Weibull and lognormal lives; the *g-function*; a *linear function* in two studies;
*Pareto* values without variance or mean; gamma lives and lives with infant mortality, to which
wrong laws are fitted; a *random model*, x1 + (1 + 2 x2) e with noise e; limits with a probability
of 1e-5. Their truths are closed forms or quadratures (`benchmarks/coverage`).

*Held or refused* counts together the intervals that hold and those that are refused with a reason,
which rests on the rows: what is given all the same is then not a fair sample of all.

Printed without an interval, because none would be honest: within-regime sd, extended FAST, RBD-
FAST, delta, PAWN, HDMR and quantile-oriented indices. The last table counts what stands in its
place, the dummy: an input without effect should stay below it in 95 % of cases. What the bootstrap
of others makes of such indices is counted in the table before it.
"""


def page(lines, seconds, missing=()):
    """Return the page, from the lines of all parts but those missing."""
    problems = {}
    for line in lines:
        problems.setdefault(line.problem, []).append(line)
    tables = [_table(problem, own) for problem, own in problems.items()]
    ours = [line for line in lines if line.by == OURS and line.given]
    off = [line.coverage[0] for line in ours if _is_off(line)]
    more = sum(covered > 0.95 for covered in off)
    summary = (
        f"{len(ours)} intervals of ours: {len(ours) - len(off)} cover as said, {more} more often,"
        f" {len(off) - more} less often, for the reasons given. Counted in"
        f" {seconds / 60:.0f} minutes of one core.\n"
    )
    if missing:
        summary += f"\nNot counted yet: {', '.join(missing)}.\n"
    return "\n".join([HEAD, summary, *tables])


def _is_off(line):
    return line._replace(reason="").unexplained


def _table(problem, lines):
    """Return the table of one problem, ours first and the others' below each."""
    order = list(dict.fromkeys(line.what for line in lines))
    ordered = sorted(lines, key=lambda one: (order.index(one.what), one.by != OURS))
    head = [f"## {problem[0].upper()}{problem[1:]}", ""]
    head += ["| | by | covered | of | width | remark |", "| --- | --- | --- | --- | --- | --- |"]
    return "\n".join([*head, *map(_row, ordered), ""])


def _row(line):
    value, low, high = line.coverage
    what, by = line.what.replace("|", "\\|"), line.by
    name = f"**{what}**" if by == OURS else what
    covered = f"{value:.1%} ({low:.1%} to {high:.1%})" if line.given else "none given"
    width = f"{line.width:.3g}" if math.isfinite(line.width) else ""
    told = line.by != OURS or not line.given or _is_off(line)
    remark = line.reason if told else ""
    if line.given < line.repetitions:
        remark = "; ".join(filter(None, [f"{line.repetitions - line.given} not given", remark]))
    return f"| {name} | {by} | {covered} | {line.given} | {width} | {remark} |"


def shown(line: Line) -> str:
    """Return a line for the terminal."""
    value, low, high = line.coverage
    off = " OFF" if line.unexplained else ""
    return (
        f"{line.problem[:44]:44} {line.what:32} {line.by[:34]:34} {value:6.1%}"
        f" ({low:.1%} to {high:.1%}) of {line.given}/{line.repetitions} width {line.width:.3g}{off}"
    )
