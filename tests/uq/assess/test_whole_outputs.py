"""One index for all elements of an output: what it adds up, of which rows, and how it is shown."""

import numpy as np
import pytest
from asked_indices import indices
from computed import asking, computed, kinds, study_of, with_status
from drawn import words

import uq
from benchmarks.coverage import whole
from uq import plots
from uq.errors import InputError
from uq.render.trace.trace import traced
from uq.result.result import Result


def curves(method="saltelli", samples=64, replicates=4, **analysis):
    design = {"method": method, "samples": samples, "replicates": replicates}
    tables = {
        "study": {"name": "curves", "model": "curves"},
        "design": design,
        "uncertain": whole.LAWS,
        "analysis": analysis or {"outputs": ["front", "worn"]},
    }
    return computed(study_of(tables, whole.NAME))


def with_elements(ds, like, *columns):
    """Return a result whose output `like` has other elements, each a column of rows."""
    attrs = ds[like].attrs
    return (
        ds.drop_vars([like, "time"])
        .assign({like: (("row", "place"), np.stack(columns, 1), attrs)})
        .assign_coords(place=list("abcdefgh")[: len(columns)])
    )


def numbers(entry, kind):
    return [estimate["value"] for estimate in entry[kind].values()]


def test_parts_of_the_variance_are_added_over_the_elements():
    ds = curves()
    outputs = indices(ds)["outputs"]
    a, *mixed, b = np.moveaxis(ds["front"].values.reshape(-1, 7, 8), 1, 0)
    elements = [outputs[f"front[time={time}]"] for time in whole.TIMES]
    variances = {
        "S1": [(b.var(axis=0) + ab.var(axis=0)) / 2 for ab in mixed],
        "ST": [np.r_[a, b].var(axis=0) for _ in mixed],
    }
    for kind, of_inputs in variances.items():
        indices_of_elements = np.array([numbers(element, kind) for element in elements])
        weights = np.array(of_inputs).T
        expected = (weights * indices_of_elements).sum(axis=0) / weights.sum(axis=0)
        assert numbers(outputs["front[:]"], kind) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("method", "samples"), [("saltelli", 64), ("shapley", 64), ("fast", 129), ("monte-carlo", 256)]
)
def test_an_output_of_equal_shape_in_all_elements_has_the_indices_of_one(method, samples):
    ds = curves(method, samples, 1 if method in ("monte-carlo", "shapley") else 2)
    worn = ds["worn"].values[:, 2]
    ds = with_elements(ds, "worn", worn, 5 - 3e3 * worn, np.full(len(worn), 7.0))
    ds = asking(ds, outputs=["worn"])
    outputs = indices(ds)["outputs"]
    assert "same value" in outputs["worn[place=c]"]["refused"]
    for kind, values in outputs["worn[place=a]"].items():
        if isinstance(values, dict) and kind != "dummy":
            for name, index in values.items():
                for end, value in index.items():
                    together = outputs["worn[:]"][kind][name][end]
                    assert (value is together is None) or together == pytest.approx(value, rel=1e-9)


@pytest.mark.parametrize(
    ("method", "samples"), [("saltelli", 64), ("shapley", 64), ("fast", 129), ("monte-carlo", 256)]
)
@pytest.mark.parametrize("power", [660, -660])
def test_shares_do_not_depend_on_the_unit(method, samples, power):
    ds = curves(method, samples, 1, outputs=["front"])
    of = "front[:]" if method in ("saltelli", "shapley") else "front[time=0.5]"
    other = ds.assign(front=ds["front"].copy(data=ds["front"].values * 2.0**power))
    assert indices(other, None, of) == indices(ds, None, of)


def test_an_input_that_counts_by_correlation_alone_is_named():
    names = [name for name in whole.LAWS if name != "r2"]
    correlation = [
        [1.0 if i == j else 0.5 * ({i, j} == {2, 3}) for j in range(4)] for i in range(4)
    ]
    tables = {
        "study": {"name": "curves", "model": "curves"},
        "design": {"method": "shapley", "samples": 256},
        "uncertain": {name: whole.LAWS[name] for name in names},
        "dependence": {"parameters": names, "rank_correlation": correlation},
        "analysis": {"outputs": ["worn"]},
    }
    entry = indices(computed(study_of(tables, whole.NAME)))["outputs"]["worn[:]"]
    assert entry["by_correlation"] == ["x3"]


def test_intervals_are_those_of_all_elements_together():
    outputs = indices(curves(samples=256, replicates=8))["outputs"]
    for name, kinds_of in whole.truths().items():
        for kind in ("S1", "ST"):
            for label, truth in kinds_of[kind].items():
                index = outputs[f"{name}[:]"][kind][label]
                assert index["low"] < index["value"] < index["high"]
                reach = index["high"] - index["low"]
                assert index["low"] - reach < truth < index["high"] + reach


def test_a_row_without_one_element_leaves_with_its_group():
    ds = curves()
    ds["front"][10, 3] = np.nan
    outputs = indices(with_status(ds, [10], 2))["outputs"]
    assert outputs["front[:]"]["groups_dropped"] == 1
    assert outputs["front[time=0.0]"]["groups_dropped"] == 0


