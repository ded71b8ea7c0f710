"""A ball dropped on a plate: the machine of notebook 06, as a separate package.

In this folder, ``uq run drop.toml --model bouncing_ball:MODEL`` finds it.
"""

from bouncing_ball.machine import MODEL

__all__ = ["MODEL"]
