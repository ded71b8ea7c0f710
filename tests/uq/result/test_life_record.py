"""Lives from the field: what a file may have, its refusals, and what every verb says of them."""

import json

import numpy as np
import pytest
import xarray as xr
from scipy import stats

import uq
from uq.assess.comparison import comparison
from uq.files.whole_files import write_result
from uq.result.result import Result
from uq.result.result_file import open_result


def csv(folder, text, name="rods.csv"):
    path = folder / name
    path.write_text(text)
    return path


CENSORED = "hours,running,gap,maker\n100,0,1.5,a\n200,0,2.5,b\n150,1,1.0,a\n300,0,2.0,b\n"


def test_lives_are_in_seconds_and_columns_of_numbers_are_inputs(folder):
    ds = uq.import_lives(csv(folder, CENSORED), "hours", unit="h", censored="running")
    assert ds["hours"].values.tolist() == [360_000, 720_000, 540_000, 1_080_000]
    assert ds["hours"].attrs["units"] == "s"
    assert ds["hours_censored"].values.tolist() == [0, 0, 1, 0]
    assert ds["gap"].attrs["role"] == "input" and "maker" not in ds
    assert Result(ds).has_independent_rows


def test_a_written_record_is_read_as_any_result(folder):
    ds = uq.import_lives(csv(folder, CENSORED), "hours", unit="h", censored="running")
    write_result(ds, folder / "rods.nc")
    xr.testing.assert_identical(open_result("rods.nc").drop_attrs(), ds.drop_attrs())


def test_the_unit_may_be_in_the_heading(folder):
    ds = uq.import_lives(csv(folder, "life [days]\n2\n3\n"), "life")
    assert ds["life"].values.tolist() == [172_800, 259_200]


def test_lives_between_inspections(folder):
    text = "low,high\n0,10\n,20\n10,\n15,inf\n12,12\n"
    ds = uq.import_lives(csv(folder, text), "life", unit="s", low="low", high="high")
    assert ds["life"].values.tolist() == [0, 0, 10, 15, 12]
    assert ds["life_high"].values.tolist() == [10, 20, np.inf, np.inf, 12]
    assert ds["life_censored"].values.tolist() == [1, 1, 1, 1, 0]


def test_causes_are_a_category_beside_the_life(folder):
    text = "life,running,why\n1,0,wear\n2,1,\n3,0,crack tip\n"
    ds = uq.import_lives(csv(folder, text), "life", unit="s", censored="running", cause="why")
    assert uq.labels(ds["life_cause"]).values.tolist() == ["wear", "none", "crack-tip"]
    assert Result(ds).outputs["life"].causes == ("crack-tip", "wear")


INTERVAL = {"low": "low", "high": "high"}
CAUSE = {"censored": "c", "cause": "why"}


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        ("low,high\n5,3\n", INTERVAL, "line 2: column 'low' must not be above 'high': 5 > 3"),
        (
            "life,entered\n4,1\n5,6\n",
            {"entered": "entered"},
            "line 3: column 'entered' must be before the end, 5: 6",
        ),
        ("life,c,why\n4,1,wear\n", CAUSE, "line 2: column 'why' names a cause without an end"),
        ("life,c,why\n4,0,\n", CAUSE, "line 2: column 'why' is empty, but the life has ended"),
        (
            "life [h],entered [d]\n4,1\n",
            {"entered": "entered"},
            "two units of time: column 'life' is in 'h', column 'entered' in 'd'",
        ),
        (
            'life,x\n"4,5",1\n',
            {},
            "line 2: column 'life' must be a time, as a finite number: '4,5'; write it with a"
            " decimal point",
        ),
        ("life\n4\n-5\n", {}, "line 3: column 'life' must not be negative: -5"),
        ("life\n4 h\n", {}, "'4 h'; state the unit once, with --unit"),
        ("life\n4\ninf\n", {}, "line 3: column 'life' must be a time"),
        ("life;c\n4;1\n", {}, "cells separated by semicolons"),
        ("lif\n4\n", {}, "no column 'life'; did you mean 'lif'?"),
        ("life,c\n4,maybe\n", {"censored": "c"}, "must be 1 (censored) or 0 (ended): 'maybe'"),
        ("life\n4\n", {"unit": "milliseconds"}, "write it as 'ms'"),
        ("life\n", {}, "has 0 rows"),
        ("life\n4\n", {"low": "life"}, "--low and --high belong together"),
    ],
)
def test_a_mistake_is_one_line_that_names_its_place(folder, text, options, words):
    with pytest.raises(uq.InputError) as error:
        uq.import_lives(csv(folder, text), "life", **options)
    (line,) = error.value.lines
    assert words in line


