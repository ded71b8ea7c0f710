"""Write docs/pictures/beam.svg, vibrator.svg and mole.svg, and those for phones in docs/_static."""

from pathlib import Path

from . import SKETCHES

if __name__ == "__main__":
    for name, sketch in SKETCHES.items():
        docs, sheet = Path(__file__).parents[1], sketch()
        (docs / "pictures" / f"{name}.svg").write_text(sheet.svg(), encoding="utf-8")
        (docs / "_static" / f"{name}-narrow.svg").write_text(sheet.narrow(), encoding="utf-8")
