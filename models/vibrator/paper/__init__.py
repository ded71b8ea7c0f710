"""What reproduces the paper, and no row of a study needs.

Reading order:

    table1          prints its Table 1
    centre          the centre of mass that its formulas mean
    closed_forms    its formulas for one disturbance at a time
    criterion       the integral criterion that they come from
    moments         the vibratory moments that both are about
"""
