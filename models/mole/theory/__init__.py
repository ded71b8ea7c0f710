"""The equations of the mole, without any method of solution.

Reading order; a module imports only those above it:

    system       the constants of one mole, or of n
    friction     which interface slips, and the resulting forces
    soil         the soil ahead of the mole, and which interface slips where it pushes
    equations    rates of change within a mode
    periods      the common period of control and mains
"""
