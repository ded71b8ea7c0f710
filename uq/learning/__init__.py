"""Learning from inspections: posterior weights of rows, remaining lives, next inspection.

Reading order; each part imports only those above it:

    inspections        what was measured: the lines of an inspections file
    evidence           what inspections say of worlds, of an input that scales lives in them
    importance         rows not drawn from the laws of the study
    scale_quantiles    quantiles of the integrated input in each row
    worn_depth         the depth worn by a time, between the depths whose lives a result has
    proposal           where to draw new rows
    likelihood         how probable an inspection is, given the true value of what was looked at
    cell_masses        probabilities of the cells of a grid
    cell_ends          where in each row the values of the integrated input begin and end that
    dependent_outputs  outputs that depend on an input otherwise than by scaling with it
    repetition         one of the independent repetitions of the sampler of new rows
    observables        what inspections looked at, in the rows of a result
    shared_law         what each row says of the law of the integrated input
    integrated_input   the input that only scales lives and is integrated on a grid, not drawn
    unit_likelihood    the likelihood of all inspections of a unit, were it each of some rows
    leave_one_out      rows as units that were not inspected
    rows_as_units      rows that stand for a unit
    contradiction      which inspections contradict a result, or each other
    posterior          the rows of a result as the inspections leave them
    prior_predictive   how strange the inspections are before anything is learnt from them
    trust              whether the rows of a result can represent what inspections leave of it
    posterior_result   the posterior as a result: its rows weighted, with the inspections inside
    information_gain   how much each inspection taught: its information gain beside all others
    posterior_inputs   inputs before and after the inspections
    inspection_log     all inspections of a result, each used once
    epistemic_band     how the probability of an end spreads over what units share
    remaining_life     remaining lives: of each unit still running, and of units never inspected
    answer             what the inspections say, as one answer
    next_inspection    what the next inspection is worth: how far it narrows what units share
"""
