"""Write docs/pictures/beam.svg, vibrator.svg and mole.svg."""

from pathlib import Path

from . import SKETCHES

if __name__ == "__main__":
    for name, sketch in SKETCHES.items():
        path = Path(__file__).parents[1] / "pictures" / f"{name}.svg"
        path.write_text(sketch().svg(), encoding="utf-8")
