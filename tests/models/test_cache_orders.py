"""The bits of a result do not depend on what had been compiled before, nor on the vector width.

Three caches of compiled code are filled in three orders: all machines in one process; single
motions first, then each machine in a process of its own; and the other way round. A callee that is
loaded from the disk is inlined otherwise than one just compiled, which must show nowhere.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from llvmlite import binding

STUDIES = Path(__file__).parents[2] / "studies"
ROWS = {
    "vibrator": {"vibrator-tolerances": 64, "vibrator-feed": 2},
    "mole": {"mole-progression": 96, "mole-circuit": 8},
    "beam": {"beam-lifetime": 96, "beam-random-load": 1},
}
"""Of each machine, studies that reach both of its propagators, and rows of them."""

PROGRAM = """
import sys
from pathlib import Path

import numpy as np

from uq.study.row_sampling import row_block
from uq.study.definition import load_study

kept, *asked = sys.argv[1:]
for study, rows in zip(asked[::2], asked[1::2]):
    study = load_study(Path(study))
    if rows == "one":
        motion = study.model.simulate(study.model.parameters(), study.settings)
        assert len(motion.time)
        continue
    block = row_block(study, 0, int(rows))
    outputs, status = study.model.batch(block.x, block.seed, study.settings)
    np.savez(Path(kept) / study.name, status=status, **outputs)
"""


def compute(cache, kept, rows, **target):
    asked = [word for study, n in rows.items() for word in (STUDIES / f"{study}.toml", n)]
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM, kept, *map(str, asked)],
        env=os.environ | target | {"XDG_CACHE_HOME": str(cache)},
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 0, ended.stderr


def first(study):
    return {study: "one"}


@pytest.mark.slow
def test_three_orders_of_compilation_give_the_same_bits(tmp_path):
    vibrator, mole, beam = ROWS["vibrator"], ROWS["mole"], ROWS["beam"]
    orders = [
        [vibrator | mole | beam],
        [first("mole-progression"), first("beam-lifetime"), beam, mole, vibrator],
        [first("vibrator-tolerances"), beam | mole | vibrator],
    ]
    for number, order in enumerate(orders):
        kept = tmp_path / f"kept-{number}"
        kept.mkdir()
        for rows in order:
            compute(tmp_path / f"cache-{number}", kept, rows)
    for study in vibrator | mole | beam:
        arrays, *others = [
            np.load(tmp_path / f"kept-{number}" / f"{study}.npz") for number in range(len(orders))
        ]
        for other in others:
            for name in arrays:
                assert arrays[name].tobytes() == other[name].tobytes(), (study, name)


def narrow():
    """Return the target of this computer without vectors of 512 bits."""
    features = binding.get_host_cpu_features()
    for name in features:
        features[name] &= not name.startswith(("avx512", "avx10"))
    return {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": features.flatten()}


@pytest.mark.slow
@pytest.mark.skipif(
    not binding.get_host_cpu_features().get("avx512f"), reason="has one vector width only"
)
@pytest.mark.parametrize("machine", ROWS)
def test_the_vector_width_does_not_show(tmp_path, machine):
    for width, target in (("wide", {}), ("narrow", narrow())):
        (tmp_path / width).mkdir()
        compute(tmp_path / f"cache-{width}", tmp_path / width, ROWS[machine], **target)
    for study in ROWS[machine]:
        wide, narrow_ = (np.load(tmp_path / w / f"{study}.npz") for w in ("wide", "narrow"))
        for name in wide:
            assert wide[name].tobytes() == narrow_[name].tobytes(), (study, name)
