"""From standstill to the steady state, on either propagator.

Read `regimes`, what may become of a machine; `fast`, with the `synchronous` motion it looks for and
the `last_second` that it measures; then `exact`, which samples its run-up as a `track`.
"""
