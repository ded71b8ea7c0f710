"""A file of inspections: what it says, and one clear line for each mistake in it."""

from pathlib import Path

import pytest

from uq.errors import InputError
from uq.learning.inspections import Inspection, InspectionKind, all_of, read_inspections
from uq.learning.inspections import read as read_file

HEAD = "unit,time,output,kind,value,sd,cv,detection_50,detection_90\n"
FILE = Path("found.csv")
BARE = '[[inspection]]\nunit = 1\nkind = "measured"\n'


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def read(*lines, head=HEAD):
    FILE.write_text(head + "\n".join(lines) + "\n")
    return read_inspections(FILE)


def test_all_columns_that_are_needed():
    inspections = read(
        "A1,3.15e7,depth,measured,1e-4,,0.1,,",
        "A2,3.15e7,depth,below,5e-5,,,,",
        "A3,3.15e7,depth,below,,,,3e-5,6e-5",
        "A2,6.3e7,life,survived,,,,,",
        "",
        "B 1,,angle,measured,-0.1,0.01,,,",
    )
    assert inspections == [
        Inspection("A1", "depth", InspectionKind.MEASURED, 3.15e7, 1e-4, cv=0.1),
        Inspection("A2", "depth", InspectionKind.BELOW, 3.15e7, 5e-5),
        Inspection(
            "A3", "depth", InspectionKind.BELOW, 3.15e7, detection_50=3e-5, detection_90=6e-5
        ),
        Inspection("A2", "life", InspectionKind.SURVIVED, 6.3e7),
        Inspection("B 1", "angle", InspectionKind.MEASURED, value=-0.1, sd=0.01),
    ]


def test_columns_in_any_order_and_names_with_commas():
    inspections = read(
        '"time_to_depth[site=left,depth=0.00025]", survived, A1, 6.3e7',
        head="output, kind, unit, time\n",
    )
    assert inspections == [
        Inspection("A1", "time_to_depth[site=left,depth=0.00025]", InspectionKind.SURVIVED, 6.3e7)
    ]


@pytest.mark.parametrize(
    ("line", "message"),
    {
        "A,1,depth,measured,1e-4,,,,": "sd or cv is missing: the error of the measurement",
        "A,1,depth,measured,,1e-5,,,": "value is missing: what was measured",
        "A,1,depth,measured,1e-4,1e-5,0.1,,": "sd and cv: give one of them",
        "A,1,depth,measured,1e-4,0,,,": "sd = 0: must be above 0",
        "A,1,depth,measured,1e-4,,10,,": (
            "cv = 10: must be a coefficient of variation, such as 0.1"
        ),
        "A,1,depth,measured,-1e-4,,0.1,,": (
            "value = -0.0001: must be above 0 with a cv; or give an sd"
        ),
        "A,1,depth,measured,1e-4,1e-5,,1e-5,2e-5": (
            "detection_50 = 1e-05: only for kinds below and above"
        ),
        "A,1,depth,measurd,1e-4,1e-5,,,": (
            "kind = measurd: no such kind; did you mean 'measured'? (allowed: measured, below,"
            " above, survived, ended)"
        ),
        "A,1,depth,below,,,,,": (
            "value is missing: the limit; or give detection_50 and detection_90"
        ),
        "A,1,depth,below,,,,1e-5,": "detection_90 is missing beside detection_50",
        "A,1,depth,below,,,,2e-5,1e-5": "detection_90 = 1e-05: must be above detection_50 = 2e-05",
        "A,1,depth,below,1e-5,,,1e-5,2e-5": (
            "value = 1e-05: leave it out beside a curve of detection"
        ),
        "A,,life,survived,,,,,": "time is missing: a life has survived by a time",
        "A,1,life,ended,3,,,,": "value = 3: leave it out where a unit has ended",
        "A,-1,life,ended,,,,,": "time = -1: must not be negative",
        "A,soon,life,ended,,,,,": (
            "time = soon: must be a finite number, in the unit of the life, since that began"
        ),
        "A,2026-03-01,life,ended,,,,,": (
            "time = 2026-03-01: must be a finite number, in the unit of the life, since that began"
        ),
        "A,1,depth,below,80 um,,,,": "value = 80 um: must be a finite number",
        "A,1,depth,below,7_000,,,,": "value = 7_000: must be a finite number",
        "A,1,depth,below,٣,,,,": "value = ٣: must be a finite number",
        "A\x07,1,life,ended,,,,,": "unit = 'A\\x07': must consist of printable characters",
        ",1,life,ended,,,,,": "unit is missing",
    }.items(),
)
def test_a_mistake_is_named(line, message):
    with pytest.raises(InputError) as refused:
        read("A,1,life,survived,,,,,", line)
    assert str(refused.value) == f"found.csv, line 3: {message}"


