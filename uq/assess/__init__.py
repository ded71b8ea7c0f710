"""What a result says: statistics, lives, regimes, sensitivities, comparison, the answer.

Reading order; each part imports only those above it:

    independent_inputs    the inputs of a result with a law of their own
    joint_bounds          tolerance bounds that hold for several outputs at once
    regime_switching      how likely a repeat of the same unit ends in another regime
    targets               targets of sensitivity indices
    variance_by_level     one table of numbers apportioned to levels
    input_changes         differences between two studies of one model: inputs, settings, design
    row_inputs            the uncertain inputs of some rows
    scale_laws            the law of a life in each row
    effects               average effects of inputs
    random_effects        how the probability of a unit's life spreads over worlds
    event_curve           the probability of an event over an input
    ranked_indices        the indices of a target as the lines of a table that ends with inputs
    solver_error          what the errors that a model states for its rows do to their values
    design_sample         the sample of a sensitivity method
    sampled_inputs        the laws and rank correlations of the inputs
    earliest              what distinguishes the rows that end first
    joint_targets         all elements of an output as one target
    expected_widths       the expected width of the intervals of a study, from a few of its rows
    few_events            events that happen, or do not, in few rows
    densities             how much denser the inputs of some rows are under another study
    posterior_scale       the law of a life in each row
    chosen_targets        which targets a user means
    conditional_survival  the law of a life in each row
    scaling               which inputs of a result only scale a life
    sensitivities         which inputs explain the scatter of an output
    population            probabilities and quantiles of a population
    scaling_by_level      what only scales a life, level by level
    reweighting           the rows of a result as those of another study
    sensitivity_table     sensitivity indices as arrays
    sensitivity_json      sensitivity indices as the command line prints them with ``--json``
    estimators            estimators: the rows that take part, and the influence of each
    fleets                fleets: units of one world, and how many of them have ended
    statistic             a statistic of an output
    pairing               how the rows of two results are paired
    failed_rows           bounds of an estimate with the failed rows at best and at worst
    survival              lifetimes: the probability of a longer life than each time
    fleet_numbers         the numbers of fleets of one size
    life_quantiles        times by which a given share of rows has ended
    stopping              when a run may stop
    life_fit              Weibull and lognormal laws fitted to lifetimes
    statistics            the statistics of an output: ``table`` lists them
    stopping_status       what is said of a run that may stop
    fit_table             laws fitted to a lifetime as a table
    two_fidelities        two fidelities
    level_shares          shares of the variance
    summary               the summary of a result
    level_table           shares of the variance by level as a Dataset to display and to
    summary_table         the summary of a result as a table to display and to compute with
    convergence           convergence
    differences           differences between the statistics of two results
    regime_boundary       how intermingled the regimes of a result are
    fleet                 fleets
    running_estimates     running estimates, each with the numbers of samples that it comes from
    comparison            two studies of one model
    regimes               the regimes of a result compared
    findings              a result and what several tables and figures show of it
    summary_json          what results say, as the command line prints it with ``--json``
    fleet_json            numbers of fleets as the command line prints them with ``--json``
    what_if               what a result would say if its inputs followed other laws
    answer                the answer of a study
"""
