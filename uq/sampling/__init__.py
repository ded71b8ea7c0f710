"""Laws of inputs and designs of points: what is uncertain, how inputs depend, which points.

Reading order; each part imports only those above it:

    input_faults   one fault of a study file, and its line for the user
    unit_cube      points that fill the unit cube
    levels         levels: which rows of a sample share the value of an input
    named_values   checks of values given by name for the parameters and settings of a model
    dependence     dependent inputs
    designs        the designs by name: how each draws its points and groups its rows
    law            the base class of all laws of an uncertain parameter
    data_files     columns of numbers named by a study file
    listed_values  laws of listed values
    scipy_laws     the laws of an uncertain parameter, with scipy.stats only where it is needed
    laws           the laws by name
    truncation     a law within the bounds of its parameter
    log_sums       the law of a sum of independent terms
"""
