"""Studies of which the inputs matter: their text, their rows, and what is said of a wrong one."""

import pytest
from computed import as_text

from uq.errors import InputError
from uq.study.definition import study_from_text
from uq.study.row_sampling import row_block, rows

UNIFORM = {"distribution": "uniform", "lower": 0.1, "upper": 0.9}
BELL = {"distribution": "normal", "mean": 0.5, "sd": 0.05}


def tables(uncertain, method="monte-carlo", samples=4096, model="linear", **more):
    return {
        "study": {"name": "inputs", "model": model},
        "design": {"method": method, "samples": samples, **more.pop("design", {})},
        "uncertain": uncertain,
        **more,
    }


def inputs_of(study):
    x = row_block(study, 0, rows(study)).x
    return dict(zip(study.model.parameter_names, x.T, strict=True))


def refusal(given, folder=None):
    with pytest.raises(InputError) as caught:
        study_from_text(as_text(given), "x.toml", folder=folder)
    (line,) = caught.value.lines
    return line.removeprefix("x.toml: ")
