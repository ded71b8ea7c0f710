"""The pictures of the machines, with the symbols of their papers: ``python -m sketches``, in docs.

One module a machine; `sketches.sheet` has what they are drawn with. A picture is SVG without
fonts, in the colours of light and dark pages.
"""

from .beam import beam
from .mole import mole
from .vibrator import vibrator

SKETCHES = {"beam": beam, "vibrator": vibrator, "mole": mole}
"""Machine -> function that draws it."""
