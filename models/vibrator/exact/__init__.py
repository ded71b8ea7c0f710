"""The exact propagator: any machine, one at a time, with error control.

Reading order; a module imports only those above it:

    ramp          synchronous speeds that an inverter raises
    lag           motor torques that follow with a delay
    propagator    one machine, started and followed
    budgeted      a machine run repeatedly within a budget of steps
    measures      measures of a sampled motion
    orbit         the synchronous motion as a periodic orbit, by shooting

It is a `models.numerics.propagator.ReferencePropagator`.
"""

from models.vibrator.exact.propagator import Motion, propagate, start

__all__ = ["Motion", "propagate", "start"]
