"""How Sphinx builds the documentation: ``make docs``.

Notebooks become pages that show the outputs which they keep. Formulas become MathML, with a font
beside the pages: nothing is fetched from elsewhere.
"""

import shutil
import sys
from pathlib import Path
from typing import Any

from docutils.nodes import SkipNode

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
import formulas  # noqa: E402
from pages import expanded  # noqa: E402

NOTEBOOKS = HERE / "notebooks"  # a copy: pages lie within this folder
shutil.rmtree(NOTEBOOKS, ignore_errors=True)
NOTEBOOKS.mkdir()
for notebook in HERE.parent.glob("notebooks/*.ipynb"):
    shutil.copy(notebook, NOTEBOOKS)

project = "vibrolife"
copyright = "2026, the vibrolife developers"
extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc", "sphinx_copybutton"]
exclude_patterns = ["outputs"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
nb_execution_mode = "off"
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
html_search_scorer = str(HERE / "search_scorer.js")
html_show_sphinx = False
html_copy_source = False
html_math_renderer = "mathml"
copybutton_selector = ", ".join(  # what one may run or keep, not what is printed
    f"div.highlight-{language} pre" for language in ("sh", "python", "ipython3", "toml")
)


def _inline(translator: Any, node: Any) -> None:
    translator.body.append(formulas.inline(node.astext()))
    raise SkipNode


def _block(translator: Any, node: Any) -> None:
    translator.body.append(formulas.block(node.astext()))
    raise SkipNode


def _read(_: Any, name: str, source: list[str]) -> None:
    source[0] = expanded(source[0])


def _add_font(app: Any, exception: Exception | None) -> None:
    if exception is None:
        formulas.write_font(Path(app.outdir) / "_static/math.woff")


def setup(app: Any) -> None:
    """Register what pages are put through."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.connect("source-read", _read)
    app.connect("build-finished", _add_font)
