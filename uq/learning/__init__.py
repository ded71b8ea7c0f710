"""Learning from inspections: posterior weights of rows, remaining lives, next inspection.

Reading order; each part imports only those above it:

    inspections       inspections
    importance        importance weights of rows that were not drawn from the laws of the study
    proposal          adaptive importance sampling of new rows
    likelihood        likelihood of an inspection, given the true value of the observable
    observables       observables
    integrated_input  integrated input
    unit_likelihood   likelihood of all inspections of a unit, for each row that represents it
    evidence          marginal likelihood of the inspections, by world
    scale_posterior   posterior of the integrated input in each row
    rows_as_units     weighted rows that represent a unit
    posterior         the posterior of a result
    posterior_checks  checks of a posterior
    posterior_result  the posterior as a result: its rows weighted, with the inspections inside
    posterior_inputs  prior and posterior of the inputs
    remaining_life    remaining lives of units still running and of units never inspected
    answer            summary of a posterior
    next_inspection   value of the next inspection
"""
