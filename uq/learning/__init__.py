"""Learning from inspections: posterior weights of rows, remaining lives, next inspection.

Reading order; each part imports only those above it:

    inspections        inspections, and how they are read from files and tables
    evidence           evidence of inspections for worlds
    importance         rows not drawn from the laws of the study
    worn_depth         the depth worn by a time, between the depths whose lives a result has
    proposal           where to draw new rows
    scale_quantiles    quantiles of the integrated input in each row
    likelihood         likelihood of an inspection, given the true value of the observable
    cell_ends          ends of the values of the integrated input that inspections allow
    cell_masses        probabilities of the cells of a grid
    dependent_outputs  outputs that depend on an input otherwise than by scaling with it
    repetition         one of the independent repetitions of the sampler of new rows
    observables        observables
    shared_law         influence of each row on the law of the integrated input
    integrated_input   the input that only scales lives and is integrated on a grid, not drawn
    unit_likelihood    likelihood of all inspections of a unit
    contradiction      inspections that contradict a result, or each other
    leave_one_out      rows as units that were not inspected
    rows_as_units      rows that stand for a unit
    posterior          the rows of a result as the inspections leave them
    information_gain   information gain of each inspection, given all others
    posterior_result   the posterior as a result: its rows weighted, with the inspections inside
    prior_predictive   prior-predictive p-value of the inspections
    trust              diagnosis of whether the rows of a result can represent a posterior
    inspection_log     all inspections of a result, each used once
    posterior_inputs   inputs before and after the inspections
    epistemic_band     epistemic band of the probability of an end
    remaining_life     remaining lives: of each unit still running, and of units never inspected
    answer             summary of a posterior
    next_inspection    value of the next inspection
"""
