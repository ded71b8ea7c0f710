"""Emulators: what they predict, what they refuse, and that their errors are carried on."""

import json
import threading
from pathlib import Path

import numpy as np
import pytest
from computed import UNIFORM, computed, kinds, linear, study_of

import uq as api
from uq.contract import Status
from uq.errors import InputError
from uq.explore.rare_events import rare_event
from uq.files.whole_files import write_result
from uq.machines.emulator import EmulatedRows, emulator_at, inputs_of, model_of_emulator, parts_of
from uq.machines.serving import address_of, server_of
from uq.stats.regressions import PROCESS, Predictor, regress, scale_of
from uq.study.installed_models import find_model, model_at

PAIRED, SIGNS = "sample_models:PAIRED", {"distribution": "uniform", "lower": -np.pi, "upper": np.pi}


WAVES = {
    "study": {"name": "waves", "model": "ishigami"},
    "uncertain": dict.fromkeys(("x1", "x2", "x3"), SIGNS),
    "analysis": {"thresholds": {"y": 10.0}},
}


def ishigami(samples=150, seed=1):
    design = {"method": "monte-carlo", "samples": samples, "seed": seed}
    return computed(study_of(WAVES | {"design": design}))


@pytest.fixture(scope="module")
def waves(tmp_path_factory):
    """Return the file of an emulator of Ishigami's function from 150 rows."""
    path = tmp_path_factory.mktemp("emulators") / "waves.emulator"
    api.emulate(ishigami(), path)
    return path


def predicted(path, x, seed=0):
    """Return the columns, status and messages of rows of an emulator."""
    seeds = np.arange(seed, seed + len(x), dtype=np.uint64) * np.uint64(2**40)
    model = model_at(str(path))
    return model.batch(x, seeds, model.settings())


def test_new_rows_are_predicted_with_the_error_that_is_stated(waves):
    new = ishigami(2000, seed=2)
    x = np.column_stack([new[name] for name in ("x1", "x2", "x3")])
    y = predicted(waves, x)[0]["y"]
    stated = emulator_at(waves).elements["y"][0].regression.error_sd
    true = np.sqrt(np.mean((y - new["y"].values) ** 2))
    # An error is drawn and an error is made: their squares add up.
    assert 0.3 * stated < true < 2 * np.sqrt(2) * stated < 0.3 * float(new["y"].std())
    # Two draws of the same rows differ by two errors.
    drawn_twice = predicted(waves, x, seed=2000)[0]["y"] - y
    assert np.std(drawn_twice) == pytest.approx(np.sqrt(2) * stated, rel=0.3)


def test_rows_have_the_same_bits_one_by_one_and_in_another_process(waves, tmp_path):
    x = np.random.default_rng(0).uniform(-3, 3, (64, 3))
    together = predicted(waves, x)[0]["y"]
    assert np.array_equal(
        together, [predicted(waves, x[i : i + 1], i)[0]["y"][0] for i in range(64)]
    )
    study = tmp_path / "again.toml"
    text = ishigami().attrs["study"].replace("samples = 150", "samples = 300")
    study.write_text(text)
    results = [
        api.run(api.load_study(study, str(waves)), tmp_path / f"{n}.nc", workers=n, chunk_rows=c)
        for n, c in ((0, 300), (2, 7))
    ]
    assert np.array_equal(results[0]["y"], results[1]["y"])
    assert results[0].attrs["model"] == "ishigami-emulator"


def test_an_emulator_that_is_served_has_the_same_bits(waves):
    x = np.random.default_rng(0).uniform(-3, 3, (5, 3))
    server = server_of(model_at(str(waves)), port=0)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = address_of("127.0.0.1", server.server_address[1], "ishigami-emulator")
    assert np.array_equal(predicted(address, x)[0]["y"], predicted(waves, x)[0]["y"])
    server.shutdown()
    server.server_close()


def test_an_emulator_takes_events_of_several_limits(waves):
    of = study_of(WAVES | {"design": {"method": "monte-carlo", "samples": 64}}, str(waves))
    limits = [("y", 14.0, "above"), ("y", -8.0, "below")]
    ds = rare_event(of, any_of=limits, samples=300, replicates=4, workers=0)
    assert ds["low"] < 0.0089 < ds["high"] < 0.02  # of Ishigami's function: 0.0089


def test_an_output_that_jumps_is_refused():
    ds = ishigami()
    for height in (3.0, 10.0):
        jump = ds.assign(y=ds["y"] * 0.1 + ds["x1"] + height * (ds["x2"] > ds["x3"] ** 2))
        jump["y"].attrs = ds["y"].attrs
        with pytest.raises(InputError, match="y: no emulator: "):
            api.emulate(jump)


