"""The file of a result and its elements, weights, and rows that belong together.

Reading order; each part imports only those above it:

    nesting        samples, units and repeats: which rows of a result belong together
    variables      the variables of a result and their attributes
    element        one element of an output: one plain array, with the outcome of every row
    commands       what commands on a result are given
    ranked_rows    the rows by which inputs are ranked: some of a large plain design
    weights        rows that inspections have weighted
    sound_values   whether the values of a result are possible: no run leaves others behind
    one_row        one row of a model as plain numbers, without a Dataset
    sound_weights  whether what inspections have left in a result is sound
    soundness      whether a Dataset is a sound result
    result_file    the schema of a result
    stored_row     a row of a result as plain numbers, as the result describes it
    elements       the elements of a result's outputs, and what the result says of its rows
    workload       rows of one model that are to be computed, by a study or any other analysis
    regimes        the rows of a result that are in one regime
    row_choice     which row of a result
    preview        a preview of the rows of a run as they arrive
"""
