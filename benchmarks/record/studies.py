"""The studies that are recorded."""

import json
from pathlib import Path

SHIPPED = Path("studies")
SAMPLES = {  # of each replicate
    "beam-basins": 16,
    "beam-depths": 2,
    "beam-lifetime-561": 8,
    "beam-outcome": 8,
    "beam-plant": 2,
    "beam-random-load": 4,
    "beam-sensitivity": 2,
    "beam-worn-depth": 2,
    "exponential-wear": 1000,
    "mole-best-frequency": 16,
    "mole-circuit": 4,
    "mole-frequency": 16,
    "mole-outcome": 16,
    "mole-progression": 100,
    "mole-refused": 8,
    "mole-ten-metres": 16,
    "screen-inspection": 64,
    "tube-antivibration-bar": 2,
    "vibrator-feed": 16,
    "vibrator-run-up": 4,
    "vibrator-startup": 32,
    "vibrator-supports": 4,
    "vibrator-tolerances": 200,
}
ANY = 64

DEPENDENT = ("delta", "pawn", "quantile", "regional", "hsic-target", "hsic-conditional")
PLAIN = ("first-order", "rbd-fast", "hdmr", *DEPENDENT)
METHODS = {
    "monte-carlo": PLAIN,
    "latin-hypercube": PLAIN,
    "sobol": PLAIN,
    "halton": PLAIN,
    "saltelli": ("sobol",),
    "morris": ("morris",),
    "morris-optimised": ("morris",),
    "shapley": ("shapley",),
    "fast": ("fast",),
    "rbd-fast": PLAIN,
    "imported": DEPENDENT,
}
"""Of each design, the sensitivity methods."""

REPLICATES = {"monte-carlo": 1, "imported": 1, "fast": 2}
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
BY_CLAYTON = f'{CORRELATED}\ncopula = "clayton"'
ON_LEVELS = {
    "x1": LAWS["linear"]["x1"] + '\nlevel = "shared"',
    "x2": LAWS["linear"]["x2"],
    "x3": LAWS["linear"]["x3"] + '\nlevel = "chance"',
}
SHARED_RATE = {
    "rate": LAWS["exponential-wear"]["rate"] + '\nlevel = "shared"',
    "depth": LAWS["exponential-wear"]["depth"],
}
OF_EVERY_KIND = {
    "x1": "normal\nmean = 0.5\nsd = 0.1\ntruncate = [0.3, 0.8]",
    "x2": "triangular\nlower = 0.0\nmode = 0.4\nupper = 1.0",
    "x3": "discrete-choice\nvalues = [0.1, 0.5, 0.9]\nweights = [2.0, 5.0, 3.0]",
    "x4": 'uniform\nlower = 0.2\nupper = 0.4\ntimes = "x2"',
}
INSPECTIONS = """unit,output,kind,value,cv,time
A,life,measured,8e5,0.1,
B,life,survived,,,5e5
"""
LEARNT = {
    "posterior-small": ("fleet-small", "inspections.csv"),
    "posterior-plain-small": ("lives-small", "single.csv"),
}
"""Posteriors: their prior results and inspections."""

ROWS = "rows.csv"


def files() -> dict[str, str]:
    """Return the files that small studies and commands need, by name."""
    rows = (f"{(i * 0.6180339887) % 1},{(i * 0.7548776662) % 1}" for i in range(1, 61))
    return {
        ROWS: "\n".join(["x1,x2", *rows, ""]),
        "inspections.csv": INSPECTIONS,
        "single.csv": "unit,output,kind,value,cv\nA,life,measured,8e5,0.1\n",
        "more.csv": "unit,output,kind,value,cv\nC,life,measured,1.1e6,0.2\n",
        "misspelt.csv": "unit,output,kind,value,cv\nA,lief,measured,8e5,0.1\n",
        "broken.toml": "[study\n",
        "misspelt.toml": _study("linear", "monte-carlo", 64).replace(
            "uncertain.x1", "uncertain.y1"
        ),
        "odd.toml": _study("linear", "saltelli", 16).replace("samples = 16", "samples = 17"),
    }


def small_studies() -> dict[str, str]:
    """Return small studies by name: of every design, with rows that fail or never end, levels."""
    studies = {
        f"{model}-{design}-small": _study(model, design, 130 if "fast" in design else 64)
        for design in METHODS
        if design != "imported"
        for model in ("ishigami", "exponential-wear")
    }
    failing = "[settings]\nfail_above = "
    levels = "units = 3\nrepeats = 2"
    return studies | {
        "failed-small": _study("linear", "monte-carlo", 100, failing + "0.95"),
        "failed-groups-small": _study("linear", "saltelli", 16, failing + "0.98"),
        "never-small": _study(
            "exponential-wear", "monte-carlo", 200, "[fixed]\nthreshold = 1e-10", TOLERANCE
        ),
        "lives-small": _study(
            "exponential-wear",
            "monte-carlo",
            200,
            analysis=f'{TOLERANCE}\njoint_bounds.life = "both"',
        ),
        "correlated-small": _study("linear", "monte-carlo", 200, CORRELATED),
        "correlated-paths-small": _study("linear", "shapley", 64, CORRELATED),
        "copula-small": _study("linear", "monte-carlo", 200, BY_CLAYTON),
        "copula-paths-small": _study("linear", "shapley", 64, BY_CLAYTON),
        "laws-small": _study("linear", "monte-carlo", 200, laws=OF_EVERY_KIND),
        "until-small": _study(
            "linear",
            "monte-carlo",
            4096,
            design='until = {output = "y", above = 5.0, half_width = 0.05}',
        ),
        "imported-small": _study(
            "linear",
            "imported",
            60,
            design=f'file = "{ROWS}"',
            laws={name: LAWS["linear"][name] for name in ("x1", "x2")},
        ),
        "levels-small": _study("linear", "monte-carlo", 40, design=levels, laws=ON_LEVELS),
        "levels-sobol-small": _study("linear", "sobol", 16, design=levels, laws=ON_LEVELS),
        "fleet-small": _study(
            "exponential-wear", "monte-carlo", 200, design="units = 3", laws=SHARED_RATE
        ),
    }


def _study(
    model: str,
    method: str,
    samples: int,
    more: str = "",
    analysis: str = "",
    design: str = "",
    laws: dict[str, str] | None = None,
) -> str:
    tables = "\n".join(
        f'[uncertain.{name}]\nsource = "example"\ndistribution = "{law.replace(chr(10), _END, 1)}'
        for name, law in (laws or LAWS[model]).items()
    )
    methods = json.dumps(
        DEPENDENT if "[dependence]" in more and method != "shapley" else METHODS[method]
    )
    replicates = "" if method == "imported" else f"replicates = {REPLICATES.get(method, 4)}"
    seed = "" if method == "imported" else "seed = 7"
    return f"""
[study]
name = "{model}"
model = "{model}"
[design]
method = "{method}"
samples = {samples}
{replicates}
{seed}
{design}
{more}
{tables}
[analysis]
thresholds = {THRESHOLDS[model]}
max_failed = 1.0
sensitivity = {methods}
{analysis}
"""


_END = '"\n'
