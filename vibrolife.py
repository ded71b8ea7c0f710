"""The command ``uq``, started only where Python finds the package `uq` of this distribution.

Other distributions bear the name `uq` as well. This module lies beside ours and bears the name of
the distribution, so that it is found whichever `uq` comes first.
"""

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import NoReturn

_OURS = Path(__file__).resolve().parent / "uq"


def main() -> NoReturn:
    """Run the command line, or say in one line which other `uq` is in its place; never return."""
    if problem := _namesake():
        sys.exit(f"uq: {problem}")
    from uq.cli import main as command

    command()


def _namesake() -> str:
    """Return where another package `uq` is, and what to do about it; "" if ours is found."""
    spec = find_spec("uq")
    folders = [*(spec.submodule_search_locations or [])] if spec else []
    place = folders[0] if folders else spec.origin if spec else None
    if place is None or Path(place).resolve() != _OURS:
        return (
            f"{place} is another 'uq' than that of vibrolife, {_OURS}, and Python finds it first;"
            " uninstall or rename it, or install vibrolife into an environment of its own"
        )
    try:
        import uq

        is_ours = "load_study" in dir(uq)
    except ModuleNotFoundError as error:
        is_ours = error.name == "lazy_loader"  # not installed, which the next import reports
    except Exception:
        is_ours = False
    if is_ours:
        return ""
    return (
        f"{_OURS / '__init__.py'} is not that of vibrolife: another distribution with a package"
        " 'uq' is installed over it; uninstall both, and install vibrolife again"
    )


if __name__ == "__main__":
    main()
