"""What a study file says when it is wrong: one line per fault, all at once, nothing else."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from study_text import ISHIGAMI, study_text
from wordings import STUDY_FAULTS, SYNTAX_FAULTS

from uq.errors import InputError
from uq.study.definition import Study, load_study, study_from_text
from uq.text.literals import toml


def lines(changes=None, text=None):
    with pytest.raises(InputError) as caught:
        study_from_text(study_text(changes) if text is None else text, "x.toml")
    return caught.value.lines


@pytest.mark.parametrize(("changes", "message"), STUDY_FAULTS, ids=lambda case: str(case)[:60])
def test_one_fault_is_one_line(changes, message):
    (line,) = lines(changes)
    assert line.startswith("x.toml: ")
    assert message in line
    assert message.startswith(("must", "method", '"y"')) or line.startswith(f"x.toml: {message}")


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


@pytest.mark.parametrize(("text", "message"), SYNTAX_FAULTS)
def test_a_fault_of_syntax_names_its_line(text, message):
    (line,) = lines(text=text)
    assert line.startswith("x.toml: not valid TOML: ")
    assert message in line


def test_an_empty_file_lists_what_it_lacks():
    assert lines(text="") == (
        "x.toml: [study]: is missing",
        "x.toml: [design]: is missing",
        "x.toml: [uncertain]: is missing",
    )


def test_a_file_that_cannot_be_read_is_one_line(tmp_path):
    for name in ("beam-lifetime", "nope"):
        (tmp_path / f"{name}.toml").write_text(study_text())
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
    assert "did you mean" not in line("mine.toml")  # the ending alone is no likeness
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "mole-outcome.toml").write_text(study_text())
    assert line("mole-outcom").endswith("did you mean 'studies/mole-outcome.toml'?")
    for start in (b"\x89HDF\r\n\x1a\n", b"CDF\x01"):
        (tmp_path / "out.nc").write_bytes(start + bytes(2_000_000))
        assert line("out.nc") == (
            f"{tmp_path}/out.nc: is a netCDF file, not a study; of a result, 'uq summary"
            f" {tmp_path}/out.nc' shows the answer, and 'uq extend {tmp_path}/out.nc --samples N'"
            " adds rows"
        )
    assert line("nowhere/x.toml") == (
        f"{tmp_path}/nowhere/x.toml: no such file; 'uq init MODEL > x.toml' writes one to edit"
    )
    assert line("latin.toml").endswith("not a text file in UTF-8 (byte 5 is 0xe9)")
    assert "cannot be read: " in line("loop.toml")
    assert "cannot be read: " in line("nul\0.toml")


def test_the_laws_are_listed_once():
    wrong = {"distribution": "gauss", "mean": 0.0, "sd": 1.0}
    faults = lines({"uncertain": {"x1": wrong, "x2": {"lower": 0, "upper": 1}, "x3": wrong}})
    assert len(faults) == 3 and [fault.count("(allowed: uniform, ") for fault in faults] == [
        0,
        0,
        1,
    ]
    assert faults[0].endswith(
        "[uncertain.x1] distribution = \"gauss\": no such law; did you mean 'normal'?"
    )


def test_a_text_in_place_of_a_number_shows_a_unit():
    texts = {"x1": {"distribution": "uniform", "lower": "0,5 mm", "upper": "abc"}}
    first, second = lines({"uncertain": texts})
    assert first.endswith('"24 hours", "250 um"; numbers have a decimal point: 0.5')
    assert second.endswith('= "abc": must be a number, or have its unit: "24 hours", "250 um"')


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


def test_an_element_in_place_of_an_output_is_answered_with_the_output_and_how_to_choose_it():
    text = """
    study = {name = "rods", model = "beam"}
    design = {method = "monte-carlo", samples = 100}
    uncertain = {initial_gap = {distribution = "uniform", lower = 2e-4, upper = 3e-4}}
    [analysis]
    outputs = ["first_time_to_depth[depth=0.00025]"]
    """
    words = ("first_time_to_depth at 250 um", "first_time_to_depth[depth=250 um]")
    for spelling in ("first_time_to_depth[depth=0.00025]", *words):
        (line,) = lines(text=text.replace("first_time_to_depth[depth=0.00025]", spelling))
        assert "name the output without its element: 'first_time_to_depth'" in line
        assert line.endswith("for one depth alone, give no other in 'depths'")
