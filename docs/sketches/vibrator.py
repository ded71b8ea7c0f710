"""The vibrator: a body on springs that two unbalanced motors shake."""

from math import cos, radians, sin

from .sheet import CARD, INK, MOVES, PALE, Point, Sheet

CENTRE = (148.0, 104.0)
WORKING, HALF_ANGLE, DISTANCE = 30.0, 21.0, 86.0  # degrees, degrees, points
SPACING, OFFSET, GROUND = 94.0, 46.0, 16.0
RADIUS, ARM = 19.0, 12.0
PHASES = (62.0, 38.0)  # degrees
"""Of the unbalances, from the working axis, each in its own sense."""


def vibrator() -> Sheet:
    """Draw the body with its motors at work, the second one lagging behind the first."""
    sheet = Sheet(228)
    _body(sheet)
    _supports(sheet)
    _axes(sheet)
    for number, side in ((1, 1), (2, -1)):
        _motor(sheet, number, side)
    sheet.symbols(
        [
            (r"$\psi_1,\ \psi_2$", "phases of the unbalances"),
            (r"$\Delta\varphi$", r"disphasing angle, $\psi_1 - \psi_2$"),
            (r"$m e_1,\ m e_2$", "static unbalances"),
            (r"$M_k,\ J_{Ck}$", "mass and inertia of the body"),
            (r"$\xi,\ \beta$", "working axis and its angle"),
            (r"$D,\ \gamma$", "places of the shafts"),
            (r"$k_x,\ k_y$", "stiffness of the springs, both sides"),
            (r"$\kappa$", "(right $-$ left) of these, over their sum"),
            (r"$l,\ h$", "places of the springs"),
        ]
    )
    return sheet


def _place(angle: float, distance: float, start: Point = CENTRE) -> tuple[float, float]:
    """Return the point in a direction [degrees] from another."""
    turn = radians(angle)
    return start[0] + distance * cos(turn), start[1] + distance * sin(turn)


def _shaft(side: int) -> tuple[float, float]:
    return _place(WORKING + side * HALF_ANGLE, DISTANCE)


def _body(sheet: Sheet) -> None:
    x, y = CENTRE
    (x_1, y_1), (x_2, y_2) = _shaft(1), _shaft(-1)
    sheet.area(
        (x + 4, y + 8),
        (x_1 - 28, y_1 + 12),
        (x_1 - 8, y_1 + 26),
        (x_1 + 18, y_1 + 20),
        (x_2 + 22, y_2 + 14),
        (x_2 + 25, y_2 - 10),
    )
    deck = [(-122, 22), (-114, 22), (-108, 8), (108, 8), (118, 8), (118, -14), (-112, -14)]
    sheet.area(*((x + a, y + b) for a, b in deck))


def _supports(sheet: Sheet) -> None:
    x, y = CENTRE
    foot = y - OFFSET
    for side in (-1, 1):
        at = x + side * SPACING
        sheet.line((at, y - 14), (at, foot), width=2.2)
        sheet.spring((at, foot), (at, GROUND), turns=4)
        sheet.spring((at, foot), (at + side * 36, foot), turns=3, wide=4)
        sheet.wall((at + side * 36, foot - 10), (at + side * 36, foot + 10), (side, 0))
        sheet.wall((at - 16, GROUND), (at + 16, GROUND), (0, -1))
        sheet.disc((at, foot), 2.2, fill=INK)
        name = "R" if side > 0 else "L"
        sheet.text((at - side * 20, (foot + GROUND) / 2), f"$k_{{y{name}}}$")
        sheet.text((at + side * 19, foot - 15), f"$k_{{x{name}}}$")
    low = foot - 2
    sheet.line((x, y - 16), (x, low - 6), colour=PALE, width=0.7, dashes="-.")
    sheet.dimension((x, low), (x + SPACING - 3, low), "$l$", (x + SPACING / 2, low + 8))
    sheet.dimension((x - 40, y), (x - 40, foot), "$h$", (x - 48, (y - 14 + foot) / 2))
    sheet.line((x - 48, foot), (x - SPACING, foot), colour=PALE, width=0.7, dashes="-.")


def _axes(sheet: Sheet) -> None:
    x, y = CENTRE
    end = _place(WORKING, 142)
    sheet.line(CENTRE, (x + 52, y), colour=PALE, width=0.7, dashes="-.")
    sheet.arrow(CENTRE, end, colour=PALE, width=0.8)
    sheet.text((end[0] + 7, end[1] + 3), r"$\xi$")
    sheet.arc(CENTRE, 44, 0, WORKING)
    sheet.text(_place(WORKING / 2, 36), r"$\beta$")
    sheet.arc(CENTRE, 58, WORKING, WORKING + HALF_ANGLE)
    sheet.text(_place(WORKING + HALF_ANGLE / 2, 50), r"$\gamma$")
    sheet.line(CENTRE, _shaft(1), colour=PALE, width=0.8)
    sheet.text(_place(WORKING + HALF_ANGLE + 8, 50), "$D$")
    sheet.disc(CENTRE, 3, fill=INK)
    sheet.text((x - 10, y - 4), "$C$")


def _motor(sheet: Sheet, number: int, side: int) -> None:
    shaft = _shaft(side)
    phase = PHASES[number - 1]
    sheet.disc(shaft, RADIUS, fill=CARD)
    sheet.line(shaft, _place(WORKING, RADIUS + 15, shaft), colour=PALE, width=0.7, dashes="-.")
    weight = _place(WORKING + side * phase, ARM, shaft)
    sheet.line(shaft, _place(WORKING + side * phase, RADIUS + 11, shaft), colour=MOVES, width=0.8)
    sheet.disc(weight, 5, fill=MOVES, edge=MOVES)
    sheet.disc(shaft, 1.8, fill=INK)
    sheet.arc(shaft, RADIUS + 8, WORKING, WORKING + side * phase, colour=MOVES, arrow=True)
    symbol = _place(WORKING + side * phase / 2, RADIUS + 17, shaft)
    sheet.text(symbol, rf"$\psi_{number}$", colour=MOVES)
    name = _place(WORKING + side * 125, RADIUS + (18 if side > 0 else 15), shaft)
    sheet.text(name, f"$m e_{number}$")
