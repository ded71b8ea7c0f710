"""Commands that are recorded, of each result and of some."""

import re
import shlex
from collections.abc import Iterator

SET = "--set uncertain.rate.sigma=0.8"
OF_LIVES = (
    "summary --plain",
    f"what-if {SET}",
    "what-if --set uncertain.rate.median=3e-10 --set uncertain.depth.sigma=0.08",
    "fleet --size 10",
    "fleet --size 20 --by '2 days' --allow 1",
    "levels",
    "row 3",
    "row --lowest life",
    "row --near-quantile 0.1 life",
)
OF_WEIGHTED_LIVES = ("summary --plain", "fleet --size 10", "levels", "row 3", "verify")
OF_FUNCTIONS = ("levels", "row 3", "row --near-quantile 0.5 y", "verify")
ON_LEVELS = ("levels", "levels --plain", "levels --output y", "sensitivity --output y", "row 7")

CHOSEN: dict[str, tuple[str, ...]] = {
    "exponential-wear": (
        *OF_LIVES,
        "update single.csv -o posterior.nc",
        "update single.csv -o posterior.nc --by 1e6 --model-error 0.2",
        "verify",
    ),
    "exponential-wear-sobol-small": OF_LIVES,
    "lives-small": (*OF_LIVES, "trace outputs/life/tolerance/lower"),
    "never-small": OF_LIVES,
    "ishigami-saltelli-small": (
        *OF_FUNCTIONS,
        "what-if --set uncertain.x1.lower=-2.5",
        "sensitivity --output y",
        "trace sensitivity/outputs/y/ST/x1",
    ),
    "ishigami-monte-carlo-small": (
        *OF_FUNCTIONS,
        "what-if --set uncertain.x1.lower=-2.5",
        "what-if --set uncertain.x1.lower=-2.5 --set uncertain.x2.upper=1.0",
        "sensitivity --output 'log(y)'",
        "sensitivity --output 'rank(y)'",
        "trace outputs/y/mean",
        "trace sensitivity[method=delta]/outputs/y/delta/x1",
    ),
    "correlated-small": (
        *OF_FUNCTIONS,
        "what-if --set uncertain.x1.upper=0.9",
        "what-if --set dependence.rank_correlation=[[1,0.3],[0.3,1]]",
    ),
    "laws-small": (*OF_FUNCTIONS, "what-if --set uncertain.x1.sd=0.08"),
    "failed-small": (*OF_FUNCTIONS, "what-if --set uncertain.x2.upper=0.9"),
    "failed-groups-small": OF_FUNCTIONS,
    "until-small": OF_FUNCTIONS,
    "imported-small": OF_FUNCTIONS,
    "levels-small": (
        *ON_LEVELS,
        "what-if --set uncertain.x1.upper=0.9",
        "trace levels/outputs/y/own",
    ),
    "levels-sobol-small": ON_LEVELS,
    "fleet-small": (
        *OF_LIVES,
        "update inspections.csv -o posterior.nc --by 1e6",
        "next-inspection --inspect life",
    ),
    "posterior-small": (
        *OF_WEIGHTED_LIVES,
        "update more.csv -o posterior.nc",
        "next-inspection --inspect life --units 5 --cv 0.2",
        "trace outputs/life/quantiles/0.5",
    ),
    "posterior-plain-small": (*OF_WEIGHTED_LIVES, "fleet --size 10 --by 5e5"),
    "beam-lifetime": ("levels", "row 0", "fleet --size 100"),
    "mole-basins": ("levels", "row 0", "summary --regime period-1"),
    "vibrator-tolerances": ("twin", "row 0", "what-if --set uncertain.unbalance_1.sd=0.04"),
    "beam-outcome": ("levels", "row 0"),
    "mole-outcome": ("levels",),
}
WITHOUT_JSON = ("verify",)

NUMBERS = {"": "summary", "sensitivity": "sensitivity", "convergence": "convergence"}
TRACED = {
    "lives-small": NUMBERS
    | {
        "levels": "levels",
        "fleet[size=1]": "fleet --size 1",
        "what-if[uncertain.rate.sigma=0.8]": f"what-if {SET}",
    },
    "ishigami-saltelli-small": NUMBERS | {"levels": "levels"},
}
"""Results whose numbers are all traced: prefix of the key -> command that prints the number."""


DRAWN = ("lives-small", "beam-depths", "mole-basins")
"""Results whose figures are recorded; pages hold most of them as well."""

EVERY_METHOD = ("lives-small", "ishigami-monte-carlo-small", "correlated-small")
ONE_OF_MANY = re.compile("(ishigami|exponential-wear)-.*-small")
WITHOUT_PAGE = re.compile(
    "ishigami-.*-small|exponential-wear-(halton|latin-hypercube|monte-carlo|rbd-fast|sobol)-small"
    "|beam-(basins|lifetime-561|random-load|sensitivity|worn-depth)"
    "|mole-(circuit|frequency|outcome|progression)|vibrator-(feed|run-up|startup|supports)"
)


def _is_minor(name: str) -> bool:
    return bool(ONE_OF_MANY.fullmatch(name)) and name not in CHOSEN


def has_page(name: str) -> bool:
    """Whether the page of a result is recorded: of one of its kind."""
    return name in DRAWN or name in TRACED or not WITHOUT_PAGE.fullmatch(name)


def commands_of(name: str, methods: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield the commands that are recorded of a result, each without its file."""
    yield from (("status",), ("convergence",), ("sensitivity",))
    yield ("summary",) if _is_minor(name) else ("summary", "--fits")
    if name in EVERY_METHOD:
        yield from (("sensitivity", "--method", method) for method in methods)
    yield from (tuple(shlex.split(command)) for command in CHOSEN.get(name, ()))


def endings_of(name: str, verb: str) -> tuple[tuple[str, ...], ...]:
    """Return the options that choose text and JSON."""
    if verb in WITHOUT_JSON:
        return ((),)
    return (("--json",),) if _is_minor(name) else ((), ("--json",))
