"""Laws of inputs and designs of points: what is uncertain, how inputs depend, which points.

Reading order; each part imports only those above it:

    unit_cube          points that fill the unit cube
    input_faults       one fault of a study file, and its line for the user
    layouts            grouping of the rows of a design, as its sensitivity methods need it
    elementary_laws    normal and uniform laws of a quantity or of its logarithm
    levels             levels: which rows of a sample share the value of an input
    named_values       checks of values given by name for the parameters and settings of a model
    dependence         dependent inputs: a Gaussian copula with given rank correlations
    design             a design: the points of the unit cube that a study visits
    law                the base class of all laws of an uncertain parameter
    conditional_draws  dependent inputs drawn given the values of some of them
    designs            the designs by name
    listed_values      laws of listed values
    scipy_laws         the laws of an uncertain parameter
    data_files         columns of numbers named by a study file
    laws               the laws by name
    truncation         a law within the bounds of its parameter
    log_sums           the law of a sum of independent terms
"""
