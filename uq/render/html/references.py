"""References that a model asks to cite."""

from uq.errors import InputError
from uq.result.result import Result
from uq.study.installed_models import find_model


def references(result: Result) -> tuple[str, ...] | None:
    """Return the references that the model asks to cite, or None if it is not installed."""
    try:
        return find_model(result.dataset.attrs["model"]).references
    except InputError:
        return None
