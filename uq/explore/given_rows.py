"""A study whose rows are given as normal scores of its inputs."""

from typing import Any

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.study.definition import Study, study_from_text
from uq.study.row_sampling import physical
from uq.text.literals import read_toml, toml

_FILE = "new rows"


def with_given_rows(study: Study, scores: Floats, name: str, seed: int) -> Study:
    """Return a study of the same model with given rows.

    Parameters
    ----------
    study : Study
        Not of imported rows.
    scores : ndarray, shape (n, inputs)
        Normal scores of its inputs, in their order.
    name : str
        Of the new study, in messages.
    seed : int
        From which rows of a random model have theirs.
    """
    names = study.model.parameter_names
    x = physical(study, special.ndtr(scores))
    columns = {input_name: x[:, names.index(input_name)] for input_name in study.uncertain}
    tables = {
        table: entries
        for table, entries in read_toml(study.text).items()
        if table not in ("analysis", "dependence")
    }
    tables["uncertain"] = {
        input_name: _within(columns[input_name])
        if input_name in columns and "times" in entry
        else entry
        for input_name, entry in tables["uncertain"].items()
    }
    tables["design"] = {"method": "imported", "file": _FILE, "seed": seed}
    listed = {
        input_name: " ".join(map(repr, values.tolist())) for input_name, values in columns.items()
    }
    tables["data"] = tables.get("data", {}) | {_FILE: listed}
    text = "\n".join(f"{table} = {toml(entries)}" for table, entries in tables.items())
    return study_from_text(text, name, study.model_reference)


def _within(values: Floats) -> dict[str, Any]:
    """Return a law for a column of a multiple of another input, which has none of its own."""
    low, high = float(values.min()), float(values.max())
    return {"distribution": "uniform", "lower": low, "upper": max(high, np.nextafter(low, np.inf))}
