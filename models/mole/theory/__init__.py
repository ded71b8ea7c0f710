"""The mole on paper: its equations, without any method of solving them.

Reading order; a module imports only those above it:

    system       the constants of one mole, or of n
    friction     which interface slips, and the forces that follow
    equations    rates of change within a mode
    periods      the common period of control and mains
"""
