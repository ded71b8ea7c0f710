"""Learning from inspections: what measurements say of inputs, of units, and of lives to come.

Reading order; a module imports only those above it:

    inspections     what was measured, as lines of a file
"""
