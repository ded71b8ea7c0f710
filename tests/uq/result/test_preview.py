"""What is kept of the rows of a run to say how it goes: evenly spaced, and never much of it."""

import numpy as np
import pytest
from computed import UNIFORM, as_text

from uq.result.workload import Preview, workload_of
from uq.study.definition import study_from_text
from uq.study.evaluate import evaluate
from uq.study.row_sampling import row_block


@pytest.mark.parametrize("sizes", [(100_000,), (1,), (7, 1000, 3), (4096, 1, 4097)])
def test_of_many_lives_an_even_part_is_kept(sizes):
    study = study_from_text(
        as_text(
            {
                "study": {"name": "wear", "model": "exponential-wear"},
                "design": {"method": "monte-carlo", "samples": 8},
                "uncertain": {"rate": UNIFORM},
            }
        )
    )
    preview, rows = Preview(workload_of(study)), row_block(study, 0, 1)
    chunk = evaluate(study.model, study.settings, rows.x, rows.seed)
    total = 30_000 if max(sizes) < 30_000 else max(sizes)
    start = i = 0
    while start < total:
        stop = min(start + sizes[i % len(sizes)], total)
        lives = {"life": np.arange(start, stop, dtype=float)}
        preview.add(chunk._replace(columns=chunk.columns | lives))
        start, i = stop, i + 1
    kept = preview._lives._values
    assert 2000 < len(kept) <= 4096 and len(np.unique(np.diff(kept))) == 1
    assert preview.median == ("life", pytest.approx(total / 2, rel=1e-3))
    assert preview.shares == {}


def test_what_is_still_going_on_has_not_ended_and_what_is_frequent_comes_first():
    inside = {"distribution": "uniform", "lower": 0.3, "upper": 0.9}
    given = {
        "study": {"name": "kinds", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 100},
        "uncertain": {"x1": inside},
    }
    study = study_from_text(as_text(given), model="sample_models:KINDS")
    preview, rows = Preview(workload_of(study)), row_block(study, 0, 100)
    chunk = evaluate(study.model, study.settings, rows.x, rows.seed)
    chunk.columns["life_censored"][:60] = True
    preview.add(chunk)
    assert preview.median == ("life[side=left,depth=0.5]", np.inf)
    assert list(preview.shares) == ["fast", "slow"]
    assert preview.shares["slow"] == (chunk.columns["regime"] == 0).mean() < 0.5
