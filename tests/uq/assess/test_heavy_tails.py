"""Outputs of which a few rows hold most of the variance: indices of their logarithm or rank."""

import numpy as np
import pytest
from asked_indices import indices, values
from computed import asking, linear, summarised, with_output
from scipy import stats

import uq
from uq.assess.answer.answer import answer
from uq.assess.expected_widths import expected_widths
from uq.assess.findings import Findings
from uq.assess.targets import HEAVY, heaviness, tail_share
from uq.render.html.indices import sensitivity_of
from uq.result.result import Result


def heavy(sign=1, shift=0.0, samples=64):
    """Return a work rate whose logarithm is 0.8 y: lognormal with sigma = 1.3."""
    ds = linear("saltelli", samples=samples, replicates=4)
    work = sign * np.exp(0.8 * ds["y"].values) + shift
    return asking(with_output(ds, "work", work), outputs=["work"])


def only(ds, **asked):
    ((name, entry),) = indices(ds, **asked)["outputs"].items()
    return name, entry


@pytest.mark.parametrize(
    ("law", "share"),
    [(stats.norm, 0.085), (stats.expon, 0.222), (stats.lognorm(1), 0.487), (stats.uniform, 0.03)],
)
def test_the_share_of_the_variance_in_a_hundredth_of_the_rows(law, share):
    x = law.ppf((np.arange(400_000) + 0.5) / 400_000)
    assert tail_share(x) == pytest.approx(share, abs=0.01)
    assert tail_share(1e-200 * x) == pytest.approx(tail_share(1e200 * x)) == tail_share(x)
    assert bool(heaviness(x)) == (share > HEAVY)


def test_so_few_rows_are_judged_by_the_shape_of_their_tail_alone():
    few = stats.pareto(0.8).ppf((np.arange(90) + 0.5) / 90)
    assert tail_share(few) == 0.0 and "finite variance" in heaviness(few)
    assert "1 % of the rows" in heaviness(stats.pareto(0.8).ppf((np.arange(900) + 0.5) / 900))


def test_few_rows_and_constants_have_no_heavy_tail():
    assert not heaviness(np.r_[np.zeros(98), 1e9]) and heaviness(np.r_[np.zeros(99), 1e9])
    assert tail_share(np.full(500, 3.0)) == tail_share(np.array([])) == 0.0
    assert tail_share(np.r_[np.full(300, np.nan), np.arange(50.0)]) == 0.0


def test_a_positive_output_with_a_heavy_tail_stands_as_its_logarithm():
    ds = heavy()
    name, entry = only(ds)
    assert name == "log(work)"
    _, of_y = only(ds, output="y")
    assert values(entry, "ST") == pytest.approx(values(of_y, "ST"))
    assert "of the variance: " in entry["notes"][0] and "logarithm" in entry["notes"][0]
    name, entry = only(ds, output="work")
    assert name == "work" and "log(work)" in entry["notes"][0]
    assert values(entry, "ST")[:2] != pytest.approx(values(of_y, "ST")[:2], abs=0.02)
    assert only(ds, output="log(work)")[0] == "log(work)"


def test_methods_that_compare_distributions_take_it_as_it_is():
    ds = linear(samples=256)
    ds = asking(with_output(ds, "work", np.exp(2 * ds["y"].values)), outputs=["work"])
    for method in ("delta", "pawn"):
        for asked in ({}, {"output": "work"}):
            name, entry = only(ds, method=method, **asked)
            assert name == "work" and not any("variance" in note for note in entry["notes"])
    assert only(ds, method="rbd-fast")[0] == "log(work)"


def test_one_that_is_not_positive_stands_as_its_rank():
    for ds in (heavy(sign=-1), heavy(shift=-10.0)):
        name, entry = only(ds)
        assert name == "rank(work)" and "rank" in entry["notes"][0]
        ranks = asking(with_output(ds, "r", stats.rankdata(ds["work"])), outputs=["r"])
        assert values(entry, "ST") == pytest.approx(values(only(ranks)[1], "ST"))


def test_one_whose_logarithm_is_heavy_too_stands_as_its_rank():
    ds = heavy()
    work = np.exp(np.exp(ds["y"].values) / 50)
    assert only(with_output(ds, "work", work))[0] == "rank(work)"


def test_an_output_without_a_heavy_tail_stands_as_it_is():
    ds = asking(heavy(), outputs=["y"])
    name, entry = only(ds)
    assert name == "y" and entry["notes"] == []


def test_reports_say_what_the_indices_are_of():
    ds = asking(heavy(samples=128), outputs=["work"], sensitivity=["sobol"])
    ((_, (subject,)),) = sensitivity_of(Findings(Result(ds))).values()
    assert subject.words == "Logarithm of the meaning of work"
    assert "share of the variance of the logarithm" in uq.answer(ds).lead.ranking.index_meaning


def test_plans_and_convergence_name_and_judge_the_same_number():
    ds = heavy(samples=128)
    work = expected_widths(Result(asking(ds, outputs=["work", "y"])))
    assert work["work"].indices["ST"] == pytest.approx(work["y"].indices["ST"])
    table = uq.running_estimates(ds, "work")
    assert set(table[table["estimate"] == "ST x4"]["output"]) == {"log(work)"}


def test_convergence_is_of_one_number_however_few_rows_it_has():
    ds = linear("saltelli", samples=64, replicates=4)
    # Only the last group has a row that never ends.
    life = np.where(ds["group"] == 63, np.inf, 1 / ds["y"].values)
    ds = asking(with_output(ds, "life", life, "lifetime"), outputs=["life"])
    table = uq.running_estimates(ds)
    assert set(table[table["estimate"] == "ST x4"]["output"]) == {"rank(life)"}


def test_variance_between_regimes_names_what_it_is_of():
    ds = linear(samples=256)
    attrs = {"role": "output", "kind": "category", "units": "1", "long_name": "regime"}
    attrs |= {"may_be_undefined": 0, "flag_values": [-1, 0, 1], "flag_meanings": "none low high"}
    ds = ds.assign(regime=("row", (ds["x4"].values > 0.5).astype(np.int8), attrs))
    y = ds["y"].values
    ds = with_output(ds, "life", np.exp(y), "lifetime")
    ds = with_output(ds, "late", np.where(y > 9, np.inf, y), "lifetime")
    outputs = summarised(asking(ds, outputs=["y", "life", "late"]))["outputs"]
    of = {name: entry["between_regimes"]["of"] for name, entry in outputs.items()}
    assert of == {"y": "y", "life": "log(life)", "late": "rank(late)"}
    shares = [outputs[name]["between_regimes"]["value"] for name in ("y", "life")]
    assert shares[0] == pytest.approx(shares[1])
    assert list(uq.regimes(asking(ds, outputs=["y", "life"]))["output"]) == ["y", "log(life)"]


def test_a_life_whose_logarithm_is_heavy_is_not_told_to_take_its_logarithm():
    ds = linear(samples=300)
    lives = np.exp(-np.minimum(stats.pareto(0.8).rvs(300, random_state=2), 300.0))
    ds = asking(with_output(ds, "life", lives, "lifetime"), outputs=["life"])
    reason = answer(ds).lead.ranking.reason
    assert "tail of log(life) is too heavy" in reason and reason.endswith("; ask for rank(life)")