def test_every_mistake_is_named_at_once():
    with pytest.raises(InputError) as refused:
        read("A,1,depth,measured,1e-4,,,,", "A,1,depth,below,,,,,")
    assert [line.partition(":")[0] for line in refused.value.lines] == [
        "found.csv, line 2",
        "found.csv, line 3",
    ]


@pytest.mark.parametrize(
    ("head", "message"),
    [
        (
            "unit,output,kind,valeu\n",
            "found.csv, line 1: no such column 'valeu'; did you mean 'value'?",
        ),
        ("unit,output\n", "found.csv, line 1: has no column 'kind'"),
        ("unit,unit,output,kind\n", "found.csv, line 1: has several columns 'unit'"),
        ("unit,output,kind,\n", "found.csv, line 1: has a column without a name"),
        ("unit;output;kind\n", "found.csv, line 1: separate cells by commas"),
    ],
)
def test_columns_that_do_not_fit(head, message):
    with pytest.raises(InputError) as refused:
        read(head=head)
    assert str(refused.value).startswith(message)


def test_files_that_are_none():
    with pytest.raises(InputError, match="nothing.csv: no such file"):
        read_inspections(Path("nothing.csv"))
    with pytest.raises(InputError, match=r"found.csv: has no inspection below its first line"):
        read()
    with pytest.raises(InputError, match=r"line 2: 3 of 9 cells; separate cells by commas"):
        read("A,1,life")
    with pytest.raises(InputError, match=r"found.csv, line 2: not CSV: unexpected end of data"):
        read('"A,1,life')
    FILE.write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match=r"found.csv: not CSV in UTF-8"):
        read_inspections(FILE)


def test_tables_of_a_toml_file():
    FILE.with_suffix(".toml").write_text(
        '[[inspection]]\nunit = "A"\noutput = "life"\nkind = "survived"\ntime = 3.15e7\n'
    )
    assert read_file("found.toml") == [Inspection("A", "life", InspectionKind.SURVIVED, 3.15e7)]
    FILE.with_suffix(".toml").write_text('[[inspection]]\nunit = "A"\nkind = "lived"\n')
    with pytest.raises(InputError) as refused:
        read_file("found.toml")
    assert refused.value.lines[0] == "found.toml, inspection at line 1: output is missing"
    FILE.with_suffix(".toml").write_text(
        '[[inspection]]\nunit = ""\noutput = "life"\nkind = "survived"\ntime = 1\n'
    )
    with pytest.raises(InputError, match="^found.toml, inspection at line 1: unit is missing$"):
        read_file("found.toml")
    FILE.with_suffix(".toml").write_text('inspection = [{unit = "A", output = "life"}]')
    with pytest.raises(InputError, match="^found.toml: inspection 1: kind is missing"):
        read_file("found.toml")
    FILE.with_suffix(".toml").write_text(
        "# found\n" + BARE + "value = '7e5'\nsd = true\n\n" + BARE + "valeu = 3\n"
    )
    with pytest.raises(InputError) as refused:
        read_file("found.toml")
    assert refused.value.lines == (
        "found.toml, inspection at line 2: unit = 1: must be text, in quotes",
        'found.toml, inspection at line 2: value = "7e5": must be a number, without quotes',
        "found.toml, inspection at line 2: sd = true: must be a number, without quotes",
        "found.toml, inspection at line 8: unit = 1: must be text, in quotes",
        "found.toml, inspection at line 8: no such column 'valeu'; did you mean 'value'? (allowed:"
        " unit, output, kind, time, value, sd, cv, detection_50, detection_90)",
    )
    for text, why in (("x = 1", "must consist of tables"), ("x = ", "not TOML")):
        FILE.with_suffix(".toml").write_text(text)
        with pytest.raises(InputError, match=f"^found.toml: {why}"):
            read_file("found.toml")
    with pytest.raises(InputError, match="^lost.toml: cannot be read"):
        read_file("lost.toml")


def test_each_measurement_counts_once_and_none_contradicts_another():
    read("A,2,life,survived,,,,,", "A,2,life,survived,,,,,", "A,1,life,ended,,,,,")
    with pytest.raises(InputError) as refused:
        all_of([], read_file(FILE))
    again, *contradictions = refused.value.lines
    assert again == (
        "found.csv, line 3 (unit A, life, survived): already used by found.csv, line 2; a"
        " measurement counts once"
    )
    assert contradictions[0] == (
        "found.csv, line 2 (unit A, life): survived until 2, but had ended by 1 (found.csv, line 4)"
    )
