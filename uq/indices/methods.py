"""Registry of the sensitivity methods, and the methods that each design supports.

To add a method, write a file with its estimator and add an entry here. Study files then accept it
for designs that support it; tables, JSON, figures, reports and documentation show its indices.
"""

from collections.abc import Mapping
from functools import partial

from uq.indices.expansions import EXPLAINED, chaos_indices, fast_indices, hdmr_indices
from uq.indices.first_order import first_order_indices
from uq.indices.given_data import (
    HSIC,
    MIN_ROWS,
    MOST_ROWS,
    P,
    beside_nulls,
    conditional_indices,
    one_kind,
    quantile_indices,
    target_indices,
    without_optimism,
)
from uq.indices.groups import MIN_TRAJECTORIES, MU, MU_STAR, SIGMA, morris_indices
from uq.indices.index import S1, S2, SHAPLEY, ST, IndexKind
from uq.indices.measures import delta, first_order, ks_distances, pawn
from uq.indices.method import DesignSample, SensitivityMethod
from uq.indices.shapley import MIN_PATHS, shapley_indices
from uq.indices.sobol import MIN_GROUPS, pilot, sobol_indices
from uq.sampling.designs import CROSSED, CURVES, DESIGNS, PATHS, PLAIN, TRAJECTORIES, Design
from uq.stats.estimate import Estimate

DELTA = IndexKind("delta", "Borgonovo's delta")
PAWN = IndexKind("pawn", "PAWN, median")
KS = IndexKind("KS", "Kolmogorov's distance of the rows where it happens")

_AT_ONE_SEED = "shares of the variance at one seed, excluding noise independent of the inputs"

_of_plain_rows = partial(SensitivityMethod, layout=PLAIN, has_null=True, least=MIN_ROWS)
_of_any_inputs = partial(_of_plain_rows, assumes_independence=False)

METHODS = {
    "first-order": SensitivityMethod(
        "share of the variance, alone",
        PLAIN,
        first_order_indices,
        (S1,),
        source="difference-based residual variance in the order of the input (Tong & Wang 2005)",
        intervals="influence of each row; none where few rows decide",
        least=MIN_ROWS,
        aggregates=True,
    ),
    "rbd-fast": _of_plain_rows(
        "share of the variance, alone, in smooth functions",
        estimate=beside_nulls(one_kind(S1, first_order)),
        kinds=(S1,),
        source="random balance, bias corrected; correlation ratio of inputs with many equal values",
        aggregates=True,
    ),
    "delta": _of_any_inputs(
        "shift of the entire distribution",
        estimate=beside_nulls(one_kind(DELTA, delta)),
        kinds=(DELTA,),
        source="Plischke et al. (2013), on normal scores of the output",
        most_rows=10_000,
        takes_events=False,  # they have no density
        scale_free=True,
    ),
    "pawn": _of_any_inputs(
        "largest shift of the distribution",
        estimate=beside_nulls(one_kind(PAWN, pawn)),
        kinds=(PAWN,),
        source="Pianosi & Wagener (2018)",
        most_rows=20_000,
        scale_free=True,
    ),
    "hdmr": _of_plain_rows(
        "share of the variance, alone, in pairs and in total",
        estimate=hdmr_indices,
        kinds=(S1, ST, SHAPLEY, S2),
        source="polynomials in one and in two inputs (Li et al. 2010); refused where they explain"
        f" less than {100 * EXPLAINED:g} % of rows held out",
    ),
    "chaos": SensitivityMethod(
        "share of the variance, alone, in pairs and in total, from few rows of a smooth output",
        PLAIN,
        chaos_indices,
        (S1, ST, SHAPLEY, S2),
        source="sparse polynomial chaos (Sudret 2008) by OpenTURNS, corrected by rows left out",
        intervals="Student's t of rows left out, and the share that is not explained",
        least=MIN_ROWS,
        most_rows=1000,
    ),
    "quantile": _of_any_inputs(
        "which inputs move a quantile, or B10 of a life",
        estimate=beside_nulls(quantile_indices, without_optimism),
        kinds=(),
        gives="share of a quantile's contrast that an input explains",
        source="Fort et al. (2016), corrected by inputs without effect",
        takes_events=False,
    ),
    "regional": _of_any_inputs(
        "which inputs decide a regime or an event",
        estimate=beside_nulls(one_kind(KS, ks_distances)),
        kinds=(KS,),
        source="Spear & Hornberger (1980)",
        takes_numbers=False,
        scale_free=True,
    ),
    "hsic-target": _of_any_inputs(
        "which inputs decide a regime or an event, with p-values",
        estimate=target_indices,
        kinds=(P, HSIC),
        source="Marrel & Chabridon (2021), by OpenTURNS",
        most_rows=MOST_ROWS,
        takes_numbers=False,
        scale_free=True,
    ),
    "hsic-conditional": _of_any_inputs(
        "which inputs matter for an output given that an event of it happens",
        estimate=conditional_indices,
        kinds=(P, HSIC),
        source="Marrel & Chabridon (2021), by OpenTURNS",
        most_rows=MOST_ROWS,
        takes_numbers=False,
        conditional=True,
        scale_free=True,
    ),
    "sobol": SensitivityMethod(
        "share of the variance, alone and with others",
        CROSSED,
        sobol_indices,
        (S1, ST, S2),
        source="Janon et al. (2014) with a control variate (S1), Jansen (1999) (ST), Saltelli"
        " (2002) (S2), on standardised outputs",
        intervals="Student's t from replicates",
        least=MIN_GROUPS,
        aggregates=True,
        noise="the model is random, and the rows of a group share a seed: S1 excludes noise, ST"
        " includes its interaction with the input, and 'noise' is the share of the variance that"
        " remains once all inputs are known",
        pilot=pilot,
    ),
    "morris": SensitivityMethod(
        "which inputs have any effect",
        TRAJECTORIES,
        morris_indices,
        (MU, SIGMA, MU_STAR),
        source="Campolongo et al. (2007)",
        intervals="Student's t from replicates",
        least=MIN_TRAJECTORIES,
        noise="the model is random, and the rows of a trajectory share a seed: no effect is noise",
    ),
    "shapley": SensitivityMethod(
        "shares of the variance that sum to one",
        PATHS,
        shapley_indices,
        (SHAPLEY,),
        source="Goda (2021), Song, Nelson & Staum (2016); polynomials as control variate",
        intervals="Student's t of independent paths",
        least=MIN_PATHS,
        assumes_independence=False,
        aggregates=True,
        noise=f"the model is random, and the rows of a path share a seed: {_AT_ONE_SEED}",
    ),
    "fast": SensitivityMethod(
        "share of the variance, alone and with others, without intervals",
        CURVES,
        fast_indices,
        (S1, ST),
        source="extended FAST, Saltelli et al. (1999)",
        least=0,  # it requires a complete curve of each input
        aggregates=True,
        noise=f"the model is random, and the points of a curve share a seed: {_AT_ONE_SEED}",
    ),
}
"""Methods in the order of listings; the default of a design is the first that it supports."""


