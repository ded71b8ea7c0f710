"""From standstill to the steady state, on either propagator.

Reading order; a module imports only those above it:

    regimes        possible outcomes of a start
    synchronous    the motion that fast rows are expected to reach
    last_second    measures of rows that reach none
    instants       speeds and disphasing angle at given instants of a run-up
    fast           many rigid machines at a time
    track          a run-up of one machine, sampled on the way
    exact          any machines, one after the other
"""
