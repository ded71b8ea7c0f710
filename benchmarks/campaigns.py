"""Synthetic campaigns on the beam: 20 rods, two outages, a detection limit; what learning takes.

``python -m benchmarks.campaigns``. The rows are computed once, and none for a campaign.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import uq
from uq.learning.inspections import Inspection, InspectionKind
from uq.learning.observables import WornDepths
from uq.learning.posterior import posterior
from uq.result.result import Result
from uq.text.literals import read_toml, toml

RODS, WORLDS, CV, LIMIT, MOST = 20, 300, 0.15, 3e-5, 1.5e-4
CAMPAIGNS, SECONDS = 20, 5.0
STUDY = Path(__file__).parents[1] / "studies" / "beam-lifetime.toml"


def worlds(folder):
    """Return the shipped study with a shared wear coefficient and 20 rods in each sample."""
    tables = read_toml(STUDY.read_text())
    tables["design"] = {"method": "monte-carlo", "samples": WORLDS, "units": RODS, "seed": 2026}
    tables["uncertain"]["wear_coefficient"]["level"] = "shared"
    tables["settings"] = {"depths": [3e-5, 6e-5, 1e-4, 1.5e-4, 2.5e-4], "accuracy": 0.05}
    tables["analysis"] = {"outputs": ["first_time_to_depth"]}
    path = Path(folder) / "rods.toml"
    path.write_text("\n".join(f"{name} = {toml(value)}" for name, value in tables.items()))
    return uq.run(path, Path(folder) / "rods.nc")


def apart(rows, number):
    """Return the rods of one world, which is the truth, and the rows of all others."""
    in_world = rows["world"].values == number
    return rows.isel(row=in_world), rows.isel(row=~in_world)


def campaign(truth, rng):
    """Return the inspections of the rods of a world in two outages, and the time of the last."""
    lives = truth["first_time_to_depth"].values
    worn = WornDepths(truth["depth"].values, lives)
    median = np.median(lives[:, 2])
    times = 0.4 * median, 0.9 * median
    error = np.log1p(CV**2) ** 0.5
    inspections = []
    for at in times:
        depth = worn.at(np.full((RODS, 1), at))[:, 0] * np.exp(error * rng.standard_normal(RODS))
        for rod, seen in enumerate(depth):
            if seen < LIMIT:
                inspections.append(
                    Inspection(f"{rod}", "depth", InspectionKind.BELOW, at, LIMIT, cv=CV)
                )
            elif seen > MOST:
                inspections.append(
                    Inspection(f"{rod}", "depth", InspectionKind.ABOVE, at, MOST, cv=CV)
                )
            else:
                inspections.append(
                    Inspection(f"{rod}", "depth", InspectionKind.MEASURED, at, float(seen), cv=CV)
                )
    return inspections, times[-1]


def main():
    """Learn from some campaigns, and print the time of each."""
    with tempfile.TemporaryDirectory() as folder:
        rows, rng, taken = worlds(folder), np.random.default_rng(1), []
        for number in np.unique(rows["world"].values)[:CAMPAIGNS]:
            truth, others = apart(rows, number)
            inspections, _ = campaign(truth, rng)
            began = time.process_time()
            posterior(Result(others), inspections)
            taken.append(time.process_time() - began)
    longest = max(taken)
    print(
        f"{len(taken)} campaigns of {2 * RODS} inspections, {others.sizes['row']:,} rows:"
        f" {np.median(taken):.2f} s of CPU each, {longest:.2f} s at most (goal {SECONDS:g} s)"
    )
    return 0 if longest <= SECONDS else "too slow"


if __name__ == "__main__":
    sys.exit(main())
