"""What somebody adds from outside, one entry of a table each, is found everywhere it should be."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from uq import open_result, sensitivity
from uq.designs.design import Design
from uq.designs.registry import DESIGNS
from uq.designs.sequences import monte_carlo
from uq.estimate import Estimate
from uq.methods.indices import Indices, Kind
from uq.methods.method import Method
from uq.methods.registry import METHODS
from uq.study.schema import json_schema

DOCS = Path(__file__).parents[1] / "docs"
sys.path.insert(0, str(DOCS))

import generated  # noqa: E402


def mirrored(seed, replicates, d, samples, start, stop):
    """Draw every second point opposite to the one before."""
    first, last = start - start % 2, stop + stop % 2
    points = monte_carlo(seed, replicates, d, samples, first, last)
    points[1::2] = 1 - points[::2]
    return points[start - first : stop - first]


def squared_correlation(sample):
    r = {name: np.corrcoef(x, sample.values)[0, 1] for name, x in sample.inputs.items()}
    return Indices({R2: {name: Estimate(one**2, 0.0, 1.0) for name, one in r.items()}})


R2 = Kind("R2", "squared correlation (R2)", "variance")
DESIGN = Design("pairs of opposite points", mirrored)
METHOD = Method(
    "how well a straight line fits",
    DESIGN.layout,
    squared_correlation,
    (R2,),
    source="Pearson (1895)",
    intervals="none that means anything",
)
LAW = 'distribution = "uniform", lower = 0.0, upper = 1.0'


def study(write_study, **more):
    asked = f"[analysis]\nsensitivity = {json.dumps(more.pop('sensitivity', ['correlation']))}"
    return write_study(
        "linear", **{"uncertain": ("x1", "x2", "x3", "x4"), "law": LAW, "more": asked} | more
    )


@pytest.fixture
def design(monkeypatch):
    monkeypatch.setitem(DESIGNS, "mirrored", DESIGN)


@pytest.fixture
def method(monkeypatch):
    monkeypatch.setitem(METHODS, "correlation", METHOD)


def offered(design):
    """Return the sensitivity methods that the schema offers an editor for a design."""
    for rule in json_schema()["allOf"]:
        if rule["if"]["properties"].get("design", {}).get("properties", {}) == {
            "method": {"const": design}
        }:
            asked = rule["then"]["properties"]["analysis"]["properties"]["sensitivity"]
    return asked["items"]["enum"]


def test_a_design_is_found_everywhere(uq, write_study, design):
    table = json_schema()["definitions"]["DesignTable"]["properties"]
    assert "mirrored" in table["method"]["enum"]
    assert offered("mirrored") == offered("monte-carlo")
    assert "# mirrored: pairs of opposite points\n" in uq("init", "linear").out
    assert '| `"mirrored"` | pairs of opposite points | yes | rbd-fast' in generated.designs()
    assert "`mirrored`" in generated.questions()

    path = study(write_study, method="mirrored", sensitivity=["rbd-fast"])
    assert "mirrored: pairs of opposite points" in " ".join(uq("check", path).out.split())
    ended = uq("run", path, "-o", "out.nc", "--workers", "0", "--chunk-rows", "7")
    assert ended.code == 0 and "mirrored, 64 rows" in ended.out
    x1 = open_result("out.nc")["x1"].values
    np.testing.assert_allclose(x1[1::2], 1 - x1[::2])
    assert uq("report", "out.nc", "-o", "out.html").code == 0
    assert "mirrored: pairs of opposite points" in Path("out.html").read_text()
    assert (
        "'mirrored' feeds 'rbd-fast' or"
        in uq("check", study(write_study, method="mirrored", sensitivity=["sobol"])).err
    )


def test_a_sensitivity_method_is_found_everywhere(uq, write_study, method):
    table = json_schema()["definitions"]["AnalysisTable"]["properties"]
    assert "correlation" in table["sensitivity"]["items"]["enum"]
    assert "correlation" in offered("halton") and "correlation" not in offered("saltelli")
    assert "correlation" in generated.designs()
    assert "| `correlation` | squared correlation (R2) | Pearson (1895) |" in generated.methods()
    assert (
        "| how well a straight line fits | `correlation` | a plain sample |"
        in generated.questions()
    )

    crossed = study(write_study, method="saltelli", name="crossed")
    refused = uq("check", crossed)
    assert refused.code == 2 and "method = 'monte-carlo' or" in refused.err
    misspelt = study(write_study, sensitivity=["corelation"], name="misspelt")
    assert "did you mean 'correlation'?" in uq("check", misspelt).err

    path = study(write_study)
    assert "correlation" in uq("check", path).out
    assert uq("run", path, "-o", "out.nc", "--workers", "0").code == 0
    values = sensitivity(open_result("out.nc"))["R2"].sel(output="y").values
    assert values == pytest.approx(np.arange(1, 5) ** 2 / 30, abs=0.2)
    found = json.loads(uq("sensitivity", "out.nc", "--json").out)
    assert found["method"] == "correlation"
    assert [one["value"] for one in found["outputs"]["y"]["R2"].values()] == list(values)
    shown = uq("sensitivity", "out.nc").out
    assert f"x4  {values[3]:.3f}  0.000 to 1.000" in shown
    assert uq("plot", "out.nc", "-o", "figures").code == 0
    assert "squared correlation (R2)" in Path("figures/correlation-y.svg").read_text()
    assert uq("report", "out.nc", "-o", "out.html").code == 0
    page = Path("out.html").read_text()
    assert "squared correlation (R2)" in page and f"{values[3]:.3f}" in page