def indices_of(method: str, kind: str, sample: DesignSample) -> Mapping[str, Estimate]:
    """Return the estimated indices of one kind: input -> index.

    Parameters
    ----------
    method : str
    kind : str
        Key of the kind of index.
    sample : DesignSample
        Rows grouped as the method requires.
    """
    by_kind = METHODS[method].indices(sample).values.items()
    return next(indices for index_kind, indices in by_kind if index_kind.key == kind)


def fed_by(design: Design, dependent: bool = False) -> tuple[str, ...]:
    """Return the methods that a design supports.

    Parameters
    ----------
    design : Design
    dependent : bool, optional
        Whether the inputs depend on each other.

    Returns
    -------
    tuple of str
    """
    return tuple(
        name
        for name, method in METHODS.items()
        if method.layout is design.layout and not (dependent and method.assumes_independence)
    )


def piloted_by(design: Design) -> str | None:
    """Return the method with a pilot for a design; None if there is none."""
    return next((name for name in fed_by(design) if METHODS[name].pilot), None)


def designs_for(method: str) -> tuple[str, ...]:
    """Return the designs that support a method; empty if the method does not exist."""
    return tuple(name for name, design in DESIGNS.items() if method in fed_by(design))


def for_dependent_inputs() -> tuple[str, ...]:
    """Return the methods that do not assume independent inputs."""
    return tuple(name for name, method in METHODS.items() if not method.assumes_independence)


def kinds_with_intervals(design: Design) -> dict[str, tuple[IndexKind, str]]:
    """Return the indices of single inputs with intervals from groups: key -> kind and method.

    Indices of a plain sample are excluded: a run with `until` can forecast only means over groups.
    """
    kinds: dict[str, tuple[IndexKind, str]] = {}
    for name in fed_by(design):
        method = METHODS[name]
        for kind in method.kinds if method.intervals and method.layout is not PLAIN else ():
            if not kind.of_pairs:
                kinds.setdefault(kind.key, (kind, name))
    return kinds
