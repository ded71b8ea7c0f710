"""The chapters of the page, and which problems stand in each."""

import re

CHAPTERS = {
    "Plain statistics of independent rows": (
        r"(Ishigami|Two regimes|Heavy-tailed life), \d+ independent rows$"
    ),
    "Plain statistics of other designs": (
        r"(Ishigami|Two regimes|Heavy-tailed life), [a-z-]+, \d+ replicates of \d+ rows"
        r"|Even replicates"
    ),
    "Means with heavy tails, and standard deviations": (
        r"(Pareto|Lognormal|Normal|Uniform|Exponential), "
    ),
    "Lives that never end or are censored": (
        r"(Life (that may never end|censored)|60 % never end)(?!.*groups)"
    ),
    "Laws fitted to lives": r"(Weibull|Lognormal|Gamma) life, (60 indep|shape)|Life with .* infant",
    "Lives from the field": r"Recorded",
    "Bands for the entire curve of a life": r"Weibull life, ",
    "Few hits, and failed rows": (
        r"A share of few hits|Event of|Two regimes, one|\d+ independent rows, .* fail"
    ),
    "Sobol' indices": (
        r"(Ishigami|Two regimes|G-function|Life that may never end), saltelli, .* groups"
    ),
    "Shares that inputs explain alone": r"First-order",
    "Shapley effects": r"Ishigami, shapley",
    "Indices of all elements of an output": r"A front|Worn depth",
    "Shapley effects of dependent inputs": r"Dependent inputs",
    "Random models": r"Random model",
    "Shares of levels": r"Random effects",
    "Screening, and indices without intervals": (
        r"Ishigami, morris|Input without effect|Ishigami, .*no interval"
    ),
    "Average effects": r"Average effects",
    "Differences of two studies": r"(Linear|Lognormal) function",
    "Joint bounds": r"Joint",
    "Two fidelities": r".*cheap twin",
    "Runs that stop early": r"Runs that stop",
    "Rare events": r"P = \d|Subset simulation",
    "Lives scaled by an input": r"Life scaled",
    "What-if": r"What if",
    "Fleets": r"Fleet",
    "Intermingled regimes": r"Basins",
}
"""Title -> how the names of its problems begin; the first that fits counts."""

OTHERS = "Others"


def chapter_of(problem):
    """Return the chapter of a problem."""
    named = f"{problem[0].upper()}{problem[1:]}"
    return next((title for title, start in CHAPTERS.items() if re.match(start, named)), OTHERS)
