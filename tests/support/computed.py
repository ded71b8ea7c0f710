"""Results computed in this process, without files or workers, for tests of what reads results."""

from dataclasses import replace
from functools import wraps

import numpy as np

from uq.assess.comparison import comparison
from uq.assess.summary import summarise
from uq.assess.summary_facts import comparison_facts, summary_facts
from uq.result.result import Result
from uq.result.result_file import build
from uq.study import row_sampling
from uq.study.definition import study_from_text
from uq.study.evaluate import evaluate
from uq.text.literals import toml

UNIFORM = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}


def study_of(tables, model=None):
    """Return the study of some tables; ``model`` may be one that is not installed."""
    return study_from_text(as_text(tables), model=model)


def as_text(tables):
    return "\n".join(f"{table} = {toml(entries)}" for table, entries in tables.items())


def asking(ds, **analysis):
    """Return a result whose study asks for something else."""
    lines = [line for line in ds.attrs["study"].splitlines() if not line.startswith("analysis")]
    return ds.assign_attrs(study="\n".join([*lines, as_text({"analysis": analysis})]))


def once(make):
    """Make each result once in a session; every call returns a copy of its own."""
    results = {}

    @wraps(make)
    def made(*arguments, **options):
        key = repr((arguments, sorted(options.items())))
        if key not in results:
            results[key] = make(*arguments, **options)
        return results[key].copy(deep=True)

    return made


@once
def linear(
    method="monte-carlo", samples=64, replicates=1, analysis=None, settings=None, **more_design
):
    """Return a result of the linear function y = x1 + 2 x2 + 3 x3 + 4 x4."""
    design = {"method": method, "samples": samples, "replicates": replicates, **more_design}
    return computed(
        study_of(
            {
                "study": {"name": "linear", "model": "linear"},
                "design": design,
                "uncertain": dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM),
                "settings": settings or {},
                "analysis": analysis or {},
            }
        )
    )


@once
def kinds(method="monte-carlo", samples=64, replicates=1, analysis=None):
    """Return a result of a model with one output of every kind."""
    inside = {"distribution": "uniform", "lower": 0.01, "upper": 0.99}
    tables = {
        "study": {"name": "kinds", "model": "linear"},
        "design": {"method": method, "samples": samples, "replicates": replicates},
        "uncertain": {"x1": inside, "x2": inside},
        "analysis": analysis or {},
    }
    return computed(study_of(tables, "sample_models:KINDS"))


def summarised(ds, **asked):
    """Return the summary of a result as JSON has it."""
    return summary_facts(summarise(Result(ds), **asked)).json


def compared(*pair):
    """Return the comparison of two results as JSON has it."""
    return comparison_facts(comparison(*map(Result, pair))).json


def with_seed(study, seed):
    """Return the same study with another seed."""
    return replace(study, design=study.design.model_copy(update={"seed": seed}))


def computed(study):
    """Return the result of a study."""
    rows = row_sampling.row_block(study, 0, row_sampling.rows(study))
    chunk = evaluate(study.model, study.settings, rows.x, rows.seed)
    failures = {label: message for label, (_, message) in chunk.failures.items()}
    return build(study, rows, chunk.columns, chunk.status, failures)


def with_output(ds, name, values, kind="value", censored=None):
    """Return a result with one more output, its values in the order of the rows."""
    attrs = {
        "role": "output",
        "kind": kind,
        "units": "s" if kind == "lifetime" else "m",
        "long_name": f"meaning of {name}",
        "may_be_undefined": 0,
    }
    ds = ds.assign({name: ("row", np.asarray(values, dtype=float), attrs)})
    if censored is None:
        return ds
    flag = {"role": "censored", "long_name": f"whether {name} is only a lower bound"}
    return ds.assign({f"{name}_censored": ("row", np.asarray(censored, np.int8), flag)})


def with_status(ds, rows, code):
    """Return a result in which some rows ended with this status."""
    status = ds["status"].copy()
    status[rows] = code
    return ds.assign(status=status)
