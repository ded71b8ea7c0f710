"""The file of a result and its elements, weights, and rows that belong together.

Reading order; each part imports only those above it:

    commands       arguments of commands on a result
    element        one element of an output: one plain array, with the outcome of every row
    nesting        samples, units and repeats: which rows of a result belong together
    variables      the variables of a result and their attributes
    one_row        one row of a model as plain numbers, without a Dataset
    ranked_rows    the rows by which inputs are ranked: a part of a large plain design
    weights        rows that inspections have weighted
    sound_values   checks that the values of a result are possible
    sound_weights  checks of weights and attributes that inspections have left in a result
    soundness      checks of a Dataset that may be damaged or come from an untrusted file
    result_file    the schema of a result
    elements       the elements of a result's outputs
    workload       rows of one model that are to be computed, by a study or any other analysis
    preview        a preview of the rows of a run as they arrive
    result         a result
    row_choice     choice of a row
    stored_row     a row of a result as plain numbers, as the result describes it
"""
