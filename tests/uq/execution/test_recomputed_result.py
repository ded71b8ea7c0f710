"""A result computed again from what its rows keep is the result of a run, to the bit."""

import re

import numpy as np
import pytest
import xarray as xr

import uq as api
from uq.errors import InputError
from uq.learning.integrated_input import scale_of
from uq.learning.observables import observables_of
from uq.result.result import Result

RODS = """
[study]
name = "rods"
model = "beam"

[design]
method = "monte-carlo"
samples = 3
seed = 1

[uncertain.initial_gap]
distribution = "normal"
mean = 2.5e-4
sd = 1e-5

[uncertain.wear_coefficient]
distribution = "lognormal"
median = 1e-14
sigma = 0.5

[fixed]
force_amplitude = 0.0
random_force_level = 0.05
mass_damping = 40.0
forcing_frequency = 200.0

[settings]
depths = [2e-5]
accuracy = 0.05
map_growth = 5e-5

[analysis]
outputs = ["first_time_to_depth"]
"""


@pytest.fixture(scope="module")
def rods(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rods")
    (folder / "rods.toml").write_text(RODS)
    api.run(folder / "rods.toml", folder / "rods.nc", workers=0)
    return folder / "rods.nc"


def test_changed_settings_and_inputs_give_what_a_run_would(rods):
    changes = {"study.name": "flat", "settings.scar": "flat-bar", "fixed.creep_down": 1e-5}
    again = api.recompute(rods, changes)
    study = api.load_study(rods.with_suffix(".toml")).with_changes(changes)
    run = api.run(study, rods.with_name("flat.nc"), workers=0)
    for name, variable in run.variables.items():
        np.testing.assert_array_equal(again[name].values, variable.values, err_msg=str(name))
    assert again.attrs["study_identity"] == run.attrs["study_identity"]
    lives = api.summary(again), api.summary(run)
    assert lives[0].equals(lives[1])


def test_instants_after_the_last_depth_need_no_map(rods):
    lives = api.open_result(rods)["time_to_depth"].values
    assert np.isfinite(lives).all()
    instants = [float(lives.min()) / 2, 1.1 * float(lives.max())]
    changes = {"study.name": "later", "settings.instants": instants}
    again = api.recompute(rods, changes)
    study = api.load_study(rods.with_suffix(".toml")).with_changes(changes)
    run = api.run(study, rods.with_name("later.nc"), workers=0)
    assert (again["status"] == 0).all() and (again["worn_depth"][:, :, 1] == 2e-5).all()
    for name, variable in run.variables.items():
        np.testing.assert_array_equal(again[name].values, variable.values, err_msg=str(name))


def test_a_what_if_on_settings_prints_both_and_keeps_the_new_result(rods, uq, monkeypatch):
    monkeypatch.chdir(rods.parent)
    ended = uq("what-if", "rods.nc", "--set", "settings.scar=flat-bar", "-o", "flat.nc", "--full")
    assert ended.code == 0, ended.err
    assert "computed again" in ended.out and "first_time_to_depth" in ended.out
    for asked in (("settings.scar=flat-bar", "rods.nc"), ("uncertain.initial_gap.sd=2e-5", "a.nc")):
        refused = uq("what-if", "rods.nc", "--set", asked[0], "-o", asked[1])
        assert refused.code == 2 and "-o" in refused.err and refused.err.count("\n") == 1
    compared = uq("compare", "rods.nc", "flat.nc")
    assert compared.code == 0 and "B  flat.nc  flat (3 rows)" in compared.out


def test_depths_that_the_result_has_not_are_named(rods, uq):
    ended = uq("what-if", rods, "--set", "settings.depths=[1e-5, 2e-5]")
    assert ended.code == 0, ended.err
    words = " ".join(ended.out.split())
    assert re.search(
        r"first_time_to_depth\[depth=1e-05\][^:]*: not in the result as studied", words
    )
    assert "time_to_depth[depth=2e-05] [" in ended.out


def test_rows_rerun_with_other_settings_are_refused_in_one_line(rods):
    rerun = xr.DataArray([0, 1, 0], dims="row", attrs={"changed_1": "{accuracy = 0.01}"})
    with pytest.raises(InputError, match="rerun with other settings") as caught:
        api.recompute(api.open_result(rods).assign(rerun=rerun), {"settings.scar": "flat-bar"})
    assert str(caught.value).count("\n") == 0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"fixed.contact_stiffness": 2e4}, "contact_stiffness moves the beam"),
        ({"settings.elements": 12}, "elements moves the beam"),
        (
            {
                "fixed.preload_deflection": 4e-5,
                "fixed.relaxed_share": 0.2,
                "fixed.creep_down": 6e-5,
            },
            "preload_deflection moves the gaps",
        ),
        ({"settings.scar": "flat"}, "scar"),
        ({"fixed.creep": 1e-5}, "creep"),
    ],
)
def test_changes_beyond_what_is_kept_are_refused_in_one_line(rods, changes, words):
    with pytest.raises(InputError) as caught:
        api.recompute(rods, changes)
    assert len(caught.value.lines) == 1 and words in caught.value.lines[0]


def test_a_model_that_keeps_nothing_says_so(tmp_path):
    study = api.load_study("studies/exponential-wear.toml").with_samples(16)
    ds = api.run(study, tmp_path / "wear.nc", workers=0)
    with pytest.raises(InputError, match="keep nothing"):
        api.recompute(ds, {"settings.a": 1})


def test_with_creep_the_wear_coefficient_is_not_integrated_and_the_reason_is_given(rods):
    plain = Result.open(rods)
    creeping = Result(api.recompute(rods, {"fixed.creep_down": 1e-5}))
    name = "first_time_to_depth[depth=2e-05]"
    scale, _ = scale_of(plain, [observables_of(plain)[name]])
    none, why = scale_of(creeping, [observables_of(creeping)[name]])
    assert scale.name == "wear_coefficient" and none is None
    assert len(why) == 1 and why[0].startswith("wear_coefficient is not integrated")
