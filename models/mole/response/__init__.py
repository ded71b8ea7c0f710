"""The settled response of n moles, by the fast propagator.

Reading order; a module imports only those above it:

    measured     measures of the settled response
    verdict      regimes of motion that does not repeat
    machines     n moles and their present states
    settling     until the start is forgotten
    following    averages, over periods or over batches
    settled      all of these, for n moles
"""
