"""Draw the figures of the gallery from the results of the shipped studies, which are run first."""

import os
import sys

from matplotlib.figure import Figure

import uq
from uq.render.figures.figure import write

from . import FOLDER, drawn
from .examples import EXAMPLES


def main(chosen: list[str]) -> None:
    """Draw some figures, by default all."""
    os.chdir(FOLDER.parents[1])
    for one in EXAMPLES:
        if chosen and one.name not in chosen:
            continue
        if one.study:
            uq.run(f"studies/{one.study}.toml")
        figure = drawn(one)
        assert isinstance(figure, Figure)
        write(figure, FOLDER / one.name, ("svg",))
        print(one.name, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
