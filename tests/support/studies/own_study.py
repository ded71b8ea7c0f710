"""A study of a machine of one's own, of which one parameter is uncertain."""

_TEXT = """
[study]
name = "own"
model = "{model}"
[design]
method = "monte-carlo"
samples = {samples}
seed = 1
[uncertain.{name}]
distribution = "uniform"
lower = {lower}
upper = {upper}
source = "assumed"
"""


def own_study(model, name="x1", lower=0.0, upper=1.0, samples=20):
    return _TEXT.format(model=model, name=name, lower=lower, upper=upper, samples=samples)
