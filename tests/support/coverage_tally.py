"""Studies computed again and again, and how often their intervals hold the truth."""

import numpy as np
from computed import computed, study_of, with_seed
from scipy import stats

REPETITIONS = 200


class Tally:
    """How often each interval was given, and how often it held the truth."""

    def __init__(self, title):
        self.title = title
        self.held = {}

    def add(self, name, truth, low, high):
        """Count one interval; one that was not given has None."""
        has_interval = low is not None and high is not None
        self.held.setdefault(name, []).append(low <= truth <= high if has_interval else None)

    def check(self, conservative=()):
        """Print the table and fail where a coverage is off.

        Conservative intervals may hold always, and be given less often.
        """
        wrong = []
        for name, held in self.held.items():
            given = [is_covered for is_covered in held if is_covered is not None]
            line = f"{self.title:40} {name:26} {np.mean(given):6.1%} of {len(given)}"
            print(line)
            most, least_given = (1.0, 0.8) if name in conservative else (0.99, 0.95)
            if not 0.90 <= np.mean(given) <= most or len(given) < least_given * REPETITIONS:
                wrong.append(line)
        assert not wrong, "\n".join(wrong)


def repeat(model, design, inputs, second_order=False, repetitions=REPETITIONS, **tables):
    """Yield the results of a study under different seeds."""
    method, samples, replicates = design
    table = {"method": method, "samples": samples, "replicates": replicates}
    study = study_of(
        {
            "study": {"name": "coverage", "model": model},
            "design": table | {"second_order": second_order},
            "uncertain": inputs,
            **tables,
        }
    )
    for seed in range(repetitions):
        yield computed(with_seed(study, seed))


def title(model, design):
    method, samples, replicates = design
    return f"{model}, {method} {replicates} x {samples}"


# Lifetimes of a part with a lognormal rate of wear and depth

DEPTH, RATE, SIGMA, SPREAD = 2.5e-4, 2.5e-10, 0.5, 0.2
LIMIT = 8e5
LIFE = stats.lognorm(s=np.hypot(SIGMA, SPREAD), scale=DEPTH / RATE)
WEAR = {
    "rate": {"distribution": "lognormal", "median": RATE, "sigma": SIGMA},
    "depth": {"distribution": "lognormal", "median": DEPTH, "sigma": SPREAD},
}
