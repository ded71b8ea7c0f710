"""Which rows end first, and what distinguishes them."""

import re

import numpy as np
import pytest
from computed import asking, kinds, linear, with_output

from uq.assess.answer.answer import answer, conclude
from uq.assess.distinguishing_inputs import earliest_rows
from uq.assess.findings import Findings
from uq.render.html.answer import fragment
from uq.render.html.embedded_rows import rows_inside
from uq.result.elements import independent_rows, named_elements
from uq.result.result import Result
from uq.result.row_choice import lowest_row
from uq.stats.order_statistics import mid_ranks


def with_lives(lives, flags=None, **design):
    """Return a result of the linear model with these lives."""
    ds = linear(samples=len(lives), **design)
    return asking(with_output(ds, "life", np.asarray(lives), "lifetime", flags), outputs=["life"])


def lived(law, samples=400, design="monte-carlo", **more):
    """Return a result whose lives are a function of its inputs x1 and x4."""
    ds = linear(design, samples=samples, **more)
    lives = law(ds["x1"].values, ds["x4"].values)
    return asking(with_output(ds, "life", lives, "lifetime"), outputs=["life"])


def test_the_earliest_rows_are_named_with_the_command_that_shows_the_first():
    ds = lived(lambda x1, x4: 3600 * np.exp(-x4 - 0.3 * x1))
    earliest = answer(ds).lead.earliest
    order = np.argsort(ds["life"].values)[:3]
    assert earliest.rows == tuple(ds["row"].values[order])
    named = re.findall(r"(\d+) \(([\d.e+]+)", earliest.first)
    assert [int(number) for number, _ in named] == list(earliest.rows)
    shown = [float(life) * earliest.unit.per for _, life in named]
    assert shown == pytest.approx(ds["life"].values[order], rel=5e-3)
    assert earliest.command == "uq row OUT --lowest life"
    assert lowest_row(Result(ds), "life").number == earliest.rows[0]


def test_commands_that_compute_rows_name_a_model_that_is_not_installed():
    findings = Findings(Result(kinds(analysis={"outputs": ["life"]})))
    assert answer(findings.result).lead.earliest.command.endswith("]' --model FILE")
    assert rows_inside(findings, "a.nc")["model"] == " --model FILE"
    assert rows_inside(Findings(Result(lived(lambda x1, x4: x1))), "a.nc")["model"] == ""


def test_inputs_that_distinguish_the_earliest_rows_are_named_with_direction_and_medians():
    ds = lived(lambda x1, x4: np.exp(-4 * x4 + 2 * x1), samples=1000)
    earliest = answer(ds).lead.earliest
    assert [(input_.name, input_.direction) for input_ in earliest.inputs] == [
        ("x4", 1),
        ("x1", -1),
    ]
    first = np.argsort(ds["life"].values)[:50]
    others = np.setdiff1d(np.arange(1000), first)
    medians = [
        np.median(ds[name].values[rows]) for name in ("x4", "x1") for rows in (first, others)
    ]
    numbers = re.search(
        r"The earliest 5 % \(50 rows\) have a higher x4 \(median ([\d.]+) against ([\d.]+) for the"
        r" others\) and a lower x1 \(median ([\d.]+) against ([\d.]+)\)\.",
        earliest.sentence,
    )
    assert [float(group) for group in numbers.groups()] == pytest.approx(medians, abs=5e-3)
    rank = earliest.inputs[0].rank
    ranks_of_first = np.argsort(np.argsort(ds["x4"].values))[first] + 0.5
    assert (
        rank.value == pytest.approx(ranks_of_first.mean() / 1000)
        and rank.low < rank.value < rank.high
    )


def test_values_at_both_ends_have_no_direction():
    ds = lived(lambda x1, x4: np.exp(-np.abs(x4 - 0.5) + 1e-3 * x1), samples=1000)
    earliest = answer(ds).lead.earliest
    assert earliest.inputs[0].direction == 0 and earliest.inputs[0].outwards == 1
    assert "values of x4 away from the middle of its range" in earliest.sentence
    ds = lived(lambda x1, x4: np.exp(np.abs(x4 - 0.5) + 1e-3 * x1), samples=1000)
    assert "values of x4 near the middle of its range" in answer(ds).lead.earliest.sentence


def test_where_no_input_differs_the_answer_says_so():
    lives = np.random.default_rng(5).uniform(1, 9, 400)
    earliest = answer(with_lives(lives)).lead.earliest
    assert earliest.sentence == (
        "No input differs measurably between the earliest 5 % (20 rows) and the others."
    )


