"""What reproduces the paper, and no row of a study needs.

`table1` prints its Table 1. `closed_forms` are its formulas for one disturbance at a time, about
the `centre` of mass that they mean; `criterion` is the integral criterion that they come from, and
`moments` the vibratory moments that both are about.
"""
