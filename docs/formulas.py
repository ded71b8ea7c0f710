"""Formulas as MathML, and the font in which browsers draw it without one of their own."""

import logging
import os
import re
from importlib.util import find_spec
from pathlib import Path

from fontTools.subset import Options, Subsetter
from fontTools.ttLib import TTFont
from latex2mathml.converter import convert

_BARS = re.compile(r"(?<!\\left)(?<!\\right)\|([^|]*)\|")
_TAG = re.compile(r"\\tag\{(.*?)\}")
_BREAK = re.compile(r"(\\qquad|\\allowbreak)")

_DOTTED = re.compile("<mover>(<mi>[^<]*</mi>)<mo>(&#x00(?:2D9|0A8);)</mo></mover>")
_UPRIGHT = re.compile('(?:<mi mathvariant="normal">[A-Za-z]</mi>){2,}')
_FUNCTION = re.compile("(<mi>(?:sin|cos|tan|sgn|Sgn|Im)</mi>)")
_SIGN = re.compile(r"(?<=(?:&#x0003D;|&#x00028;)</mo>)<mo>(?=&#x0002B;|&#x02212;)")
_CONTINUED = re.compile(r"<mrow><mo>(?=&#x0002B;|&#x02212;)")

CHARACTERS = (
    (0x20, 0x7F),  # ASCII
    (0xA0, 0x100),
    (0x300, 0x310),  # accents
    (0x2D8, 0x2DE),  # dots above letters
    (0x391, 0x3F7),  # Greek
    (0x2010, 0x2050),  # punctuation
    (0x210E, 0x210F),  # h, in italics
    (0x2190, 0x22FF),  # arrows and operators
    (0x27E8, 0x27EA),  # angle brackets
    (0x1D434, 0x1D468),  # italic letters, as which a browser writes those of a formula
    (0x1D6E2, 0x1D71C),
)
"""Ranges of the characters that the font has."""


def inline(tex: str) -> str:
    """Return a formula as MathML, with the spaces that mathematics has."""
    found = convert(_BARS.sub(r"\\left|\1\\right|", tex))
    found = _DOTTED.sub(r'<mover accent="true">\1<mo stretchy="false">\2</mo></mover>', found)
    found = _UPRIGHT.sub(lambda word: f"<mi>{re.sub('<.*?>', '', word.group())}</mi>", found)
    found = _FUNCTION.sub(r'<mspace width="0.17em" />\1<mspace width="0.17em" />', found)
    return _SIGN.sub('<mo form="prefix">', found)


def block(tex: str) -> str:
    r"""Return a formula on lines of its own, to be broken at ``\qquad`` and ``\allowbreak``.

    Browsers break no formula: each part is one. A tag stands at the end of the last line.
    """
    tag = _TAG.search(tex)
    parts = _BREAK.split(_TAG.sub("", tex).strip())
    found = [f'<span class="part">{_displayed(parts[0])}</span>']
    for mark, part in zip(parts[1::2], parts[2::2], strict=True):
        if mark == r"\qquad":
            found.append(f'<span class="part apart">{_displayed(part)}</span>')
        else:
            continued = _CONTINUED.sub('<mrow><mo form="infix">', _displayed(part), count=1)
            found.append(f'<span class="part">{continued}</span>')
    if tag:
        found.append(f'<span class="tag">({tag[1]})</span>')
    return f'<div class="formula">{"".join(found)}</div>'


def _displayed(tex: str) -> str:
    return inline(tex).replace('"inline"', '"inline" displaystyle="true"', 1)


def write_font(path: Path) -> None:
    """Write the part of STIX Two Math, from the package ``ziamath``, that formulas use, as WOFF."""
    logging.getLogger("fontTools").setLevel(logging.WARNING)
    package = find_spec("ziamath")
    assert package and package.origin
    font = TTFont(os.path.join(os.path.dirname(package.origin), "fonts/STIXTwoMath-Regular.ttf"))
    subsetter = Subsetter(Options(layout_features=["mark", "mkmk", "ssty", "dtls"], hinting=False))
    subsetter.populate(unicodes=[code for ends in CHARACTERS for code in range(*ends)])
    subsetter.subset(font)
    font.flavor = "woff"
    font.save(path)
