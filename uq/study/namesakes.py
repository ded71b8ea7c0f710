"""Other packages that bear the name of one of ours, such as a file ``models.py`` of a user."""

import os
from pathlib import Path

from uq.study.sources import DISTRIBUTION, INSTALLED, found_at, own_packages, sources_of

_HOUSE = Path(__file__).parents[2]  # our packages lie beside each other, however installed


def namesake(package: str) -> str:
    """Return a message if Python finds another package under the name of one of our models'.

    Parameters
    ----------
    package : str
        Of a model.

    Returns
    -------
    str
        A sentence with both places; "" if Python finds ours.
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
    code, others = sources_of(module)
    names = [name.split(".") for name in (*code, *others)]
    place = found_at(module.partition(".")[0])
    for package in sorted(own_packages() & {first for first, *_ in names}):
        ours = _HOUSE / package
        modules = {rest[0] for first, *rest in names if first == package and rest}
        if place is None or namesake(package) or modules & {p.stem for p in ours.iterdir()}:
            continue
        for beside in (place.with_name(f"{package}.py"), place.with_name(package)):
            if beside.exists() and not _is_same(beside, ours):
                return (
                    f"imports '{package}', which Python finds in {ours} of {DISTRIBUTION}, not in"
                    f" {beside}; rename the latter"
                )
    return ""


def _is_same(first: Path, second: Path) -> bool:
    return os.path.realpath(first) == os.path.realpath(second)