def test_a_jump_that_few_rows_cross_is_refused():
    ds = ishigami()
    jump = ds.assign(y=ds["x1"] + 2.0 * (ds["x2"] > 2.6))
    jump["y"].attrs = ds["y"].attrs
    with pytest.raises(InputError, match="the output jumps, or is too steep for these rows"):
        api.emulate(jump)


def test_labels_that_no_input_explains_are_refused():
    ds = kinds(samples=80)
    ds["regime"].values[:] = np.random.default_rng(0).permutation(ds["regime"].values)
    with pytest.raises(InputError, match="of rows would get the wrong label"):
        api.emulate(ds, outputs=["regime"])


def test_failed_rows_are_not_learnt_and_few_rows_are_refused():
    ds = linear(samples=64, settings={"fail_above": 0.9})
    failed = int((ds["status"] != Status.OK).sum())
    emulator = api.emulate(ds)
    assert 0 < failed == emulator.failed and len(emulator.x) == 64 - failed
    with pytest.raises(InputError, match="39 rows: an emulator needs 40 at least"):
        api.emulate(linear(samples=39))


def paired(samples=120):
    tables = {
        "study": {"name": "paired", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": samples},
        "uncertain": {"x1": UNIFORM, "x2": UNIFORM},
    }
    return computed(study_of(tables, PAIRED))


def test_noise_alone_is_refused_and_the_rest_is_kept():
    emulator = api.emulate(paired(300), outputs=["far", "same"])
    assert list(emulator.elements) == ["same"]
    assert "of the standard deviation of the output; a third is the most" in emulator.refused["far"]


def test_lives_regimes_and_undefined_values_are_classified():
    rows = kinds(samples=300)
    emulator = api.emulate(rows, outputs=["life", "angle", "regime"])
    assert not emulator.refused and all(fit.logarithmic for fit in emulator.elements["life"])
    new = kinds(samples=1000)
    x = np.column_stack([new["x1"], new["x2"]])[400:]
    batch = EmulatedRows(emulator, ("x1", "x2"))
    columns, status, _ = batch(x, np.arange(600, dtype=np.uint64) * np.uint64(2**40), None)
    assert (status == Status.OK).all()
    # Lives beyond the time at which rows were cut are censored.
    flags = columns["life_censored"].reshape(600, -1).T
    for life, cut in zip(columns["life"].reshape(600, -1).T, flags, strict=True):
        assert len(set(life[cut])) == 1
        assert not (life[~cut & np.isfinite(life)] > life[cut][0]).any()
    truth = new.isel(row=slice(400, None))
    assert np.mean(np.isposinf(columns["life"]) == np.isposinf(truth["life"].values)) > 0.95
    assert np.mean(columns["life_censored"] == truth["life_censored"].values) > 0.93
    assert np.mean(columns["regime"] == truth["regime"].values) > 0.95
    assert np.mean(np.isnan(columns["angle"]) == np.isnan(truth["angle"].values)) > 0.95
    ended = np.isfinite(columns["life"]) & np.isfinite(truth["life"].values)
    ended &= ~columns["life_censored"] & (truth["life_censored"].values == 0)
    assert columns["life"][ended] == pytest.approx(truth["life"].values[ended], rel=0.02)


def test_labels_are_drawn_as_often_as_the_classifier_errs():
    emulator = api.emulate(kinds(samples=80), outputs=["regime"])
    classifier = emulator.elements["regime"][0].classifier
    assert classifier.confusion == [[43, 1], [0, 36]]
    x = np.tile([[0.1, 0.5], [0.9, 0.5]], (2000, 1))
    seeds = np.arange(4000, dtype=np.uint64) * np.uint64(2**40)
    regime = EmulatedRows(emulator, ("x1", "x2"))(x, seeds, None)[0]["regime"]
    wrong = {regime[0::2].mean(), 1 - regime[1::2].mean()}
    assert min(wrong) == 0.0 and max(wrong) == pytest.approx(1 / 44, abs=0.01)


def test_rows_outside_those_learnt_fail_with_a_sentence(waves):
    x = np.array([[0.0, 0.0, 0.0], [0.0, 9.0, 0.0], [np.nan, 0.0, 0.0]])
    columns, status, messages = predicted(waves, x)
    assert status.tolist() == [Status.OK, Status.RAISED, Status.RAISED]
    assert messages[1] == "x2 = 9 is far outside the rows of the emulator"
    assert np.isfinite(columns["y"][0]) and np.isnan(columns["y"][1:]).all()


def test_other_constants_and_settings_are_refused(waves, tmp_path, uq):
    series = {
        "study": {"name": "series", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 60},
        "uncertain": {"x1": UNIFORM},
        "fixed": {"x2": 0.5},
    }
    path = tmp_path / "series.emulator"
    api.emulate(computed(study_of(series, "sample_models:SERIES")), path)
    for change, words in (
        ({"fixed": {"x2": 0.6}}, "x2 = 0.6: the rows of the emulator were computed with 0.5"),
        ({"uncertain": {"x1": UNIFORM, "x2": UNIFORM}, "fixed": {}}, "does not vary in the rows"),
    ):
        with pytest.raises(InputError, match=words):
            study_of(series | change, str(path))
    assert study_of(series, str(path)).model.name == "series-emulator"


def test_other_settings_of_an_installed_model_are_refused(tmp_path):
    tables = {
        "study": {"name": "linear", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 64},
        "uncertain": dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM),
    }
    path = tmp_path / "linear.emulator"
    api.emulate(computed(study_of(tables)), path)
    assert study_of(tables, str(path)).model.name == "linear-emulator"
    with pytest.raises(InputError, match="fail_above: the rows of the emulator were computed with"):
        study_of(tables | {"settings": {"fail_above": 0.9}}, str(path))


