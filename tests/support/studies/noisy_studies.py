"""Studies of models whose rows depend on their seed."""

from computed import UNIFORM, study_of


def noisy(method="saltelli", samples=64, replicates=8, model="NOISY", fixed=None, **design):
    inputs = dict.fromkeys(("x1", "x2"), UNIFORM)
    return study_of(
        {
            "study": {"name": "noisy", "model": "linear"},
            "design": {"method": method, "samples": samples, "replicates": replicates} | design,
            "uncertain": {name: law for name, law in inputs.items() if name not in (fixed or {})},
            "fixed": fixed or {},
        },
        f"sample_models:{model}",
    )
