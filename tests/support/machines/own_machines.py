"""Machines from outside for the tests: a function, a program, and how studies of them are run."""

from pathlib import Path

from own_study import own_study

import uq as package

WEAR = '''
import math
from typing import Annotated
import uq

@uq.machine
def wear(load: Annotated[float, "N", (0.0, 10.0), "force on the pad"] = 1.0, depth: float = 3.0):
    """Wear of a pad."""
    if load > 1.9:
        raise ValueError("too heavy")
    life = math.inf if load < 0.1 else uq.censored(20.0) if load < 0.2 else depth / load
    return {"life": life, "profile": [load, 2 * load]}
'''

WEAR_STUDY = own_study("wear", "load", upper=2.0, samples=100)

PAD = """
[machine]
name = "pad"
command = ["./program", "{depth}"]
template = "deck"
exit_codes = {3 = "the pad is too heavy"}
[parameters.load]
nominal = 1.0
unit = "N"
bounds = [0.0, 10.0]
[parameters.depth]
nominal = 3.0
[outputs.life]
unit = "s"
life = true
pattern = 'life = (\\S+)'
[outputs.pair]
shape = [2]
file = "out.json"
json = "pairs.0"
[outputs.last]
file = "out.csv"
csv = "b"
"""

PAD_PROGRAM = """#!/bin/sh
awk -v d=$1 -F= '$1 == "load" {
    if ($2 > 1.5) { print "heavier than 1.5" > "/dev/stderr"; exit 3 }
    if ($2 < 0.2) print "life = inf"; else printf "life = %.17g\\n", d / $2
    printf "{\\"pairs\\": [[%.17g, %.17g]]}", $2, 2 * $2 > "out.json"
    printf "a,b\\n0,0\\n1,%.17g\\n", $2 * $2 > "out.csv"
}' input.txt
"""


def opened(path="own.nc"):
    return package.open_result(path) if Path(path).is_file() else None


def run_program(uq, *more):
    ended = uq("run", "own.toml", "--model", "machine.toml", "-o", "own.nc", "--quiet", *more)
    return ended, opened()


def run_server(uq, address, *more, samples=10, **study):
    Path("own.toml").write_text(own_study("m", samples=samples, **study))
    return uq("run", "own.toml", "--model", address, "-o", "own.nc", "--quiet", *more)


def run_server_here(address, samples, **options):
    Path("own.toml").write_text(own_study("m", samples=samples))
    return package.run(package.load_study("own.toml", address), "own.nc", **options)