def test_inputs_that_were_equal_must_stay_equal():
    ds = linear(samples=64)
    ds["y"] = ds["y"] + 4 * (ds["x3"] - ds["x4"])
    ds["x4"] = ds["x3"].assign_attrs(ds["x4"].attrs)
    ds["y"].attrs = linear(samples=64)["y"].attrs
    emulator = api.emulate(ds)
    assert emulator.equal == {"x4": "x3"}
    x = np.full((2, 4), 0.5) + [[0, 0, 0, 0], [0, 0, 0, 0.1]]
    batch = EmulatedRows(emulator, ("x1", "x2", "x3", "x4"))
    columns, status, messages = batch(x, np.zeros(2, np.uint64), None)
    assert columns["y"][0] == pytest.approx(5.0, abs=0.01)
    assert status.tolist() == [Status.OK, Status.RAISED]
    assert messages == {1: "x4 differs from x3; in the rows of the emulator it does not"}


def test_as_a_twin_it_predicts_each_row_from_the_rows_of_other_parts(waves):
    emulator, ds = emulator_at(waves), ishigami()
    twin = model_of_emulator(emulator, "", find_model, cross_fitted=True)
    x = np.column_stack([ds[name] for name in ("x1", "x2", "x3")])
    errors = twin.batch(x, np.arange(150, dtype=np.uint64), None)[0]["y"] - ds["y"].values
    stated = emulator.elements["y"][0].regression.error_sd
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(stated, rel=1e-9)


@pytest.mark.slow
def test_the_twin_is_unbiased_and_covers_for_what_it_is_worth(tmp_path):
    """Of 40 designs of 200 rows; the mean of Ishigami's function is 3.5."""
    path, inside, widths = tmp_path / "w.emulator", [], []
    for seed in range(40):
        ds = ishigami(200, seed)
        api.emulate(ds, path)
        line = api.two_fidelities(ds, emulator=path).loc[("y", "mean")]
        inside.append(line["low"] <= 3.5 <= line["high"])
        widths.append((line["high"] - line["low"]) / (line["plain_high"] - line["plain_low"]))
    assert sum(inside) >= 34  # of 40 at 95 %: fewer than 34 once in 300
    assert np.median(widths) < 0.2


def test_parts_depend_on_the_row_alone():
    x = np.random.default_rng(3).random((200, 2))
    assert np.array_equal(parts_of(x)[::-1], parts_of(np.ascontiguousarray(x[::-1])))
    assert np.bincount(parts_of(x)).min() > 20


