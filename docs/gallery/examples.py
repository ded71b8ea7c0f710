"""The examples of the gallery: what each figure tells, and the lines that draw it."""

from typing import NamedTuple


class Example(NamedTuple):
    """One kind of figure.

    Attributes
    ----------
    name : str
        Key of `uq.plots.FIGURES`, or else a function of `uq.plots`; of its file, too.
    heading, title, says : str
        Under which it stands, what it is called, and how to read it.
    code : str
        Python; the last line is the figure.
    command : str
        The same on the command line; "" if there is no command.
    study : str
        The shipped study whose result it draws.
    """

    name: str
    heading: str
    title: str
    says: str
    code: str
    command: str = ""
    study: str = ""


def _of_result(name: str, heading: str, title: str, says: str, call: str, study: str) -> Example:
    """Return an example that draws a result, which ``uq plot --only`` draws."""
    path = f"results/{study}.nc"
    kind = name.removesuffix("-in-time")
    code = f'import uq\n\nds = uq.open_result("{path}")\nuq.plots.{call}'
    return Example(name, heading, title, says, code, f"uq plot {path} --only {kind}", study)


LIVES, INPUTS = "Lives and other outputs", "Inputs and regimes"
ENOUGH, MOTION, RESPONSE = "Enough rows?", "One motion", "Response of a machine"
LIFE = "first_time_to_depth[depth=0.00025]"

MOVED = """\
import uq

uq.plots.motion(uq.simulate("beam", {"forcing_frequency": 54.797}))"""

RUN_UP = """\
import uq

one = uq.simulate("vibrator").sel(time=slice(0, 3))
uq.plots.history(one, ["disphasing_angle", ["speed_1", "speed_2"]])"""

PORTRAIT = """\
import uq

one = uq.simulate("beam", {"forcing_frequency": 57.1042})
last = one.sel(time=slice(float(one.time[-1]) - 0.2, None))
uq.plots.phase_portrait(last)"""

SECTION = """\
import uq
from models.mole.explore import poincare_section
from models.mole.parameters import Params, Settings

mole, printed = Params(control_frequency=2.5), Settings(formulation="as-printed")
points = poincare_section(mole, printed, periods=1500, dropped=12)
uq.plots.section(points)"""

BRANCH = """\
import uq
from models.beam.explore import continue_orbit
from models.beam.parameters import Params

branch = continue_orbit(Params(forcing_frequency=57.1042), stop=58.0)
uq.plots.curve(branch, "work_rate", against="forcing_frequency")"""

DIAGRAM = """\
import numpy as np

import uq
from models.mole.explore import bifurcation_diagram
from models.mole.parameters import Params, Settings

swept = np.linspace(2.5, 10, 151)
diagram = bifurcation_diagram(swept, Params(), Settings(), dropped=200, kept=40)
uq.plots.bifurcation(diagram, "displacement", by="regime")"""

STARTS = """\
import uq

starts = {
    "initial_displacement": (-0.05, 0.005, 40),
    "initial_velocity": (-2.0, 2.0, 40),
}
found = uq.basins("mole", starts, fixed={"control_frequency": 8.0}, by=["progression_rate"])
uq.plots.basins(found, ["progression_rate"])"""

RECORD = """\
import numpy as np

import uq

rng = np.random.default_rng(1)  # in place of a record: 200 screens that tear or wear
torn, worn = rng.exponential(3000, 200), 2000 * rng.weibull(2, 200)
end = rng.uniform(500, 3000, 200)
life = np.minimum(np.minimum(torn, worn), end)
cause = np.select([life == end, torn < worn], ["", "torn"], "worn")
table = np.column_stack([life, life == end, cause])
head = "life [h],running,cause"
np.savetxt("screens.csv", table, "%s", ",", header=head, comments="")
ds = uq.import_lives("screens.csv", "life", censored="running", cause="cause")
"""

BESIDE = """\
from uq.assess.comparison import comparison
from uq.result.result import Result

others = np.column_stack([1.3 * life, life == end])
np.savetxt("others.csv", others, "%s", ",", header="life [h],running", comments="")
second = uq.import_lives("others.csv", "life", censored="running")
uq.plots.compared_lives(comparison(Result(ds), Result(second)))"""

