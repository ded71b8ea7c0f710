"""Other packages that bear the name of one of ours, such as a file ``models.py`` beside a script.

Python takes the first that it finds.
"""

import os
from importlib.util import find_spec
from pathlib import Path

from uq.study.sources import DISTRIBUTION, INSTALLED, own_packages, sources_of

_HOUSE = Path(__file__).parents[2]  # our packages lie beside each other, however installed


def found_at(package: str) -> Path | None:
    """Return the file or folder in which Python finds a package; None if it finds none."""
    try:
        spec = find_spec(package)
    except (ImportError, ValueError):  # ValueError: it was imported, but from nowhere
        return None
    if spec is None:
        return None
    places = [*(spec.submodule_search_locations or []), spec.origin]
    return Path(places[0]) if places[0] else None


def namesake(package: str) -> str:
    """Return that Python finds another package under the name of one of our models'; "" if not.

    Parameters
    ----------
    package : str
        Of a model.

    Returns
    -------
    str
        A sentence with both places.
    """
    first, ours = found_at(package), _HOUSE / package
    if package not in own_packages() or not ours.is_dir() or first is None or _is_same(first, ours):
        return ""
    installed = first.parent.name in INSTALLED
    remedy = "uninstall" if installed else "rename"
    other = "in another environment" if installed else "in another folder"
    return (
        f"{first} is another '{package}' than that of {DISTRIBUTION}, {ours}, and Python finds it"
        f" first; {remedy} it, or work {other}"
    )


def hidden_beside(module: str) -> str:
    """Return a message if a module's import of a neighbouring file is hidden by our package.

    Parameters
    ----------
    module : str
        Of a model in a file.

    Returns
    -------
    str
        A sentence with both places; "" if Python finds what the module means.
    """
    sources = sources_of(module)
    names = [name.split(".") for name in (*sources.code, *sources.others)]
    for package in sorted(own_packages() & {first for first, *_ in names}):
        ours = _HOUSE / package
        modules = {rest[0] for first, *rest in names if first == package and rest}
        if sources.root is None or namesake(package) or modules & {p.stem for p in ours.iterdir()}:
            continue
        for beside in (sources.root / f"{package}.py", sources.root / package):
            if beside.exists() and not _is_same(beside, ours):
                return (
                    f"imports '{package}', which Python finds in {ours} of {DISTRIBUTION}, not in"
                    f" {beside}; rename the latter"
                )
    return ""


def _is_same(first: Path, second: Path) -> bool:
    return os.path.realpath(first) == os.path.realpath(second)
