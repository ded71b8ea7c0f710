"""What every model promises, held against every model that is installed."""

import pickle
from dataclasses import FrozenInstanceError, fields, replace
from typing import get_args

import numpy as np
import pytest

from uq.contract import Kind, Parameter, Setting, Status, censored_name
from uq.sampling.named_values import read_settings, setting_types
from uq.study.evaluate import evaluate
from uq.study.installed_models import find_model, model_names

RESERVED = {"row", "replicate", "group", "block", "status", "trajectory", "time", "quantity"}
TIME_UNITS = {"days", "hours", "minutes", "seconds", "milliseconds", "microseconds", "nanoseconds"}
"""Units that plain xarray would turn into calendar arithmetic."""


@pytest.fixture(scope="module", params=model_names())
def model(request):
    return find_model(request.param)


@pytest.fixture(scope="module")
def settings(model):
    return model.settings()


def but_slowly(*names):
    """Take each model; these among the slow tests."""
    return pytest.mark.parametrize(
        "model",
        [pytest.param(name, marks=[pytest.mark.slow] * (name in names)) for name in model_names()],
        indirect=True,
        scope="module",
    )


def near_nominal(model, rows, seed=1):
    """Return rows within a fifth of the nominal values, the first one nominal."""
    rng = np.random.default_rng(seed)
    nominal = np.array(list(model.nominal.values()))
    x = nominal * rng.uniform(0.8, 1.2, (rows, len(nominal)))
    x[0] = nominal
    low, high = np.transpose([model.parameter(name).bounds for name in model.parameter_names])
    return np.clip(x, low, high), rng.integers(0, 2**63, rows, dtype=np.uint64)


def run(model, settings, x, seed):
    """Return what a batch gives, contract checked, as one dict of arrays."""
    chunk = evaluate(model.given(settings), settings, x, seed)
    return chunk.columns | {"status": chunk.status}


def with_all_outputs(model):
    """Return settings under which a model has every output."""
    mapped = {"map_growth": 1e-4} if "map_growth" in model.setting_names else {}
    lists = dict.fromkeys(optional_coordinates(model), (1.0, 2.0))
    return replace(model.settings(), **lists, **mapped)


def optional_coordinates(model):
    """Return the optional settings that are lists of numbers: coordinates of a dimension."""
    lists = [name for name, kind in setting_types(model).items() if kind == tuple[float, ...]]
    return [name for name in lists if model.setting(name).optional]


def bits(columns):
    return {name: column.tobytes() for name, column in columns.items()}


def test_the_model_introduces_itself(model):
    assert model.name in model_names()
    assert find_model(model.name) is model
    assert model.title and "\n" not in model.title
    assert model.version
    assert model.block >= 1


def test_names_are_words_and_belong_to_one_thing(model):
    names = [*model.parameter_names, *model.outputs]
    names += [censored_name(name) for name in model.outputs]
    names += {dim for output in model.outputs.values() for dim in output.dims}
    assert all(name.isidentifier() and name == name.lower() for name in names)
    assert len(names) == len(set(names))
    assert not RESERVED & set(names)


def test_parameters_are_documented(model):
    for name in model.parameter_names:
        parameter = model.parameter(name)
        assert isinstance(parameter, Parameter)
        for text in (parameter.symbol, parameter.unit, parameter.meaning, parameter.source):
            assert text.strip() and "\n" not in text, name
        assert parameter.unit not in TIME_UNITS, name


def test_one_symbol_means_one_thing(model):
    symbols = [model.parameter(name).symbol for name in model.parameter_names]
    assert sorted(set(symbols)) == sorted(symbols)


def test_nominal_values_lie_within_bounds_that_leave_room(model):
    for name, nominal in model.nominal.items():
        low, high = model.parameter(name).bounds
        assert np.isfinite(low), name
        assert low <= nominal <= high, name  # an infinite stiffness is a rigid part
        assert low < high, name
        # The analytic functions are defined on a box; a physical quantity may be 30 times other.
        if low > 0:
            assert low <= nominal / 30 * (1 + 1e-9) and high >= 30 * nominal * (1 - 1e-9), name


