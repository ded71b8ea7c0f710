"""Code that reproduces the paper; studies do not need it.

Reading order:

    table1          prints its Table 1
    centre          the centre of mass to which its formulas refer
    closed_forms    its formulas for one disturbance at a time
"""
