"""A machine of a package from outside appears everywhere it should, by one entry point."""

import importlib
import json
import sys
from pathlib import Path
from textwrap import dedent

import generated
import numpy as np
import pytest

from uq import open_result, summary
from uq.render.html.page import page
from uq.result.result import Result
from uq.study.schema import json_schema

HOUSE = Path(__file__).parents[1]

PENDULUM = """
    from dataclasses import dataclass
    from typing import Annotated, NamedTuple

    import numpy as np

    from models.numerics.jit import kernel
    from uq.contract import Model, Output, Parameter, Setting, Status, Trajectory


    class Params(NamedTuple):
        length: Annotated[
            float, Parameter("l", "m", "pivot to bob", (0.01, 100.0), "measured")
        ] = 1.0
        gravity: Annotated[
            float, Parameter("g", "m s-2", "acceleration of gravity", (1.0, 30.0), "given")
        ] = 9.81


    @dataclass(frozen=True)
    class Settings:
        points: Annotated[int, Setting("points of a trajectory", bounds=(2, 1000))] = 50


    @kernel
    def _periods(length, gravity, out):
        for i in range(len(out)):
            out[i] = 2 * np.pi * np.sqrt(length[i] / gravity[i])


    def batch(x, seed, settings):
        period = np.empty(len(x))
        _periods(x[:, 0].copy(), x[:, 1].copy(), period)
        return {"period": period}, np.full(len(x), Status.OK, np.int8)


    def simulate(params, settings, seed=0):
        time = np.linspace(0.0, 2.0, settings.points)
        angle = np.cos(np.sqrt(params.gravity / params.length) * time)
        return Trajectory(time, {"angle": ("rad", "angle from the vertical", angle)})


    MODEL = Model(
        name="pendulum",
        title="small swings of a bob on a string",
        version="1",
        parameters=Params,
        settings=Settings,
        outputs={"period": Output("s", "time of one swing to and fro")},
        batch=batch,
        simulate=simulate,
        references=("C. Huygens, Horologium oscillatorium (1673)",),
    )
"""


@pytest.fixture
def toy_machine(tmp_path, monkeypatch):
    """Install a package from outside, whose metadata have one entry point."""
    site = tmp_path / "site"
    metadata = site / "pendulums-1.0.dist-info"
    metadata.mkdir(parents=True)
    (site / "pendulums.py").write_text(dedent(PENDULUM))
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: pendulums\nVersion: 1.0\n")
    entry = "[vibrolife.models]\npendulum = pendulums:MODEL\n"
    (metadata / "entry_points.txt").write_text(entry)
    monkeypatch.syspath_prepend(site)
    importlib.invalidate_caches()
    yield
    sys.modules.pop("pendulums", None)


def test_a_machine_is_listed_simulated_run_and_documented(
    toy_machine, no_other_figures, uq, write_study
):
    assert "small swings of a bob on a string" in uq("models").out
    assert "pivot to bob" in uq("models", "pendulum").out
    assert "Huygens" in uq("models", "pendulum").out
    simulated = json.loads(uq("simulate", "pendulum", "--set", "length=2.0", "--json").out)
    assert simulated["outputs"]["period"] == pytest.approx(2.837, abs=1e-3)
    assert uq("simulate", "pendulum", "--plot", "swing.png").code == 0
    Path("mine.toml").write_text(uq("init", "pendulum").out)
    assert uq("check", "mine.toml").code == 0
    models = json_schema()["definitions"]["StudyTable"]["properties"]["model"]["enum"]
    assert "pendulum" in models

    path = write_study("pendulum", uncertain=("length",))
    ended = uq("run", path, "-o", "out.nc", "--workers", "0")
    assert ended.code == 0 and "small   64 runs, 0 invalid" in ended.out
    ds = open_result("out.nc")
    np.testing.assert_allclose(ds["period"], 2 * np.pi * np.sqrt(ds["length"] / 9.81))
    assert summary(ds).index.tolist() == ["period"]
    text = page(Result(ds), "out.nc")
    assert "time of one swing to and fro" in text and "Huygens" in text
    for table in (generated.parameters("pendulum"), generated.nomenclature()):
        assert "pivot to bob" in table
    for table in (generated.outputs("pendulum"), generated.all_outputs()):
        assert "time of one swing to and fro" in table