def test_the_command_shows_errors_and_json(uq, tmp_path, write_study):
    path = write_study("linear", uncertain=("x1", "x2", "x3", "x4"), law='distribution="uniform",'
                       "lower=0.0, upper=1.0", samples=60)  # fmt: skip
    uq("run", path, "-o", "out.nc", "--quiet")
    ended = uq("emulate", "out.nc", "-o", "out.emulator")
    assert ended.code == 0 and "polynomial-chaos" in ended.out, ended.err
    document = json.loads(uq("emulate", "out.nc", "-o", "out.emulator", "--json").out)
    output = document["outputs"]["y"]
    assert output["kind"] == "polynomial-chaos" and output["refused"] is False
    assert output["q2"] > 0.999 and output["error_sd"] < 0.05
    ended = uq("run", path, "--model", "out.emulator", "-o", "many.nc", "--samples", 500)
    assert ended.code == 0 and "500 predictions" in ended.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("none.nc", "-o", "a.emulator"), "none.nc: no such file"),
        (("out.nc", "-o", "a.nc"), "a.nc: the file of an emulator ends in .emulator"),
        (("out.nc", "-o", "a.emulator", "--output", "z"), "no such output 'z'"),
        (
            ("out.nc", "-o", "study.emulator"),
            "study.emulator: is there and not an emulator; choose another place with -o",
        ),
    ],
)
def test_mistakes_are_one_line(uq, write_study, arguments, words):
    linear(samples=64).to_netcdf("out.nc") if arguments[0] == "out.nc" else None
    Path("study.emulator").write_text("[study]")
    ended = uq("emulate", *arguments)
    assert ended.code == 2 and words in ended.err and ended.err.count("\n") == 1
    assert Path("study.emulator").read_text() == "[study]"


def test_an_emulator_is_replaced_also_one_of_another_version(tmp_path):
    path = tmp_path / "linear.emulator"
    api.emulate(linear(samples=64), path)
    first = path.read_text()
    path.write_text(first.replace('"vibrolife_emulator": 2', '"vibrolife_emulator": 1'))
    api.emulate(linear(samples=64), path)
    assert path.read_text() == first


def test_a_file_that_is_none_is_one_line(tmp_path):
    for text in ("", "{}", '{"vibrolife_emulator": 2}', "[1]"):
        path = tmp_path / "bad.emulator"
        path.write_text(text)
        with pytest.raises(InputError, match="bad.emulator: is not an emulator"):
            model_at(str(path))
    result = tmp_path / "out.nc"
    linear(samples=64).to_netcdf(result)
    words = "out.nc: is not an emulator; 'uq emulate RESULT -o NEW.emulator' makes one"
    with pytest.raises(InputError, match=words):
        api.two_fidelities(result, emulator=result)


def test_an_emulator_of_another_model_is_no_twin(waves):
    words = "waves.emulator: is an emulator of model 'ishigami', and the result is of 'linear'$"
    with pytest.raises(InputError, match=words):
        api.two_fidelities(linear(samples=64), emulator=waves)


def test_a_file_that_was_changed_or_is_of_another_version_is_one_line(waves, tmp_path):
    path, text = tmp_path / "waves.emulator", waves.read_text()
    learnt = json.loads(text)
    digits = repr(learnt["x"][3][0])
    assert text.count(digits) == 1
    changed = f"{path}: was changed since 'uq emulate' wrote it; make it again"
    for old, new, words in (
        (digits, digits[:-1] + str((int(digits[-1]) + 1) % 10), changed),
        ('"failed": 0', '"failed": 0.0', changed),
        ('"failed": 0', '"failed": 0, "more": 0', changed),
        ('{"vibrolife_emulator": 2', '{"vibrolife_emulator": 1', "of another version"),
    ):
        path.write_text(text.replace(old, new))
        with pytest.raises(InputError, match=words) as refused:
            model_at(str(path))
        assert "\n" not in str(refused.value)
    path.write_text(json.dumps(json.loads(text), indent=1))  # the same content
    assert emulator_at(path) == emulator_at(waves)


PAD = """
import uq
@uq.machine(returns={"y": "1", "life": uq.Returned("h", life=True)})
def pad(a=0.5, b=0.5, n=1.0):
    return {"y": a + 2 * b + a * b * n, "life": float("inf") if a > 0.7 else 10 + a * b}
"""


def pad_study(*varying, samples=100):
    lines = ['[study]\nname = "pad"\nmodel = "pad"\n[design]\nmethod = "monte-carlo"']
    lines += [f"samples = {samples}\nseed = 5"]
    for name in varying:
        ends = (1.0, 3.0) if name == "n" else (0.0, 1.0)
        lines += [
            f'[uncertain.{name}]\ndistribution = "uniform"\nlower = {ends[0]}\nupper = {ends[1]}'
        ]
    return "\n".join(lines)


