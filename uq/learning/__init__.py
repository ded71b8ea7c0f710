"""Learning from inspections: posterior weights of rows, remaining lives, next inspection.

Reading order; each part imports only those above it:

    inspections       inspections: read from files and tables, each of a result used once
    importance        rows not drawn from the laws of the study
    proposal          where to draw new rows
    likelihood        likelihood of an inspection, given the true value of the observable
    observables       observables
    integrated_input  the input that only scales lives and is integrated on a grid, not drawn
    unit_likelihood   likelihood of all inspections of a unit
    evidence          evidence of inspections for worlds
    scale_posterior   posterior of the integrated input in each row
    rows_as_units     rows that stand for a unit
    posterior         the posterior of a result
    posterior_checks  checks of a posterior
    posterior_result  the posterior as a result: its rows weighted, with the inspections inside
    posterior_inputs  inputs before and after the inspections
    remaining_life    remaining lives: of each unit still running, and of units never inspected
    answer            summary of a posterior
    next_inspection   value of the next inspection
"""