EXAMPLES = (
    _of_result(
        "lifetime",
        LIVES,
        "The share that has ended, against time",
        "The line is the estimate; the bands are the pointwise and the simultaneous 95 % interval."
        " Points mark B1, B10 and B50, with their intervals; labels above the frame name the bound"
        " and the time that the study asks about. A life whose scale is assumed is no prediction.",
        'lifetime(ds, "first_time_to_depth")',
        "beam-lifetime",
    ),
    _of_result(
        "events",
        LIVES,
        "The probability of an event over its main driver",
        "Steps are slices of equally many rows, with 95 % intervals; dashed is the probability over"
        " all rows.",
        f'event_probability(ds, "P({LIFE}<86400.0)")',
        "beam-lifetime",
    ),
    Example(
        "incidence",
        LIVES,
        "Which cause ends a life, and when",
        "The probability that each cause has ended the life, stacked: the upper edge is the"
        " probability that the life has ended. Bands are pointwise 95 % intervals.",
        RECORD + 'uq.plots.incidence(ds, "life")',
        "uq plot screens.nc --only incidence",
    ),
    Example(
        "paper",
        LIVES,
        "A lifetime on probability paper",
        "Where the fitted law is a straight line: points are the rows, with pointwise 95 %"
        " intervals.",
        RECORD + 'uq.plots.probability_paper(ds, "life", law="weibull")',
        "uq plot screens.nc --only paper",
    ),
    Example(
        "compared-lives",
        LIVES,
        "Lives from the field beside others",
        "Both survival curves with their pointwise 95 % intervals, and their difference below.",
        RECORD + BESIDE,
        "uq compare screens.nc results/exponential-wear.nc --plot both.png",
    ),
    _of_result(
        "histogram",
        LIVES,
        "The distribution of an output",
        "Outputs other than lives, as a probability density: the area of a bar is the share of its"
        " rows. Lines mark the thresholds of the study.",
        'histogram(ds, "disphasing_angle")',
        "vibrator-tolerances",
    ),
    _of_result(
        "regimes",
        LIVES,
        "A distribution by regime",
        "The same rows, stacked by the kind of motion into which they settled: what looks like one"
        " distribution may be two.",
        f'histogram_by_regime(ds, "{LIFE}")',
        "beam-lifetime",
    ),
    _of_result(
        "scatter",
        INPUTS,
        "An output against its most influential inputs",
        "Every row, with the median in slices of the input and its 95 % band, by regime where there"
        " are several.",
        f'scatter(ds, "{LIFE}")',
        "beam-lifetime",
    ),
    _of_result(
        "indices",
        INPUTS,
        "Sensitivity indices",
        "How much of the variance each input explains by itself, and with its interactions. Inputs"
        " with a negligible index are counted below.",
        f'index_bars(ds, "log({LIFE})", method="sobol")',
        "beam-sensitivity",
    ),
    _of_result(
        "shares",
        INPUTS,
        "The shares of a category",
        "How many rows are in each regime, with 95 % intervals; any other category is drawn alike.",
        'shares(ds, "regime")',
        "beam-lifetime",
    ),
    _of_result(
        "index-curves",
        INPUTS,
        "Sensitivity indices along a curve",
        "The index of each depth, with its band; in the legend, that of all depths together.",
        'index_curves(ds, "first_time_to_depth")',
        "beam-depths",
    ),
    _of_result(
        "index-curves-in-time",
        INPUTS,
        "Sensitivity indices over time",
        "What shapes the speed of a motor from instant to instant of its run-up: first its own"
        " torque and inertia; once the motors have locked, either torque.",
        'index_curves(ds, "run_up_speed_1")',
        "vibrator-run-up",
    ),
    _of_result(
        "regime-shares",
        INPUTS,
        "The share of each regime over the inputs that separate them",
        "Slices of equally many rows: where a colour widens, the input decides the regime.",
        "regime_shares(ds)",
        "beam-lifetime",
    ),
    _of_result(
        "pairs",
        INPUTS,
        "Regimes over the inputs that separate them",
        "Each row is a point; its colour is the regime.",
        "pairs(ds)",
        "beam-lifetime",
    ),
    _of_result(
        "inputs",
        INPUTS,
        "Stated laws and sampled values",
        "A check of the study: the line is the law as stated, the bars are the rows.",
        "inputs(ds)",
        "beam-lifetime",
    ),
    _of_result(
        "convergence",
        ENOUGH,
        "An estimate against the number of rows",
        "Twice as many rows from point to point. Where the band no longer moves beyond its own"
        " width, there are enough.",
        f'convergence(ds, "{LIFE}")',
        "beam-lifetime",
    ),
    _of_result(
        "convergence-indices",
        ENOUGH,
        "Total indices against the number of rows",
        "The same for Sobol' indices, which need more rows than a mean.",
        f'index_convergence(ds, "log({LIFE})")',
        "beam-sensitivity",
    ),
    Example(
        "motion",
        MOTION,
        "One run, and its last periods",
        "What a row computes: the whole run on the left, the settled motion on the right; stops are"
        " dashed.",
        MOVED,
        "uq simulate beam --set forcing_frequency=54.797 --plot beam.png",
    ),
    Example(
        "history",
        MOTION,
        "Chosen quantities against time",
        "Quantities of one unit may share a panel: the run-up of the vibrator.",
        RUN_UP,
    ),
    Example(
        "phase_portrait",
        MOTION,
        "A phase portrait",
        "One quantity of a motion against another. With `section=...`, the points of a Poincaré"
        " section are added.",
        PORTRAIT,
    ),
    Example(
        "section",
        MOTION,
        "A Poincaré section",
        "The state of the mole each time its relay closes. At 2.5 Hz, with the equations as the"
        " paper printed them, the motion is chaotic.",
        SECTION,
    ),
    Example(
        "curve",
        RESPONSE,
        "One quantity against another",
        "Here the work-rates at both stops along a branch of asymmetric orbits, followed over the"
        " forcing frequency to where it ends.",
        BRANCH,
    ),
    Example(
        "bifurcation",
        RESPONSE,
        "A bifurcation diagram",
        "All values that a quantity takes at each value of a parameter: one point where the motion"
        " repeats, many where it does not.",
        DIAGRAM,
    ),
    Example(
        "basins",
        RESPONSE,
        "Basins of attraction",
        "Which start leads to which motion, and the share of the starts that does.",
        STARTS,
    ),
)