@pytest.fixture
def pads(uq, tmp_path):
    """Run studies with and without an input, and learn the first one."""
    file = tmp_path / f"{tmp_path.name}.py"  # modules of other tests have other names
    file.write_text(PAD)
    for name, varying in (("three", ("a", "b", "n")), ("two", ("a", "b"))):
        (tmp_path / f"{name}.toml").write_text(pad_study(*varying))
        ended = uq("run", f"{name}.toml", "--model", file, "-o", f"{name}.nc", "--quiet")
        assert ended.code == 0, ended.err
    return uq("emulate", "three.nc", "-o", "pad.emulator")


def test_a_polynomial_is_learnt_exactly_and_lives_that_never_end_are_shown(pads):
    assert pads.code == 0 and "wrong label" in pads.out, pads.err
    emulator = emulator_at(Path("pad.emulator"))
    assert not emulator.elements["y"][0].logarithmic
    assert emulator.elements["y"][0].regression.q2 > 1 - 1e-9


def test_nominal_values_of_an_emulator_are_those_of_the_function(pads, uq):
    line = api.two_fidelities("two.nc", emulator="pad.emulator").loc[("y", "mean")]
    assert line["value"] == pytest.approx(1.75, abs=0.02)  # n = 1, not the middle of 1 to 3
    ended = uq("run", "two.toml", "--model", "pad.emulator", "-o", "more.nc", "--quiet")
    assert ended.code == 0, ended.err
    assert float(api.open_result("more.nc")["y"].mean()) == pytest.approx(1.75, abs=0.1)
    ended = uq("simulate", "pad.emulator", "--json")
    assert ended.code == 0 and json.loads(ended.out)["outputs"]["y"] == pytest.approx(1.75, abs=0.1)


def test_nominal_values_that_an_older_result_lacks_must_be_stated(pads, uq):
    ds = api.open_result("three.nc")
    for variable in ds.variables.values():
        variable.attrs.pop("nominal", None)
    write_result(ds, Path("older.nc"))
    assert uq("emulate", "older.nc", "-o", "older.emulator").code == 0
    ended = uq("run", "two.toml", "--model", "older.emulator", "-o", "more.nc")
    assert ended.code == 2 and "n: give its law, or its value in [fixed]" in ended.err


FAR = """
import uq
@uq.machine(returns={"y": "1"})
def far(a=0.5, b=0.0):
    return {"y": 1000 + a + b * b}
"""
NORMAL = '[uncertain.{}]\ndistribution = "normal"\nmean = {}\nsd = {}\n'


def test_a_row_is_predicted_in_a_twin_wherever_it_is(tmp_path):
    """The mean of 1000 + a + b^2: samples of 100 rows, of which none is outside its own range."""
    (tmp_path / "far_away.py").write_text(FAR)
    laws = "\n" + NORMAL.format("a", 0.5, 0.2) + NORMAL.format("b", 0.0, 0.5)
    (tmp_path / "far.toml").write_text(pad_study().replace("pad", "far") + laws)
    study = api.load_study(tmp_path / "far.toml", model=str(tmp_path / "far_away.py"))
    held = []
    for seed in range(900, 920):
        ds = api.run(study.with_changes({"design.seed": seed}), tmp_path / f"{seed}.nc", workers=0)
        api.emulate(ds, tmp_path / "far.emulator")
        lines = api.two_fidelities(ds, emulator=tmp_path / "far.emulator").loc["y"]
        line = lines.loc["mean"]
        held.append(line["low"] <= 1000.75 <= line["high"])
        assert line["high"] - line["low"] < 0.3 * (line["plain_high"] - line["plain_low"])
    assert sum(held) >= 17


def test_an_error_is_not_magnified_where_rows_are_close(tmp_path):
    """A process predicts an error of 1e-9 of a row beside another, and it is as large as others."""
    z = np.random.default_rng(3).standard_normal((60, 1))
    inputs = inputs_of([scale_of("x", z[:, 0])], z)
    regression = regress(inputs, np.abs(z[:, 0]), np.arange(60), (PROCESS,))
    deviations, errors = regression.deviations[1:], regression.errors[1:]
    regression = regression._replace(deviations=[1e-9, *deviations], errors=[0.01, *errors])
    predictor = Predictor(regression, inputs)
    _, sd = predictor(np.linspace(-2.0, 2.0, 50)[:, None])
    largest = np.abs(np.outer(sd, predictor.standard_errors)).max()
    assert largest < 20 * np.abs(regression.errors).max()


def test_proposed_laws_are_those_of_the_rows_learnt(pads, uq):
    proposed = uq("init", "pad.emulator")
    assert "nan" not in proposed.out and "the range of the rows learnt" in proposed.out
