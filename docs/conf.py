"""How Sphinx builds the documentation: ``make docs``.

Formulas become MathML, which browsers draw without a script; nothing is fetched from elsewhere.
"""

import re
import sys
from pathlib import Path
from typing import Any

from docutils.nodes import SkipNode
from latex2mathml.converter import convert

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
from pages import expanded  # noqa: E402

project = "vibrolife"
copyright = "2026, the vibrolife developers"
extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc"]
exclude_patterns = ["outputs"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
numpydoc_show_class_members = False
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
python_maximum_signature_line_length = 80
default_role = "code"  # a name in single backticks, in docstrings
highlight_language = "none"

html_theme = "furo"
html_title = "vibrolife"
html_static_path = ["_static"]
html_css_files = ["pages.css"]
html_show_sphinx = False
html_copy_source = False
html_math_renderer = "mathml"

_DOTS = {"2D9": "\u0307", "0A8": "\u0308"}
_DOTTED = re.compile("<mover><mi>([^<]*)</mi><mo>&#x00(2D9|0A8);</mo></mover>")
_UPRIGHT = re.compile('(?:<mi mathvariant="normal">[A-Za-z]</mi>){2,}')
_TAG = re.compile(r"\\tag\{(.*?)\}")


def mathml(tex: str, display: str) -> str:
    """Return a formula as MathML that needs no mathematical font.

    Dots are parts of their letters, words are in one piece, and a tag stands behind its formula.
    """
    found = convert(_TAG.sub(r"\\qquad\\text{(\1)}", tex), display=display)
    found = _DOTTED.sub(lambda one: f'<mi class="dotted">{one[1]}{_DOTS[one[2]]}</mi>', found)
    return _UPRIGHT.sub(lambda word: f"<mi>{re.sub('<.*?>', '', word.group())}</mi>", found)


def _inline(translator: Any, node: Any) -> None:
    translator.body.append(mathml(node.astext(), "inline"))
    raise SkipNode


def _block(translator: Any, node: Any) -> None:
    translator.body.append(f'<div class="formula">{mathml(node.astext(), "block")}</div>')
    raise SkipNode


def _read(_: Any, name: str, source: list[str]) -> None:
    source[0] = expanded(source[0])


def setup(app: Any) -> None:
    """Register what pages are put through."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.connect("source-read", _read)
