"""What a study file says when it is wrong: one line per fault, all at once, nothing else."""

from math import inf, nan, pi

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from study_text import ISHIGAMI, UNIFORM, study_text

from uq.errors import InputError
from uq.literals import toml
from uq.study.definition import Study, load_study, study_from_text

BOUNDS = f"{-pi!r} to {pi!r} [1]"


def lines(changes=None, text=None):
    with pytest.raises(InputError) as caught:
        study_from_text(study_text(changes) if text is None else text, "x.toml")
    return caught.value.lines


# changes -> the one line
ONE_FAULT = [
    # tables and keys
    ({"study": {"name": None}}, "[study] name: is missing"),
    ({"design": {"samples": None}}, "[design] samples: is missing"),
    (
        {"study": {"modle": "x"}},
        "[study] modle = \"x\": no such key; did you mean 'model'?"
        " (allowed: name, model, description)",
    ),
    (
        {"desing": {"seed": 1}},
        "[desing]: no such table; did you mean 'design'?"
        " (allowed: study, design, fixed, uncertain,"
        " dependence, settings, analysis, data)",
    ),
    # what is missing because it is misspelt is reported once
    (
        {"design": {"samples": None, "sampels": 8}},
        "[design] sampels = 8: no such key; did you mean",
    ),
    (
        {"uncertain": {"x3": {"distribution": "uniform", "lower": 0.0, "uper": 4.0}}},
        "[uncertain.x3] uper = 4.0: no such argument of x3's law; did you mean 'upper'?",
    ),
    (
        {"uncertain": {"x3": {"distrbution": "uniform", "lower": 0.0, "upper": 4.0}}},
        "[uncertain.x3] distrbution = \"uniform\": no such key; did you mean 'distribution'?",
    ),
    (
        {"analysis": {"tolerance": {"coverage": 0.95, "confidenc": 0.95}}},
        "[analysis] tolerance.confidenc = 0.95: no such key; did you mean 'confidence'?",
    ),
    (
        {"study": {"name": "a/b"}},
        "[study] name = \"a/b\": must consist of letters, digits, '-' and '_'",
    ),
    ({"study": {"name": "n" * 101}}, "must have at most 100 characters"),
    ({"study": {"description": 3}}, "[study] description = 3: must be a text in quotes"),
    # the model
    (
        {"study": {"model": "ishigmi"}},
        "[study] model = \"ishigmi\": no such model 'ishigmi'; did you mean 'ishigami'?",
    ),
    (
        {"study": {"model": "models.analytic:LINEAR"}},
        "must consist of letters, digits, '-' and '_'",
    ),
    # the design
    (
        {"design": {"method": "monte_carlo"}},
        "[design] method = \"monte_carlo\": no such design; did you mean 'monte-carlo'?"
        " (allowed: monte-carlo, latin-hypercube, sobol, halton, saltelli, morris,"
        " morris-optimised, shapley, fast, rbd-fast, imported)",
    ),
    (
        {"design": {"method": "saltelli", "samples": 1000}},
        "[design] samples = 1000: must be a power of two; the next is 1024 for 'saltelli'",
    ),
    (
        {"design": {"method": "sobol", "samples": 1000}},
        "[design] samples = 1000: must be a power of two; the next is 1024 for 'sobol'",
    ),
    ({"design": {"samples": 0}}, "[design] samples = 0: must be at least 1"),
    ({"design": {"samples": 2**31}}, "[design] samples = 2147483648: must be at most 1073741824"),
    (
        {"design": {"samples": 8.0}},
        "[design] samples = 8.0: must be a whole number, without a decimal point",
    ),
    ({"design": {"samples": True}}, "[design] samples = true: must be a whole number"),
    ({"design": {"samples": "8"}}, '[design] samples = "8": must be a whole number'),
    ({"design": {"replicates": 0}}, "[design] replicates = 0: must be at least 1"),
    ({"design": {"seed": -1}}, "[design] seed = -1: must be at least 0"),
    ({"design": {"second_order": 1}}, "[design] second_order = 1: must be true or false"),
    (
        {"design": {"second_order": True}},
        "[design] second_order = true: only for method = 'saltelli'",
    ),
    # fixed parameters
    (
        {"fixed": {"zebra": 1.0}},
        "[fixed] zebra = 1.0: no such parameter of model 'ishigami' (allowed: x1, x2, x3)",
    ),
    (
        {"fixed": {"x1": 1.0}},
        "[uncertain.x1]: is in [fixed] too; keep one of the two",
    ),
    (
        {"uncertain": {"x3": None}, "fixed": {"x3": -5.0}},
        f"[fixed] x3 = -5.0: must lie within {BOUNDS}",
    ),
    (
        {"uncertain": {"x3": None}, "fixed": {"x3": True}},
        "[fixed] x3 = true: must be a number",
    ),
    (
        {"uncertain": {"x3": None}, "fixed": {"x3": nan}},
        f"[fixed] x3 = nan: must lie within {BOUNDS}",
    ),
    (
        {"uncertain": {"x3": None}, "fixed": {"x3": -inf}},
        f"[fixed] x3 = -inf: must lie within {BOUNDS}",
    ),
    # laws
    (
        {"uncertain": {"x33": UNIFORM}},
        "[uncertain.x33]: no such parameter of model 'ishigami'; did you mean 'x3'?",
    ),
    ({"uncertain": {"x3": 1.0}}, "uncertain.x3 = 1.0: must be a table"),
    (
        {"uncertain": {"x3": {"lower": 0, "upper": 1}}},
        "[uncertain.x3] distribution: is missing (one of uniform, loguniform, normal,",
    ),
    (
        {"uncertain": {"x3": {"distribution": "unifrom", "lower": 0, "upper": 1}}},
        "[uncertain.x3] distribution = \"unifrom\": no such law; did you mean 'uniform'?",
    ),
    (
        {"uncertain": {"x3": {"distribution": "uniform", "lower": 0}}},
        "[uncertain.x3] upper: is missing",
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "meen": 1}}},
        "[uncertain.x3] meen = 1: no such argument of x3's law"
        " (allowed: source, distribution, lower, upper, truncate, times)",
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "lower": "0"}}},
        '[uncertain.x3] lower = "0": must be a number',
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "lower": inf}}},
        "[uncertain.x3] lower = inf: must be a finite number",
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "lower": 2, "upper": 1}}},
        "[uncertain.x3]: must have lower < upper: lower = 2.0, upper = 1.0",
    ),
    (
        {"uncertain": {"x3": {"distribution": "normal", "mean": 0, "sd": -0.1}}},
        "[uncertain.x3] sd = -0.1: must be greater than 0",
    ),
    (
        {"uncertain": {"x3": {"distribution": "normal", "mean": 4, "sd": 0.1}}},
        f"[uncertain.x3] mean = 4.0: must lie within the parameter's bounds, {BOUNDS}",
    ),
    (
        {"uncertain": {"x3": {"distribution": "normal", "mean": 0, "sd": 1}}},
        f"[uncertain.x3]: has 0.0017 of its probability outside the parameter's bounds, {BOUNDS}"
        " (allowed: 1e-06); use a truncated-normal with lower and upper within them,"
        " or other numbers",
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "lower": 0, "upper": 4}}},
        f"[uncertain.x3]: has 0.21 of its probability outside the parameter's bounds, {BOUNDS}"
        " (allowed: 1e-06); lower = 0.0 and upper = 4.0 must lie within them",
    ),
    (
        {"uncertain": {"x1": None, "x2": None, "x3": None}},
        "[uncertain]: nothing varies; give at least one parameter a law",
    ),
    # settings
    (
        {"settings": {"depths": [1.25e-4, 2.5e-4]}},
        "[settings] depths = [0.000125, 0.00025]: no such setting of model 'ishigami',"
        " which has none",
    ),
    # analysis
    (
        {"analysis": {"outputs": ["z"]}},
        "[analysis] outputs = \"z\": no such output of model 'ishigami' (allowed: y)",
    ),
    ({"analysis": {"outputs": "y"}}, '[analysis] outputs = "y": must be a list'),
    ({"analysis": {"outputs": ["y", "y"]}}, '"y" is listed twice'),
    ({"analysis": {"quantiles": [0.5, 1.0]}}, "[analysis] quantiles[1] = 1.0: must be less than 1"),
    (
        {"analysis": {"quantiles": [0, 0.5]}},
        "[analysis] quantiles[0] = 0: must be greater than 0",
    ),
    ({"analysis": {"quantiles": 0.5}}, "[analysis] quantiles = 0.5: must be a list"),
    ({"analysis": {"max_failed": 1.5}}, "[analysis] max_failed = 1.5: must be at most 1"),
    (
        {"analysis": {"thresholds": {"z": 1.0}}},
        "[analysis] thresholds.z = 1.0: no such output of model 'ishigami' (allowed: y)",
    ),
    (
        {"analysis": {"thresholds": {"y": "1"}}},
        '[analysis] thresholds.y = "1": must be a number or a list of numbers',
    ),
    ({"analysis": {"tolerance": 0.95}}, "[analysis] tolerance = 0.95: must be a table, such as"),
    (
        {"analysis": {"tolerance": {"coverage": 0.95}}},
        "[analysis] tolerance.confidence: is missing",
    ),
    (
        {"analysis": {"tolerance": {"coverage": 0.95, "confidence": 95}}},
        "[analysis] tolerance.confidence = 95: must be less than 1",
    ),
    (
        {
            "design": {"method": "saltelli"},
            "analysis": {"tolerance": {"coverage": 0.95, "confidence": 0.95}},
        },
        "[analysis] tolerance = {coverage = 0.95, confidence = 0.95}: refused: its confidence"
        " assumes independent rows, and those of 'saltelli' are not; use method = 'monte-carlo',"
        " or leave the bound out",
    ),
    (
        {"analysis": {"sensitivity": ["sobl"]}},
        "[analysis] sensitivity[0] = \"sobl\": no such method; did you mean 'sobol'?"
        " (allowed: rbd-fast, delta, pawn, hdmr, quantile, regional, sobol, morris, shapley, fast)",
    ),
    (
        {"analysis": {"sensitivity": ["sobol"]}},
        "[analysis] sensitivity = \"sobol\": a 'monte-carlo' design cannot feed it,"
        " method = 'saltelli' can; 'monte-carlo' feeds 'rbd-fast' or 'delta' or 'pawn'",
    ),
    (
        {"design": {"method": "saltelli"}, "analysis": {"sensitivity": ["delta"]}},
        "method = 'monte-carlo' or 'latin-hypercube' or 'sobol' or 'halton' or 'rbd-fast' or"
        " 'imported' can",
    ),
]