@pytest.mark.slow
def test_inputs_without_effect_are_seldom_named():
    rng, named, inputs = np.random.default_rng(1), 0, linear(samples=400)
    for _ in range(100):
        ds = with_output(inputs, "life", rng.uniform(1, 9, 400), "lifetime")
        earliest = answer(asking(ds, outputs=["life"], sensitivity=["pawn"])).lead.earliest
        named += bool(earliest.inputs)
    assert named <= 12  # 5 % of the time, all four inputs together


def test_a_row_censored_before_may_be_earlier():
    lives, flags = np.linspace(1, 9, 400), np.zeros(400, dtype=bool)
    flags[14] = True
    earliest = answer(with_lives(lives, flags)).lead.earliest
    assert earliest.size == 14
    flags[2] = True
    earliest = answer(with_lives(lives, flags)).lead.earliest
    assert earliest.sentence == "" and len(earliest.rows) == 3


def test_where_fewer_than_five_per_cent_end_these_are_the_earliest():
    lives = np.full(1000, np.inf)
    lives[::50] = np.linspace(1, 2, 20)
    earliest = answer(with_lives(lives)).lead.earliest
    assert (earliest.size, earliest.total) == (20, 1000) and "2 % (20 rows)" in earliest.sentence
    nothing = answer(with_lives(np.full(100, np.inf))).lead
    assert nothing.earliest is None


@pytest.mark.slow
def test_replicates_show_what_differs_and_one_design_alone_does_not():
    law = lambda x1, x4: np.exp(-4 * x4)  # noqa: E731
    ds = lived(law, 64, "saltelli", replicates=8)
    earliest = answer(ds).lead.earliest
    assert earliest.inputs[0].name == "x4"
    rows = independent_rows(ds)
    assert earliest.total == rows.sizes["row"]
    assert answer(lived(law, 512, "sobol")).lead.earliest.sentence == ""


def test_the_regime_of_the_earliest_rows_is_named():
    ds = kinds(samples=400)
    fast = ds["regime"].values == 1
    rng = np.random.default_rng(3)
    ds = asking(
        with_output(ds, "end", np.where(fast, 1.0, 5.0) + rng.uniform(0, 1, 400), "lifetime"),
        outputs=["end"],
    )
    earliest = answer(ds).lead.earliest
    assert earliest.sentence.endswith(
        f"100 % (83.2 to 100 %) of them are fast, against {100 * fast.mean():.1f} % of all rows."
    )


def test_the_regime_of_most_of_the_earliest_rows_is_named_where_all_rows_are_in_it_as_often():
    ds = kinds(samples=400)
    lives = np.random.default_rng(3).uniform(1, 2, 400)
    ds = asking(with_output(ds, "end", lives, "lifetime"), outputs=["end"])
    first = np.argsort(lives)[:20]
    earliest = answer(ds).lead.earliest
    most = earliest.regimes[0]
    of_first = (ds["regime"].values[first] == 1).mean()
    assert most.label == ("fast" if of_first > 0.5 else "slow")
    assert most.share.value == max(of_first, 1 - of_first)
    assert f"are {most.label}, against {100 * most.overall:.1f} % of all rows" in earliest.sentence
    assert earliest.sentence.endswith(": the difference is not significant.")


def test_equal_values_share_their_rank():
    assert mid_ranks(np.array([3.0, 1.0, 1.0, 2.0])).tolist() == [0.875, 0.25, 0.25, 0.625]


def test_successes_have_no_earliest_rows():
    ds = with_lives(np.linspace(1, 9, 400))
    ds["life"].attrs["success"] = "the lock has closed"
    assert answer(ds).lead.earliest is None


def test_page_terminal_and_json_say_the_same():
    ds = lived(lambda x1, x4: np.exp(-4 * x4))
    conclusions = answer(ds)
    lead_rows = conclusions.lead.earliest
    html = str(fragment(conclusions))
    assert "Earliest failures" in html and lead_rows.command in html
    assert lead_rows.sentence in repr(conclusions) and lead_rows.first in repr(conclusions)
    plain = conclude(Findings(Result(ds))).fact.json["quantities"]["life"]["earliest"]
    assert (
        plain["lives"] == dict(zip(map(str, lead_rows.rows), lead_rows.lives, strict=True))
        and plain["sentence"] == lead_rows.sentence
    )
    assert plain["inputs"]["x4"]["rank"] == lead_rows.inputs[0].rank.value


def test_never_more_than_five_per_cent():
    ds = lived(lambda x1, x4: np.exp(-x4), samples=1001)
    (element,) = named_elements(ds, "life")
    assert len(earliest_rows(element)) == 51
