"""From standstill to the steady state, on either propagator.

Reading order; a module imports only those above it:

    regimes        what may become of a machine
    synchronous    the motion that fast rows are expected to reach
    last_second    what is measured of those that reach none
    fast           many rigid machines, abreast
    track          a run-up of one machine, sampled as it goes
    exact          any machines, one after the other
"""