def test_settings_are_documented_frozen_and_travel(model, settings):
    for name in model.setting_names:
        setting = model.setting(name)
        assert isinstance(setting, Setting)
        assert setting.meaning.strip() and setting.unit.strip(), name
    defaults = {field.name: getattr(settings, field.name) for field in fields(settings)}
    assert read_settings(model, defaults) == (settings, {})
    assert pickle.loads(pickle.dumps(settings)) == settings
    for name in model.setting_names:
        with pytest.raises(FrozenInstanceError):
            setattr(settings, name, None)


def test_outputs_are_documented(model):
    settings = with_all_outputs(model)
    coordinates = model.coordinates(settings)
    assert model.outputs and model.given(settings).outputs.keys() == model.outputs.keys()
    for name, output in model.outputs.items():
        assert output.unit.strip() and output.meaning.strip() and "\n" not in output.meaning, name
        assert output.unit not in TIME_UNITS, name
        assert output.kind in get_args(Kind), name
        assert output.is_category == bool(output.categories), name
        assert len(set(output.categories)) == len(output.categories), name
        assert not any(" " in label or label == "none" for label in output.categories), name
        for dim in output.dims:
            values = list(coordinates[dim])
            assert values and len(set(values)) == len(values), dim
        if output.accuracy:
            assert output.accuracy in model.setting_names, name
            assert model.outputs[f"{name}_error"].dims == output.dims, name
            assert model.outputs[f"{name}_error"].unit == output.unit, name


def test_the_nominal_row_is_sound(model, settings):
    x, seed = near_nominal(model, 1)
    assert run(model, settings, x, seed)["status"] == [Status.OK]


@pytest.mark.parametrize(
    "model",
    [m for m in map(find_model, model_names()) if with_all_outputs(m) != m.settings()],
    ids=lambda m: m.name,
)
def test_outputs_along_optional_coordinates_leave_the_others_as_they_are(model):
    settings, more = model.settings(), with_all_outputs(model)
    optional = [name for name in model.setting_names if model.setting(name).optional]
    assert all(getattr(settings, name) == () for name in optional)
    assert model.choices_of(settings).keys() == set(model.setting_names) - set(optional)
    coordinates = set(optional_coordinates(model))
    assert model.choices_of(more).keys() == set(model.setting_names) - set(optional) | coordinates
    x, seed = near_nominal(model, 5)
    few, many = bits(run(model, settings, x, seed)), bits(run(model, more, x, seed))
    assert few.keys() < many.keys()
    assert few == {name: many[name] for name in few}


@pytest.mark.parametrize(
    ("rows", "apart"), [(4, (0, 3)), pytest.param(7, (0, 3, 6), marks=pytest.mark.slow)]
)
def test_a_row_does_not_depend_on_its_neighbours(model, rows, apart):
    settings = with_all_outputs(model)
    x, seed = near_nominal(model, rows)
    whole = run(model, settings, x, seed)
    for i in apart:
        alone = run(model, settings, x[i : i + 1], seed[i : i + 1])
        assert bits(alone) == bits({name: column[i : i + 1] for name, column in whole.items()})


@but_slowly("beam", "mole")
def test_permuted_rows_permute_the_results(model):
    settings = with_all_outputs(model)
    x, seed = near_nominal(model, 2 * min(model.block, 16) + 3, seed=2)
    order = np.random.default_rng(3).permutation(len(x))
    whole = run(model, settings, x, seed)
    mixed = run(model, settings, x[order], seed[order])
    assert bits(mixed) == bits({name: column[order] for name, column in whole.items()})


def test_the_same_rows_give_the_same_bits_again(model, settings):
    x, seed = near_nominal(model, 3)
    assert bits(run(model, settings, x, seed)) == bits(run(model, settings, x, seed))


def test_only_models_that_say_so_depend_on_the_seed(model, settings):
    x, seed = near_nominal(model, 3)
    for name, value in model.random_unless.items():
        assert model.random
        x[:, model.parameter_names.index(name)] = value
    if model.random_unless or not model.random:
        assert bits(run(model, settings, x, seed)) == bits(run(model, settings, x, seed[::-1]))


def nominally(model):
    """Return the model with the exponents that hold at its default settings and nominal values."""
    return model.given(model.settings(), model.nominal)


SCALED = [
    m
    for m in map(find_model, model_names())
    if any(o.exponents for o in nominally(m).outputs.values())
]


def held(model):
    """Return the parameters that must keep their nominal values for lives to scale."""
    settings, nominal = model.settings(), model.nominal
    wanted = {name: output.exponents for name, output in nominally(model).outputs.items()}
    return [
        parameter
        for parameter in nominal
        if wanted
        != {
            name: output.exponents
            for name, output in model.given(
                settings, {other: nominal[other] for other in nominal if other != parameter}
            ).outputs.items()
        }
    ]