def test_a_fault_is_refused_by_the_command_too(uq, folder):
    csv(folder, "life\n-1\n")
    ended = uq("import", "rods.csv", "-o", "rods.nc", "--life", "life")
    assert (ended.code, ended.err) == (
        2,
        "rods.csv: line 2: column 'life' must not be negative: -1\n",
    )
    assert not (folder / "rods.nc").exists()


def drawn(folder, rows=150):
    rng = np.random.default_rng(4)
    wear, crack = rng.weibull(1.5, rows) * 2000, rng.exponential(2500, rows)
    end = rng.uniform(200, 3000, rows)
    life = np.minimum(np.minimum(wear, crack), end)
    why = np.where(life == end, "", np.where(wear < crack, "wear", "crack"))
    lines = (
        f"{t!r},{int(not cause)},{cause},{x!r}"
        for t, cause, x in zip(
            life.tolist(), why.tolist(), rng.normal(size=rows).tolist(), strict=True
        )
    )
    return csv(folder, "life [h],running,why,x\n" + "\n".join(lines))


def test_verbs_read_it_and_those_that_need_a_model_say_why_not(uq, folder):
    drawn(folder)
    options = ["--life", "life", "--censored", "running", "--cause", "why", "--threshold", "30 d"]
    assert uq("import", "rods.csv", "-o", "rods.nc", *options).code == 0
    life = json.loads(uq("summary", "rods.nc", "--json").out)["outputs"]["life"]
    shares = {cause: life["causes"][cause]["2592000.0"] for cause in ("wear", "crack")}
    for share in shares.values():
        assert share["low"] < share["value"] < share["high"]
    together = life["thresholds"]["2592000.0"]["kaplan_meier"]["below"]["value"]
    assert sum(share["value"] for share in shares.values()) == pytest.approx(together)
    assert life["causes"]["wear"]["B10"]["low"] < life["causes"]["wear"]["B10"]["value"]
    assert uq("plot", "rods.nc", "--only", "incidence", "--only", "paper").code == 0
    assert uq("export", "rods.nc", "--csv", "out.csv").code == 0
    assert uq("verify", "rods.nc").code in (0, 2)
    extended = uq("extend", "rods.nc", "--samples", "300")
    assert extended.code == 2 and "no model computes such rows" in extended.err
    updated = uq("update", "rods.nc", "rods.csv", "-o", "new.nc")
    assert updated.code == 2 and "lives from the field" in updated.err


@pytest.mark.slow
def test_fits_stand_beside_what_the_rows_say(uq, folder):
    drawn(folder)
    uq("import", "rods.csv", "-o", "rods.nc", "--life", "life", "--censored", "running")
    fits = json.loads(uq("summary", "rods.nc", "--fits", "--json").out)["outputs"]["life"]["fits"]
    assert set(fits) == {
        "weibull", "lognormal", "gamma", "exponential", "weibull-3", "weibull-mixture"
    }  # fmt: skip
    b10 = fits["weibull"]["B10"]
    assert b10["low"] < b10["value"] < b10["high"]
    assert fits["weibull"]["aic"] < fits["lognormal"]["aic"]


STUDY = (
    '[study]\nname = "wear"\nmodel = "exponential-wear"\n'
    '[design]\nmethod = "monte-carlo"\nsamples = 200\nseed = 1\n'
    '[uncertain.rate]\ndistribution = "lognormal"\nmedian = 4e-11\nsigma = 0.5\n'
)


def test_lives_from_the_field_beside_a_simulated_study(uq, folder):
    drawn(folder)
    (folder / "wear.toml").write_text(STUDY)
    uq("run", "wear.toml", "-o", "wear.nc", "--quiet")
    uq("import", "rods.csv", "-o", "rods.nc", "--life", "life", "--censored", "running")
    ended = uq("compare", "rods.nc", "wear.nc", "--json", "--plot", "both.png")
    compared = json.loads(ended.out[ended.out.index("{") :])
    b10 = compared["outputs"]["life"]["b_lives"]["B10"]
    apart = b10["difference"]
    assert apart["value"] == pytest.approx(b10["b"]["value"] - b10["a"]["value"])
    assert apart["low"] < apart["value"] < apart["high"]
    curves = compared["curves"]["life"]
    assert len(curves["time"]) == len(curves["difference"]) > 5
    at = len(curves["time"]) // 2
    assert curves["difference"][at]["value"] == pytest.approx(
        curves["b"][at]["value"] - curves["a"][at]["value"]
    )
    assert (folder / "both.png").stat().st_size > 1000


