"""Learning from inspections: posterior weights of rows, remaining lives, next inspection.

Reading order; each part imports only those above it:

    inspections        inspections, and how they are read from files and tables
    inspection_log     all inspections of a result, each used once
    importance         rows not drawn from the laws of the study
    worn_depth         the depth worn by a time, between the depths whose lives a result has
    proposal           where to draw new rows
    repetition         one of the independent repetitions of the sampler of new rows
    likelihood         likelihood of an inspection, given the true value of the observable
    observables        quantities that can be inspected, with values in all rows
    dependent_outputs  outputs that depend on an input otherwise than by scaling with it
    integrated_input   the input that only scales lives and is integrated on a grid, not drawn
    unit_likelihood    likelihood of all inspections of a unit
    evidence           evidence of inspections for worlds
    contradiction      inspections that contradict a result, or each other
    cell_ends          ends of the values of the integrated input that inspections allow
    cell_masses        probabilities of the cells of a grid
    scale_quantiles    quantiles of the integrated input in each row
    shared_law         influence of each row on the law of the integrated input
    leave_one_out      rows as units that were not inspected
    rows_as_units      rows that stand for a unit
    posterior          the rows of a result as the inspections leave them
    information_gain   information gain of each inspection, given all others
    posterior_result   the posterior as a result: its rows weighted, with the inspections inside
    prior_predictive   prior-predictive p-value of the inspections
    trust              diagnosis of whether the rows of a result can represent a posterior
    posterior_inputs   inputs before and after the inspections
    epistemic_band     epistemic band of the probability of an end
    remaining_life     remaining lives: of each unit still running, and of units never inspected
    answer             summary of a posterior
    next_inspection    value of the next inspection
"""
