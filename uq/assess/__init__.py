"""What a result says: statistics, lives, regimes, sensitivities, comparison, the answer.

Reading order; each part imports only those above it:

    effects                average slope of an output over an input
    fact                   numbers with their sentence and the functions that computed them
    joint_bounds           tolerance bounds that hold for several outputs at once
    row_inputs             values of the inputs in each row, with their laws and dependence
    input_changes          inputs, settings and design in which two studies of one model differ
    nested_table           shares of levels in the variance of one number
    random_effects         distribution of the failure probability over shared inputs
    sample                 what can be estimated from the rows of an element, whatever their kind
    design_sample          rows of a result in the layout that a sensitivity method requires
    distinguishing_inputs  inputs and regimes that distinguish the rows that end first from all
    sampled_laws           stated laws and rank correlations compared with those of the rows
    scale_laws             law of the life of a row given the inputs that are not integrated
    counted_rows           a sample of rows of equal weight: counts, order statistics, Kaplan-Meier
    pairing                pair the rows of two results, and correlate their estimates
    targets                targets of indices: an output, its logarithm, rank, rate or event, by row
    integrated_inputs      choose the inputs to integrate exactly; `elements_with_laws`
    population             a sample of rows with weights or laws of lives
    chosen_targets         targets that a user names, or that suit a method
    expected_widths        the expected width of the intervals of a study
    reweighting            weights that turn the rows of a result into those of another study
    fleet_units            P(a unit of a world has ended), and the time of the k-th end of a fleet
    statistic              a statistic: its key, its estimate, and how each reader shows it
    sensitivities          sensitivity indices of a result
    failed_rows            bounds of an estimate with the failed rows at best and at worst
    sensitivity_table      sensitivity indices as xarray arrays and as a tree of facts
    stopping               when a run stops: interim estimates at fixed sizes, valid intervals
    fleet_numbers          expected numbers of fleets of one size, with bands over worlds
    statistics             the statistics of an output: ``table`` lists them
    survival               survival curve of a life, with its pointwise and simultaneous bands
    components_by_level    variance components: shared by units, own to each unit, due to chance
    life_fit               Weibull and lognormal laws fitted to lifetimes
    two_fidelities         estimates from the rows and many more rows of a cheap twin
    summary                status and regimes of rows, and the statistics of each output
    comparison             two studies compared: their inputs, the differences of their statistics
    convergence            estimates from growing numbers of rows, and their errors
    summary_table          the summary as a pandas table: outputs in rows, statistics in columns
    summary_facts          summaries, comparisons and variance components as trees of facts
    fleet                  fleets of a result: time of the first end, numbers ended by a time
    regimes                regimes compared: inputs, outputs, boundary, variance between them
    what_if                statistics under other laws of the inputs: the same rows, weighted
    findings               all that tables and figures show of a result, each computed once
    answer                 the answer: what can be promised, what decides it, and what to do
    card_numbers           the numbers of a card: bounds, quantiles and probabilities
    card                   the card of a result: what fits on a screen
"""
