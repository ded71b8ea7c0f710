"""Numbers with units, symbols and names as text.

Reading order; each part imports only those above it:

    element_names  the names of the elements of an output with dimensions
    keys           the key of a number
    literals       values as written in a TOML file
    units          units in which quantities are read, and symbols of formulas, as text
    quantities     quantities as a person writes them: ``24 hours``, ``12 degrees``, ``30 mm/s``
    numbers        numbers and laws as text, for tables on a terminal and in a report
"""
