"""What reproduces the paper, and no row of a study needs.

`table1` prints its Table 1; `closed_forms` are its formulas for one disturbance at a time, and
`criterion` is the integral criterion by which it derives them.
"""