@pytest.mark.parametrize(("changes", "said"), ONE_FAULT, ids=lambda case: str(case)[:60])
def test_one_fault_is_one_line(changes, said):
    (line,) = lines(changes)
    assert line.startswith("x.toml: ")
    assert said in line
    assert said.startswith(("must", "method", '"y"')) or line.startswith(f"x.toml: {said}")


def test_all_faults_are_reported_at_once_in_the_order_of_the_file():
    text = """
    top = 1
    study = {name = "a b", model = "ishigami", modell = "x"}
    design = {method = "saltelli", samples = 1000, seed = true}
    fixed = {x1 = inf, x9 = 5}
    settings = {depth = 1}
    [uncertain.x1]
    distribution = "uniform"
    lower = 3
    upper = 1
    [uncertain.x2]
    distribution = "lognorml"
    [uncertain.x3]
    distribution = "normal"
    mean = 7
    sd = 1
    [uncertain.x4]
    distribution = "normal"
    mean = 0
    sd = -1
    [analysis]
    quantiles = [0.5, 2]
    outputs = ["z", 3]
    thresholds = {z = 1, y = "a"}
    tolerance = {coverage = 0.95, confidence = 0.95}
    sensitivity = ["sobl", "pawn"]
    """
    places = [line.removeprefix("x.toml: ").partition(":")[0] for line in lines(text=text)]
    assert sorted(places) == sorted(
        [
            '[study] name = "a b"',
            '[study] modell = "x"',
            "[design] seed = true",
            "[design] samples = 1000",
            "[fixed] x1 = inf",
            "[fixed] x9 = 5",
            "[uncertain.x1]",  # lower above upper
            "[uncertain.x1]",  # fixed as well
            '[uncertain.x2] distribution = "lognorml"',
            "[uncertain.x3] mean = 7.0",
            "[uncertain.x4] sd = -1",
            "[uncertain.x4]",  # no such parameter
            "[settings] depth = 1",
            "[analysis] quantiles[1] = 2",
            "[analysis] outputs[1] = 3",
            '[analysis] outputs = "z"',
            '[analysis] thresholds.y = "a"',
            "[analysis] thresholds.z = 1",
            "[analysis] tolerance = {coverage = 0.95, confidence = 0.95}",
            '[analysis] sensitivity[0] = "sobl"',
            '[analysis] sensitivity = "pawn"',
            "top = 1",
        ]
    )
    order = ["study", "design", "fixed", "uncertain", "settings", "analysis", "top"]
    tables = [place.strip("[").replace(".", "]").partition("]")[0] for place in places]
    assert [order.index(table.split(" ")[0]) for table in tables] == sorted(
        order.index(table.split(" ")[0]) for table in tables
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[study\n", "not valid TOML: Expected ']' at the end of a table declaration (at line 1"),
        ("[study]\nname = \n", "Invalid value (at line 2, column 8)"),
        ("[study]\n[study]\n", "Cannot declare ('study',) twice (at line 2, column 7)"),
        ('[study]\nname = "a"\nname = "b"\n', "Cannot overwrite a value (at line 3"),
        ("a = [-inf, 1e400]", "not valid TOML: 1e400 is too large for a number"),
        ("a = " + "[" * 5000, "not valid TOML: "),
        ("a = 1" + "0" * 5000, "not valid TOML: "),
    ],
)
def test_a_fault_of_syntax_names_its_line(text, said):
    (line,) = lines(text=text)
    assert line.startswith("x.toml: not valid TOML: ")
    assert said in line


def test_an_empty_file_lists_what_it_lacks():
    assert lines(text="") == (
        "x.toml: [study]: is missing",
        "x.toml: [design]: is missing",
        "x.toml: [uncertain]: is missing",
    )


def test_a_file_that_cannot_be_read_is_one_line(tmp_path):
    (tmp_path / "beam-lifetime.toml").write_text(study_text())
    (tmp_path / "latin.toml").write_bytes(b"# caf\xe9")
    (tmp_path / "loop.toml").symlink_to(tmp_path / "loop.toml")

    def line(name):
        with pytest.raises(InputError) as caught:
            load_study(tmp_path / name)
        (line,) = caught.value.lines
        return line

    assert line("") == f"{tmp_path}: is a directory; a study is a TOML file"
    missing = f"{tmp_path}/beam-liftime.toml: no such file; did you mean 'beam-lifetime.toml'?"
    assert line("beam-liftime.toml") == missing
    assert line("nowhere/x.toml") == (
        f"{tmp_path}/nowhere/x.toml: no such file; 'uq init MODEL > x.toml' writes one to edit"
    )
    assert line("latin.toml").endswith("not a text file in UTF-8 (byte 5 is 0xe9)")
    assert "cannot be read: " in line("loop.toml")
    assert "cannot be read: " in line("nul\0.toml")


def test_odd_names_stay_on_one_line():
    (line,) = lines(text=study_text() + '\nfixed = {"a\\nb c" = 1.0}')
    assert line.startswith('x.toml: [fixed] "a\\nb c" = 1.0: no such parameter')
    (line,) = lines({"study": {"description": ["\n" * 100]}})
    assert "\n" not in line
    assert len(line) < 150


PLACES = [(table, key) for table, entries in ISHIGAMI.items() for key in entries] + [
    ("fixed", "x1"),
    ("settings", "x1"),
    ("design", "replicates"),
    ("analysis", "outputs"),
    ("analysis", "quantiles"),
    ("analysis", "tolerance"),
    ("analysis", "thresholds"),
    ("analysis", "sensitivity"),
]
KEYS = st.sampled_from(["x1", "lower", "mean", "sd", "coverage", "distribution", "source"])
VALUES = st.recursive(
    st.one_of(
        st.booleans(),
        st.integers(-(10**20), 10**20),
        st.floats(),
        st.sampled_from(["uniform", "lognormal", "y", "sobol", "", "\n", "1979-05-27"]),
    ),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3),
    max_leaves=6,
)


@settings(deadline=None)
@given(place=st.sampled_from(PLACES), value=VALUES, whole_table=st.booleans())
def test_whatever_stands_anywhere_is_read_or_refused_in_lines(place, value, whole_table):
    table, key = place
    text = study_text({table: {key: value}})
    if whole_table:
        kept = [line for line in study_text().splitlines() if not line.startswith(f"{table} =")]
        text = "\n".join([*kept, f"{table} = {toml(value)}"])
    try:
        assert isinstance(study_from_text(text, "x.toml"), Study)
    except InputError as error:
        assert error.lines
        for line in error.lines:
            assert line.startswith("x.toml: ")
            assert "\n" not in line