def rows_that_differ_in_scale(model, scales, far):
    """Return groups of rows that differ in the scaling parameters alone, and the factor of each.

    Two near nominal and as many as wished far from it, at corners of the bounds and within them;
    what scales takes both of its bounds in each group.
    """
    few, seed = near_nominal(model, 2, seed=5)
    low, high = np.array([model.parameter(name).bounds for name in model.parameter_names]).T
    rng = np.random.default_rng(6)
    places = rng.random((far, len(low)))
    places[::2] = places[::2] > 0.5
    others = low + (high - low) * places
    for name in held(model):
        others[:, model.parameter_names.index(name)] = model.nominal[name]
    columns = [model.parameter_names.index(name) for name in scales]
    low, high = low[columns], high[columns]
    low = np.where(low > 0, low, 1e-9 * high)
    groups = []
    for base in (*few, *others):
        x = np.repeat(base[None], 5, axis=0)
        x[:, columns] = low * (high / low) ** rng.random((5, len(columns)))
        x[[0, -1]] = base
        x[0, columns], x[-1, columns] = low, high
        groups.append(x)
    x = np.array(groups)
    factor = np.prod(x[..., columns] ** np.array(list(scales.values())), axis=-1)
    seeds = np.repeat(np.resize(seed, len(groups)), 5)
    return x.reshape(-1, x.shape[-1]), seeds, factor.ravel()


@pytest.mark.parametrize("far", [1, pytest.param(8, marks=pytest.mark.slow)])
@pytest.mark.parametrize("model", SCALED, ids=lambda m: m.name)
def test_scales_are_exact(model, far):
    """A life is proportional to the powers that its output declares, to the last digits."""
    for name, output in model.outputs.items():
        assert not output.scales or output.is_lifetime, name  # also where it depends on a study
    outputs = nominally(model).outputs
    for name, output in outputs.items():
        assert all(exponent and model.parameter(p) for p, exponent in output.scales.items()), name
    wanted = {name: output for name, output in outputs.items() if output.scales}
    x, seed, factor = rows_that_differ_in_scale(model, next(iter(wanted.values())).scales, far)
    whole = run(model, model.settings(), x, seed)
    finite = np.concatenate([whole[name][np.isfinite(whole[name])] for name in wanted])
    assert finite.size
    if far > 1:
        assert any(np.isposinf(whole[name]).any() for name in wanted)  # rows that never end
    kept = {"horizon": float(np.median(finite))} if "horizon" in model.setting_names else {}
    cut = run(model, replace(model.settings(), **kept), x, seed)
    for name, output in wanted.items():
        assert output.scales == next(iter(wanted.values())).scales
        of = factor.reshape(-1, 5, *[1] * len(output.dims))
        for columns in (whole, cut):
            life = columns[name].reshape(-1, 5, *columns[name].shape[1:])
            censored = np.zeros_like(life, dtype=bool)
            if output.has_censored_flag:
                censored = columns[censored_name(name)].reshape(life.shape).astype(bool)
            unit = life / of
            unit_life = np.where(censored, np.nan, unit)
            level = np.nanmax(unit_life, axis=1, keepdims=True, initial=-np.inf)
            level = np.where(level == -np.inf, np.nan, level)
            with np.errstate(invalid="ignore"):  # never over never
                same = (unit_life == level) | (np.abs(unit_life / level - 1) < 1e-12)
            assert (same | np.isnan(unit_life)).all(), name
            # A row that is cut at the horizon has a life of at least that, whatever its scale.
            assert (~censored | np.isnan(level) | (unit <= level * (1 + 1e-12))).all(), name
        if kept and output.has_censored_flag:
            long = whole[name] > kept["horizon"]
            ended = long & np.isfinite(whole[name])
            assert (cut[name][ended] == kept["horizon"]).all()
            assert cut[censored_name(name)][ended].all()