def test_another_name_takes_the_place_of_the_simulated_life(folder):
    ds = uq.import_lives(csv(folder, CENSORED), "hours", unit="h", censored="running")
    with pytest.raises(uq.InputError, match="only where one result has lives from the field"):
        comparison(*[Result(other_rows(folder))] * 2, "life")
    compared = comparison(Result(ds), Result(other_rows(folder)))
    assert list(compared.outputs) == ["life"]


def other_rows(folder):
    study = folder / "wear.toml"
    study.write_text(STUDY)
    return uq.run(study, workers=0)


def test_nothing_is_said_of_all_lives_if_nobody_was_observed_from_the_start(folder):
    text = "life,entered\n" + "".join(f"{20 + i},{10 + i % 5}\n" for i in range(30))
    ds = uq.import_lives(csv(folder, text), "life", unit="s", entered="entered", thresholds=[30])
    table = uq.summary(ds)
    assert table.loc["life", [name for name in table if name.startswith("q")]].isna().all()
    sample = uq.survival(ds, "life")
    assert np.isnan(sample["survival"]).all()


def test_late_entry_moves_the_estimate_to_the_lives_that_were_missed(folder):
    rng = np.random.default_rng(5)
    life, entered = rng.exponential(100, 900), np.maximum(rng.uniform(-40, 150, 900), 0)
    kept = life > entered
    rows = zip(life[kept].tolist(), entered[kept].tolist(), strict=True)
    text = "life,entered\n" + "".join(f"{t},{e}\n" for t, e in rows)
    path = csv(folder, text)
    late = uq.survival(uq.import_lives(path, "life", unit="s", entered="entered"), "life")
    naive = uq.survival(uq.import_lives(path, "life", unit="s"), "life")
    truth = np.exp(-0.5)
    at = {"time": 50.0, "method": "ffill"}
    assert abs(float(late["survival"].sel(**at)) - truth) < 0.08
    assert float(naive["survival"].sel(**at)) > truth + 0.1
    assert float(late["low"].sel(**at)) < truth < float(late["high"].sel(**at))


def test_zero_lives_are_lives(folder):
    text = "life\n" + "0\n" * 3 + "".join(f"{i}\n" for i in range(1, 28))
    ds = uq.import_lives(csv(folder, text), "life", unit="s", thresholds=[0.5])
    assert float(uq.summary(ds).loc["life", "q0.5"]) == pytest.approx(13, abs=1.5)
    share = 1 - float(uq.survival(ds, "life")["survival"].sel(time=0.0))
    assert share == pytest.approx(0.1)


EXCLUDED = "which this law excludes"


def test_many_zero_lives_have_their_share_and_ranks(folder):
    rng = np.random.default_rng(5)
    x = rng.normal(size=200)
    life = np.where(x > 0.6, 0.0, rng.weibull(2, 200) * np.exp(-0.3 * x))
    lines = "".join(f"{a!r},{b!r}\n" for a, b in zip(life.tolist(), x.tolist(), strict=True))
    ds = uq.import_lives(csv(folder, "life [h],x\n" + lines), "life")
    zeros = int((life == 0).sum())
    table = uq.summary(ds).loc["life"]
    assert table["ended_at_once"] == zeros / 200
    assert table["ended_at_once_low"] < stats.norm.sf(0.6) < table["ended_at_once_high"]
    refused = uq.life_fits(ds, "life")["refused"].loc["life"]
    assert (refused.drop("exponential") == f"{zeros} rows have no positive life, {EXCLUDED}").all()
    assert refused["exponential"] == ""
    indices = uq.sensitivity(ds, "first-order")["S1"]
    assert indices["output"].values.tolist()[0] == "rank(life)"
    assert float(indices.sel(output="rank(life)", parameter="x")) > 0.5


def test_a_life_that_ended_before_a_first_inspection_is_no_zero_life(folder):
    lines = "0,5\n" * 10 + "5,10\n" * 20
    ds = uq.import_lives(
        csv(folder, "low,high\n" + lines), "life", unit="h", low="low", high="high"
    )
    assert "ended_at_once" not in uq.summary(ds)
    fits = uq.life_fits(ds, "life", ["exponential", "weibull"])
    assert (fits["refused"] == "").all()
