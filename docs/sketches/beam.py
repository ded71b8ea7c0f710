"""The beam: a rod on springs whose tip rattles between two stops."""

import numpy as np

from .sheet import MOVES, PALE, WEARS, Sheet

FOOT, TIP, AXIS = 40.0, 196.0, 152.0
DEFLECTION, HALF = 17.0, 5.0  # of the tip, and half the rod's width
GAP, PAD = 30.0, 9.0


def beam() -> Sheet:
    """Draw the rod upright, so that its stops are the left and the right one."""
    sheet = Sheet(240)
    _support(sheet)
    for side in (-1, 1):
        _deflected(sheet, side * DEFLECTION)
    sheet.box(AXIS - HALF, FOOT, AXIS + HALF, TIP)
    for side, gap, stop in ((1, "$g_1$", "right"), (-1, "$g_2$", "left")):
        _stop(sheet, side, gap, stop)
    sheet.line((AXIS, FOOT), (AXIS, TIP + 18), colour=PALE, width=0.7, dashes="-.")
    sheet.arrow((AXIS, TIP + 10), (AXIS + 26, TIP + 10))
    sheet.text((AXIS + 37, TIP + 11), "$X_c$", colour=MOVES)
    sheet.arrow((AXIS - 34, TIP + 23), (AXIS + 34, TIP + 23), both=True, width=1.8)
    sheet.text((AXIS, TIP + 34), r"$F\,\cos\,\Omega t$", colour=MOVES)
    sheet.dimension((30, FOOT), (30, TIP), "$L$", (20, (FOOT + TIP) / 2))
    sheet.text((AXIS + 33, 104), r"$E I,\ \rho A$")
    sheet.symbols(
        [
            (r"$F,\ \Omega$", "amplitude, frequency of the force"),
            ("$X_c$", "deflection of the tip"),
            ("$g_1,\\ g_2$", "gaps, which widen from $X_0$ by wear"),
            ("$k_c$", "stiffness of each stop"),
            ("$S,\\ k$", "contact area, wear coefficient"),
            (r"$EI,\ \rho A,\ L$", "bending stiffness, mass, length"),
            (r"$k_{\mathrm{tra}},\ k_{\mathrm{rot}}$", "stiffness of the support"),
        ]
    )
    return sheet


def _deflected(sheet: Sheet, deflection: float) -> None:
    share = np.linspace(0, 1, 21)
    middle = AXIS + deflection * share**1.7
    along = FOOT + (TIP - FOOT) * share
    for edge in (middle - HALF, middle + HALF):
        sheet.line(*zip(edge, along, strict=True), colour=PALE, width=0.7, dashes="--")


def _support(sheet: Sheet) -> None:
    sheet.spring((AXIS - 60, FOOT + 4), (AXIS - HALF, FOOT + 4), turns=4)
    sheet.wall((AXIS - 60, FOOT - 12), (AXIS - 60, FOOT + 20), (-1, 0))
    sheet.text((AXIS - 32, FOOT + 19), r"$k_{\mathrm{tra}}$")
    turn = np.linspace(0.5 * np.pi, 5.5 * np.pi, 61)
    radius = 1.5 + 0.7 * (turn - turn[0])
    x, y = AXIS + radius * np.cos(turn), FOOT - 9 + radius * np.sin(turn)
    sheet.line(*zip(x, y, strict=True))
    sheet.wall((AXIS + 40, FOOT - 22), (AXIS - 40, FOOT - 22), (0, -1))
    sheet.text((AXIS + 34, FOOT - 6), r"$k_{\mathrm{rot}}$")


def _stop(sheet: Sheet, side: int, gap: str, name: str) -> None:
    face = AXIS + side * (GAP + HALF)
    y = TIP - 12
    inner, outer = sorted((face, face + side * PAD))
    sheet.box(inner, y - 13, outer, y + 13, fill=WEARS)
    sheet.spring((face + side * PAD, y), (face + side * (PAD + 38), y), turns=4)
    wall = face + side * (PAD + 38)
    sheet.wall((wall, y - 18), (wall, y + 18), (side, 0))
    sheet.text((face + side * (PAD + 20), y + 15), "$k_c$")
    low = y - 24
    sheet.line((face, y - 15), (face, low - 4), colour=PALE, width=0.7)
    sheet.dimension((AXIS + side * HALF, low), (face, low), gap, (face - side * 12, low - 12))
    sheet.text((face + side * 26, y - 24), name, size=9.5, colour=PALE)
