"""The mole: a solenoid throws a bar against a stop, and dry friction lets it creep forward."""

from .sheet import BODY, CARD, INK, MOVES, PALE, WEARS, Sheet

GROUND, FLOOR, ROOF = 30.0, 42.0, 92.0  # the cavity is between floor and roof
REAR, FRONT, NOSE = 20.0, 222.0, 250.0
COIL = (118.0, 206.0)
BAR = (92.0, 160.0, 55.0, 79.0)  # left, right, low, high
STOP = 186.0
WIRE = 186.0  # height of the circuit


def mole() -> Sheet:
    """Draw the mole from the side, its circuit above it."""
    sheet = Sheet(228)
    _case(sheet)
    _inside(sheet)
    _circuit(sheet)
    sheet.symbols(
        [
            (r"$V_s,\ \Omega$", "supply: amplitude, frequency"),
            (r"$P,\ F_{ctr}$", "relay and its control frequency"),
            ("$R,\\ C,\\ L(u)$", "resistance, capacitance, inductance"),
            ("$m_1,\\ m_2$", "mass of the bar, of the mole"),
            ("$u,\\ w$", "place of the bar, progression"),
            ("$k_0,\\ G$", "stop: stiffness, place"),
            ("$k_1,\\ X_0,\\ c$", "spring and damper of the bar"),
            (r"$\mu_1,\ \mu_2$", "dry friction of bar and mole"),
            ("$k_s,\\ F_0$", "soil: stiffness, force at which it yields"),
        ]
    )
    return sheet


def _case(sheet: Sheet) -> None:
    sheet.wall((NOSE + 4, GROUND), (REAR - 8, GROUND), (0, -1))
    low, high = GROUND, ROOF + 12
    sheet.area(
        (REAR, low), (FRONT + 10, low), (NOSE, (low + high) / 2), (FRONT + 10, high), (REAR, high)
    )
    sheet.box(REAR + 10, FLOOR, FRONT, ROOF, fill=CARD)
    for x in range(int(COIL[0]), int(COIL[1]) + 1, 8):
        for y in (GROUND + 6, ROOF + 6):
            sheet.disc((x, y), 3.2, fill=WEARS)
    middle = (low + high) / 2
    sheet.text((FRONT + 15, middle), "$m_2$")
    sheet.text((FRONT + 28, GROUND - 13), r"$\mu_2$")
    sheet.arrow((FRONT + 14, high + 6), (FRONT + 44, high + 6))
    sheet.text((FRONT + 29, high + 16), "$w$", colour=MOVES)
    sheet.spring((NOSE, middle), (NOSE + 26, middle), turns=4, wide=4)
    sheet.box(NOSE + 26, middle - 12, NOSE + 36, middle + 12, fill=PALE)
    sheet.text((NOSE + 14, middle + 14), "$k_s$")
    sheet.text((NOSE + 32, middle + 21), "$F_0$")


def _inside(sheet: Sheet) -> None:
    left, right, low, high = BAR
    rear = REAR + 10
    sheet.line((rear, low - 2), (FRONT, low - 2), colour=PALE, width=0.8)
    sheet.box(left, low, right, high, fill=BODY)
    sheet.text(((left + right) / 2, (low + high) / 2), "$m_1$")
    sheet.spring((rear, high - 5), (left, high - 5), turns=5, wide=4)
    sheet.text((rear + 12, high + 6), "$k_1$")
    y = low + 5
    sheet.line((rear, y), (rear + 24, y))
    sheet.line((rear + 24, y - 4), (rear + 24, y + 4))
    sheet.line((rear + 34, y - 5), (rear + 18, y - 5))
    sheet.line((rear + 34, y + 5), (rear + 18, y + 5))
    sheet.line((rear + 34, y - 5), (rear + 34, y + 5))
    sheet.line((rear + 34, y), (left, y))
    sheet.text((rear + 46, y + 6), "$c$")
    sheet.text((right + 10, low + 5), r"$\mu_1$")
    middle = (low + high) / 2
    sheet.box(STOP, middle - 10, STOP + 6, middle + 10, fill=INK)
    sheet.spring((STOP + 6, middle), (FRONT, middle), turns=4, wide=4)
    sheet.text((STOP + 22, middle + 14), "$k_0$")
    sheet.text((STOP + 3, middle - 18), "$G$")
    sheet.arrow((right - 22, high + 6), (right + 8, high + 6))
    sheet.text((right + 15, high + 6), "$u$", colour=MOVES)


def _circuit(sheet: Sheet) -> None:
    left, right, top = REAR + 6, FRONT + 6, ROOF + 10
    low = top + 32
    a, b = COIL
    for ends in (
        [(a, top), (a, low), (left, low), (left, WIRE), (46, WIRE)],
        [(70, WIRE), (102, WIRE)],
        [(124, WIRE), (148, WIRE)],
        [(182, WIRE), (206, WIRE)],
        [(212, WIRE), (right, WIRE), (right, low), (b, low), (b, top)],
    ):
        sheet.line(*ends)
    sheet.disc((58, WIRE), 12)
    sheet.text((58, WIRE), r"$\sim$", size=15)
    sheet.text((62, WIRE + 24), r"$V_s\,\sin(\Omega t+\phi)$")
    sheet.line((102, WIRE), (122, WIRE + 10))
    for x in (102, 124):
        sheet.disc((x, WIRE), 2)
    sheet.text((114, WIRE - 14), "$P$")
    sheet.box(148, WIRE - 7, 182, WIRE + 7, fill=CARD)
    sheet.text((165, WIRE - 18), "$R$")
    for x in (206, 212):
        sheet.line((x, WIRE - 11), (x, WIRE + 11), width=1.6)
    sheet.text((209, WIRE - 22), "$C$")
    sheet.arrow((60, low), (90, low))
    sheet.text((75, low + 9), "$i$", colour=MOVES)
    sheet.text(((a + b) / 2, ROOF + 22), "$L(u)$")
