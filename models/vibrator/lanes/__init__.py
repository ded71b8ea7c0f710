"""The fast propagator: sixteen rigid machines at a time, in steps of fixed length.

Read `fixed_steps`, with the accelerations in `dynamics`, machines `packed` into lanes, and the
`notes` it takes; then `orbit`, Newton's method for the synchronous motion, with its `tangents` and
the largest Floquet `multiplier`.
"""
