"""The fast propagator: sixteen rigid machines at a time, in steps of fixed length.

Read `fixed_steps`, with the accelerations in `dynamics`; then `orbit`, Newton's method for the
synchronous motion, with its `tangents` and the largest Floquet `multiplier`.
"""
