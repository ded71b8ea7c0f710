"""The templates of pages, and what every page on a result shows."""

import json
import re
import shlex
from functools import cache
from typing import Any

from markupsafe import Markup, escape

from uq.render.html.answer import STYLE
from uq.result.result import Result
from uq.text.literals import plain
from uq.text.numbers import capitalized, printed

_SHOWN_TEXT = 50_000
"""Characters of the study's text that a page shows: a study may contain data files."""


def laid_out(template: str, result: Result, **content: Any) -> str:
    """Return a page on a result as HTML.

    Parameters
    ----------
    template : str
        The name of one that extends ``base.html``.
    result : Result
        A result.
    **content
        What this template shows besides title, style and study file.

    Returns
    -------
    str
    """
    text = result.dataset.attrs["study"]
    return (
        templates()
        .get_template(template)
        .render(
            attrs=result.dataset.attrs,
            study=result.study,
            text=text.expandtabs(4)[:_SHOWN_TEXT],
            text_is_cut=len(text) > _SHOWN_TEXT,
            answer_style=STYLE,
            **content,
        )
    )


@cache
def templates() -> Any:
    """Return jinja's environment of the templates beside this file."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("uq.render.html", ""),
        autoescape=True,
        finalize=lambda value: plain(value) if type(value) is str else value,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "breakable": _breakable,
        "inside": _inside,
        "printed": _printed,
        "capitalized": capitalized,
        "quoted": shlex.quote,
    }
    return environment


def _breakable(text: str) -> Markup:
    """Return text as printed, with places where long names may be broken."""
    return Markup(re.sub(r"([_,\[])(?=\S)", r"\1<wbr>", str(escape(plain(printed(text))))))


def _printed(text: str) -> str:
    return text if isinstance(text, Markup) else printed(text)


def _inside(content: Any) -> Markup:
    """Return plain data as JSON that can stand inside a page."""
    return Markup(json.dumps(content, allow_nan=False).replace("<", "\\u003c"))