def test_without_variance_there_is_no_index():
    ds = curves()
    ds["front"][:] = np.arange(8.0)
    assert "same value" in indices(ds)["outputs"]["front[:]"]["refused"]


def test_all_elements_have_one_form():
    ds = kinds("saltelli", analysis={"outputs": ["work", "life"]})
    outputs = indices(ds)["outputs"]
    assert {"work[:]", "rank(life[:])"} <= outputs.keys()
    assert "combines all 2 elements" in outputs["work[:]"]["notes"][0]
    ds = curves()
    heavy = ds["worn"].values[:, 0] ** 4
    ds = with_elements(ds, "worn", heavy, ds["worn"].values[:, 1])
    outputs = indices(asking(ds, outputs=["worn"]))["outputs"]
    assert "log(worn[:])" in outputs and "worn[place=b]" in outputs
    assert "ask for worn[:] for the values" in " ".join(outputs["log(worn[:])"]["notes"])
    assert "log(worn[:]) is more" in " ".join(
        indices(ds, output="worn[:]")["outputs"]["worn[:]"]["notes"]
    )


def test_it_has_a_name():
    ds = curves()
    assert list(indices(ds, output="front[:]")["outputs"]) == ["front[:]"]
    assert list(indices(ds, output="rank(front[:])")["outputs"]) == ["rank(front[:])"]
    assert list(indices(ds, output="front")["outputs"])[-1] == "front[:]"
    ds = kinds(samples=128)
    for asked, method, sentence in (
        ("angle[:]", "rbd-fast", r"no such element 'angle\[:\]'; did you mean 'angle'"),
        ("work[:]", "delta", "'delta' has no index of all elements together .* rbd-fast, sobol"),
        ("rate(work[:])", "rbd-fast", "no such output"),
        ("P(work[:] > 1)", "rbd-fast", "an event concerns a single element"),
    ):
        with pytest.raises(InputError, match=sentence):
            indices(ds, method, output=asked)


def test_it_is_in_arrays_convergence_and_traces():
    ds = curves(samples=32)
    index = indices(ds)["outputs"]["front[:]"]["ST"]["x1"]
    arrays = uq.sensitivity(ds).sel(output="front[:]", parameter="x1")
    assert [float(arrays[name]) for name in ("ST", "ST_low", "ST_high")] == list(index.values())
    running = uq.running_estimates(ds, "front")
    last = running[(running["output"] == "front[:]") & (running["estimate"] == "ST x1")].iloc[-1]
    assert last["value"] == index["value"]
    traced_number = traced(Result(ds), "sensitivity/outputs/front[:]/ST/x1")
    assert traced_number.equal and traced_number.states == {
        "in groups with a value in each row": 7 * 4 * 32
    }
    assert traced(Result(ds), "convergence/outputs/front[:]/estimates/ST x1/0/value").equal


def test_curves_of_indices_are_those_of_the_elements():
    ds = curves(samples=32, replicates=4)
    figure = plots.index_curves(ds, "front")
    (axes,) = figure.axes
    outputs = indices(ds)["outputs"]
    first = axes.lines[0]
    assert first.get_xdata() == pytest.approx(whole.TIMES)
    leading = max(
        outputs["front[:]"]["ST"], key=lambda name: outputs["front[:]"]["ST"][name]["value"]
    )
    leading_indices = [outputs[f"front[time={time}]"]["ST"][leading] for time in whole.TIMES]
    assert first.get_ydata() == pytest.approx([estimate["value"] for estimate in leading_indices])
    band = axes.collections[0].get_paths()[0].vertices
    at = band[np.isclose(band[:, 0], whole.TIMES[3]), 1]
    assert (at.min(), at.max()) == pytest.approx(
        (leading_indices[3]["low"], leading_indices[3]["high"])
    )
    together = outputs["front[:]"]["ST"][leading]["value"]
    assert "[s]" in axes.get_xlabel() and f"{together:.3f} all together" in words(figure)
    with pytest.raises(InputError, match="no dimension of 3 or more numbers"):
        plots.index_curves(kinds("saltelli"), "work")


@pytest.mark.slow
@pytest.mark.parametrize("method", ["saltelli", "shapley"])
def test_intervals_cover_the_indices_of_curves(method):
    lines = whole.whole(method, 1000)
    for line in lines:
        print(line.problem, line.what, line.coverage)
    assert lines and not any(line.unexplained for line in lines)


def test_an_element_that_no_row_has_is_named():
    ds = curves("shapley", samples=64, replicates=1, outputs=["worn"])
    worn = ds["worn"].values[:, 2]
    outputs = indices(with_elements(ds, "worn", worn, np.full(len(worn), np.nan)))["outputs"]
    assert (
        outputs["worn[:]"]["refused"]
        == "no row has a worn[place=b]; ask for the other elements by name"
    )
    assert "shapley" in outputs["worn[place=a]"]
