"""The studies that are recorded."""

import json
from pathlib import Path

from uq.indices.methods import fed_by
from uq.sampling.designs import DESIGNS

SHIPPED = Path("studies")
SAMPLES = {  # of each replicate
    "beam-basins": 16,
    "beam-depths": 2,
    "beam-lifetime-561": 8,
    "beam-outcome": 8,
    "beam-random-load": 4,
    "beam-sensitivity": 2,
    "beam-worn-depth": 2,
    "exponential-wear": 1000,
    "mole-circuit": 4,
    "mole-frequency": 16,
    "mole-outcome": 16,
    "mole-progression": 100,
    "vibrator-feed": 16,
    "vibrator-run-up": 4,
    "vibrator-startup": 32,
    "vibrator-supports": 4,
    "vibrator-tolerances": 200,
}
ANY = 64
REPLICATES = {"monte-carlo": 1, "fast": 2}
LAWS = {
    "ishigami": {name: "uniform\nlower = -3.0\nupper = 3.0" for name in ("x1", "x2", "x3")},
    "linear": {name: "uniform\nlower = 0.0\nupper = 1.0" for name in ("x1", "x2", "x3", "x4")},
    "exponential-wear": {
        "rate": "lognormal\nmedian = 2.5e-10\nsigma = 1.0",
        "depth": "lognormal\nmedian = 2.5e-4\nsigma = 0.1",
    },
}
THRESHOLDS = {
    "ishigami": "{y = [1.0, 5.0]}",
    "linear": "{y = 5.0}",
    "exponential-wear": "{life = [315576.0, 1e6]}",
}
TOLERANCE = "tolerance = {coverage = 0.95, confidence = 0.95}"
CORRELATED = '[dependence]\nparameters = ["x1", "x2"]\nrank_correlation = [[1, 0.5], [0.5, 1]]'


def small_studies() -> dict[str, str]:
    """Return small studies by name: of every design, and with rows that fail or never end."""
    studies = {
        f"{model}-{name}-small": _study(model, name, 130 if "fast" in name else 64)
        for name, design in DESIGNS.items()
        if not design.imported
        for model in ("ishigami", "exponential-wear")
    }
    failing = "[settings]\nfail_above = "
    return studies | {
        "failed-small": _study("linear", "monte-carlo", 100, failing + "0.95"),
        "failed-groups-small": _study("linear", "saltelli", 16, failing + "0.98"),
        "never-small": _study(
            "exponential-wear", "monte-carlo", 200, "[fixed]\nthreshold = 1e-10", TOLERANCE
        ),
        "correlated-small": _study("linear", "monte-carlo", 200, CORRELATED),
        "correlated-paths-small": _study("linear", "shapley", 64, CORRELATED),
    }


def _study(model: str, design: str, samples: int, more: str = "", analysis: str = "") -> str:
    laws = "\n".join(
        f'[uncertain.{name}]\nsource = "example"\ndistribution = "{law.replace(chr(10), _END, 1)}'
        for name, law in LAWS[model].items()
    )
    methods = json.dumps(fed_by(DESIGNS[design], dependent=more is CORRELATED))
    return f"""
[study]
name = "{model}"
model = "{model}"
[design]
method = "{design}"
samples = {samples}
replicates = {REPLICATES.get(design, 4)}
seed = 7
{more}
{laws}
[analysis]
thresholds = {THRESHOLDS[model]}
max_failed = 1.0
sensitivity = {methods}
{analysis}
"""


_END = '"\n'
