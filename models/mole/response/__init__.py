"""The settled response of n moles, by the fast propagator.

Reading order; a module imports only those above it:

    measured     what is measured on the way
    verdict      what a motion is that does not repeat
    machines     n moles, and where they stand
    settling     until the start is forgotten
    following    averages, over periods or over batches
"""
