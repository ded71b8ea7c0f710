"""What a result says: statistics, lives, regimes, sensitivities, comparison, the answer.

Reading order; each part imports only those above it:

    fact                  facts of a result: numbers, sentence and estimators in a tree
    effects               average effects of inputs
    event_curve           the probability of an event over an input
    independent_inputs    the inputs of a result with a law of their own
    joint_bounds          tolerance bounds that hold for several outputs at once
    solver_error          effect of stated errors of rows on their values and scatter
    input_changes         differences between two studies of one model: inputs, settings, design
    row_inputs            the uncertain inputs of some rows
    random_effects        distribution of the failure probability over shared inputs
    scale_laws            the law of a life in each row
    regime_switching      probability that a repeat of the same unit ends in another regime
    variance_by_level     one table of numbers apportioned to levels
    ranked_indices        the indices of a target as the lines of a table that ends with inputs
    transforms            transforms of outputs whose own variance is not informative
    design_sample         the sample of a sensitivity method
    earliest              distinguishing inputs of the rows that end first
    sampled_inputs        the laws and rank correlations of the inputs
    densities             ratio of the densities of inputs under two studies
    posterior_scale       the law of a life in each row
    conditional_survival  the law of a life in each row
    scaling               inputs of a result that only scale a life
    reweighting           the rows of a result as those of another study
    scaling_by_level      exactly known variance of lives from inputs that only scale them
    estimators            estimators: the rows that take part, and the influence of each
    sample                a sample
    targets               targets of sensitivity indices: one number per row
    expected_widths       the expected width of the intervals of a study, from a few of its rows
    few_events            events that happen, or do not, in few rows
    joint_targets         all elements of an output as one target
    chosen_targets        targets that a user names, or that suit a method
    counted_rows          rows that count alike
    population            probabilities and quantiles of a population
    fleets                fleets: units of one world, and how many of them have ended
    sensitivities         sensitivity indices of a whole result, by every method
    pairing               pairing of the rows of two results
    statistic             a statistic of an output
    sensitivity_json      sensitivity indices as a tree of facts
    sensitivity_table     sensitivity indices as arrays
    stopping              when a run may stop
    failed_rows           bounds of an estimate with the failed rows at best and at worst
    stopping_status       status of a run that may stop
    fleet_numbers         the numbers of fleets of one size
    statistics            the statistics of an output: ``table`` lists them
    survival              lifetimes: the probability of a longer life than each time
    level_shares          shares of the variance
    life_fit              Weibull and lognormal laws fitted to lifetimes
    two_fidelities        two fidelities
    level_table           variance shares by level as a Dataset
    fit_table             laws fitted to a lifetime as a table
    summary               the summary of a result
    convergence           convergence
    differences           differences between the statistics of two results
    fleet                 fleets
    summary_table         the summary of a result as a table
    running_estimates     running estimates of each output, and the errors of all rows
    comparison            two studies of one model
    summary_json          the numbers of summaries, comparisons and levels as trees of facts
    regime_boundary       the boundary between the regimes of a result
    findings              a result and what several tables and figures show of it
    regimes               the regimes of a result compared
    fleet_json            numbers of fleets as a tree of facts
    what_if               a result under other laws of its inputs: the same rows, weighted
    answer                the answer of a study
"""
