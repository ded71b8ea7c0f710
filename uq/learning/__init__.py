"""Learning from inspections: posterior weights of rows, remaining lives, next inspection.

Reading order; each part imports only those above it:

    inspections        inspections, and how they are read from files and tables
    evidence           evidence of inspections for worlds, for an integrated input, and for units
    importance         rows not drawn from the laws of the study
    scale_quantiles    quantiles of the integrated input in each row
    worn_depth         the depth worn by a time, between the depths whose lives a result has
    proposal           where to draw new rows
    likelihood         likelihood of an inspection, given the true value of the observable
    cell_masses        probabilities of the cells of a grid
    cell_ends          where in each row the values of the integrated input begin and end that
    dependent_outputs  outputs that depend on an input otherwise than by scaling with it
    repetition         one of the independent repetitions of the sampler of new rows
    observables        quantities of a result that can be inspected, with values in all its rows
    shared_law         influence of each row on the law of an integrated input that units share
    integrated_input   the input that only scales lives and is integrated on a grid, not drawn
    unit_likelihood    likelihood of all inspections of a unit, for each row that stands for it
    leave_one_out      rows as units that were not inspected
    rows_as_units      rows that stand for a unit
    contradiction      inspections that contradict a result, or each other
    posterior          the rows of a result as the inspections leave them
    prior_predictive   prior-predictive p-value of the inspections
    trust              whether the rows of a result can represent what inspections leave of it
    posterior_result   the posterior as a result: its rows weighted, with the inspections inside
    information_gain   information gain of each inspection, given all others
    posterior_inputs   inputs before and after the inspections
    inspection_log     all inspections of a result, each used once
    epistemic_band     posterior range of the probability of an end over what units share
    remaining_life     remaining lives: of each unit still running, and of units never inspected
    answer             summary of a posterior
    next_inspection    value of the next inspection
"""
