"""Numbers with units, symbols and names as text.

Reading order; each part imports only those above it:

    element_names  names of the elements of an output with dimensions
    literals       TOML literals: reading and writing of values, and text safe for a terminal
    units          readable units of quantities, and symbols of formulas, as text
    quantities     parser of quantities with units: ``24 hours``, ``12 degrees``, ``30 mm/s``
    keys           keys of numbers
    numbers        formatting of numbers and laws as text
"""
