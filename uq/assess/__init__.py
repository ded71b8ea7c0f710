"""Analysis of a result: statistics, lives, regimes, sensitivities, comparison, the answer.

Reading order; each part imports only those above it:

    effects            effects of an input on an output
    fact               facts of a result
    joint_bounds       tolerance bounds that hold for several outputs at once
    row_inputs         the inputs of rows: values, the laws that these follow, and dependence
    input_changes      differences between two studies of one model: inputs, settings, design
    sample             a sample
    random_effects     distribution of the failure probability over shared inputs
    variance_by_level  one table of numbers apportioned to levels
    design_sample      the sample of a sensitivity method
    earliest           distinguishing inputs of the rows that fail first
    sampled_inputs     the laws and rank correlations of the inputs
    scale_laws         conditional law of the life of each row
    counted_rows       rows that count alike, each with the value or the life that was computed
    pairing            pairing of the rows of two results
    targets            targets of sensitivity indices
    scaling            inputs of a result that only scale a life
    population         probabilities and quantiles of a population
    chosen_targets     targets that a user names, or that suit a method
    expected_widths    the expected width of the intervals of a study, from a few of its rows
    reweighting        the rows of a result as those of another study
    fleets             fleets: units with shared inputs, and the number that have failed
    statistic          a statistic of an output
    sensitivities      sensitivity indices of a result, by every method
    failed_rows        bounds of an estimate with the failed rows at best and at worst
    sensitivity_table  sensitivity indices as arrays and as a tree of facts
    stopping           when a run may stop
    fleet_numbers      numbers of fleets of one size
    statistics         the statistics of an output: ``table`` lists them
    survival           lifetimes: the probability of a longer life than each time
    level_shares       shares of the variance
    life_fit           Weibull and lognormal laws fitted to lifetimes
    two_fidelities     two fidelities
    summary            the summary of a result
    comparison         two studies of one model: what was changed, and how their outputs differ
    convergence        convergence
    summary_table      the summary of a result as a table
    summary_facts      the numbers of summaries, comparisons and levels as trees of facts
    fleet              fleets
    regimes            the regimes of a result compared
    what_if            a result under other laws of its inputs: the same rows, weighted
    findings           a result and what several tables and figures show of it
    answer             the answer of a study
"""
