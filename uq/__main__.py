"""``python -m uq``: the command ``uq``."""

from uq.cli import main

main()