DRAWN = [
    ("scar", ("prismatic", "flat-bar", "dimple", "inclined")),
    (
        ("wear_law", "wear_law_numbers"),
        (
            ("archard", ()),
            ("power", (("exponent", 1.3), ("threshold", 0.2))),
            ("running-in", (("share", 0.3), ("volume", 1e-11))),
            ("edf", (("exponent", 1.2),)),
        ),
    ),
    (
        ("duty", "order"),
        (
            ((), "mixed"),
            (((("share", 0.5),), (("share", 0.3), ("force", 0.9))), "mixed"),
            (((("duration", 1e3),), (("duration", 2e3), ("wear", 0.0))), "sequence"),
        ),
    ),
    ("gap_history", ((), ((0.0, 0.0), (1e6, 1e-6)))),
]
"""Settings of the beam on which its scaling exponents depend, and values to draw from."""


QUICK = (4, 6, 11, 20, 29)
"""Seeds that draw every scar, three laws of wear, and duty in both orders."""


def drawn_settings(model, seed):
    rng = np.random.default_rng(seed)
    choices = {"depths": (2e-5, 4e-5), "accuracy": 0.05}
    for names, values in DRAWN:
        value = values[rng.integers(len(values)) if rng.random() < 0.6 else 0]
        choices |= (
            {names: value} if isinstance(names, str) else dict(zip(names, value, strict=True))
        )
    return model.settings(**choices)


def power_of(model, settings, base, name, outputs):
    """Return the exponent of a parameter in lives near a row; NaN if they are no power of it."""
    place = model.parameter_names.index(name)
    x = np.repeat(base[None], 3, axis=0)
    x[:, place] *= [1.0, 1.01, 1.03]
    columns = run(model, settings, x, np.zeros(3, np.uint64))
    lives = np.concatenate([columns[name].reshape(3, -1) for name in outputs], axis=1)
    lives = lives[:, np.isfinite(lives).all(axis=0)]
    exponents = np.diff(np.log(lives), axis=0) / np.diff(np.log(x[:, place]))[:, None]
    is_power = exponents.size and np.ptp(exponents) < 1e-6
    return round(float(exponents.mean()), 4) if is_power else np.nan


@pytest.mark.parametrize(
    "seed",
    [s if s in QUICK else pytest.param(s, marks=pytest.mark.slow) for s in range(40)],
)
def test_under_drawn_settings_lives_scale_as_declared_and_in_no_other_input(seed):
    model = find_model("beam")
    settings = drawn_settings(model, seed)
    rng = np.random.default_rng(seed)
    base = np.array(list(model.nominal.values()))
    names = ("support_wear_ratio", "oxide_thickness", "oxide_wear_factor", "creep_down")
    for name, value in zip(names, (0.5, 1e-5, 0.3, 3e-6), strict=True):
        if rng.random() < 0.3:
            base[model.parameter_names.index(name)] = value
    constants = dict(zip(model.parameter_names, base.tolist(), strict=True))
    given = model.given(settings, constants).outputs
    outputs = ("time_to_depth", "first_time_to_depth")
    candidates = (
        "wear_coefficient", "contact_area", "rod_radius", "support_width", "support_radius",
        "support_inclination", "initial_gap", "wear_coefficient_ratio",
    )  # fmt: skip
    exponents = {name: power_of(model, settings, base, name, outputs) for name in candidates}
    shown = {name: e for name, e in exponents.items() if e and not np.isnan(e)}
    assert shown == given["first_time_to_depth"].exponents
    assert given["time_to_depth"].exponents == given["first_time_to_depth"].exponents


@but_slowly("mole")
@pytest.mark.parametrize("rows", [2, pytest.param(16, marks=pytest.mark.slow)])
def test_corners_of_the_bounds_end_with_a_status(model, settings, rows):
    rng = np.random.default_rng(4)
    bounds = np.array([model.parameter(name).bounds for name in model.parameter_names])
    x = np.where(rng.random((rows, len(bounds))) < 0.5, bounds[:, 0], bounds[:, 1])
    status = run(model, settings, x, np.arange(rows, dtype=np.uint64))["status"]
    assert not np.isin(status, [Status.RAISED, Status.BAD_SHAPE]).any()


@pytest.mark.parametrize(
    "model", [m for m in map(find_model, model_names()) if m.simulate], ids=lambda m: m.name
)
def test_a_trajectory_is_labelled_and_finite(model):
    time, quantities = model.simulate(model.parameters(), model.settings(), seed=0)
    assert np.all(np.diff(time) > 0)
    assert quantities
    for name, (unit, meaning, values) in quantities.items():
        assert unit.strip() and meaning.strip(), name
        assert values.shape == time.shape and np.isfinite(values).all(), name
