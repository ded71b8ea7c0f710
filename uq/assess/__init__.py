"""What a result says: statistics, lives, regimes, sensitivities, comparison, the answer.

Reading order; each part imports only those above it:

    effects                average slope of an output over an input
    fact                   fact
    joint_bounds           tolerance bounds that hold for several outputs at once
    row_inputs             values of the inputs in each row, with their laws and dependence
    input_changes          differences between two studies of one model
    nested_table           shares of levels in the variance of one number
    random_effects         distribution of the failure probability over shared inputs
    sample                 sample
    design_sample          rows of a result in the layout that a sensitivity method requires
    distinguishing_inputs  inputs and regimes that distinguish the rows that end first from all
    sampled_laws           stated laws and rank correlations of the inputs compared with those
    scale_laws             law of the life of a row given the inputs that are not integrated
    counted_rows           sample of rows of equal weight
    observed_lives         sample of lives known within intervals, or of rows that entered late
    pairing                pair the rows of two results, and correlate their estimates
    targets                targets of sensitivity indices
    integrated_inputs      choose the inputs to integrate exactly, which only scale lives
    weighted_mixture       sample of rows with weights or laws of lives
    chosen_targets         targets that a user names, or that suit a method
    expected_widths        the expected width of the intervals of a study
    reweighting            weights that turn the rows of a result into those of another study
    fleet_units            units of one world
    statistic              a statistic of an output
    sensitivities          sensitivity indices of a result
    failed_rows            bounds of an estimate with the failed rows at best and at worst
    sensitivity_table      sensitivity indices as xarray arrays and as a tree of facts
    stopping               when a run with `until` stops
    fleet_numbers          expected numbers of fleets of one size
    statistics             the statistics of an output: ``table`` lists them
    survival               survival curve of a life
    components_by_level    variance components of outputs
    life_fit               laws fitted to lifetimes
    emulate                emulators: regressions of the outputs of a result
    two_fidelities         estimate from the rows of a result and many more rows of a cheap
    summary                summary of a result
    comparison             compare two studies of one model
    convergence            estimates from growing numbers of rows
    summary_table          summary of a result as a pandas table
    summary_facts          the numbers of summaries, comparisons and levels as trees of facts
    fleet                  fleets of a result
    regimes                regimes compared
    what_if                statistics of a result under other laws of its inputs
    findings               findings
    answer                 the answer of a study
    card_numbers           the numbers of a card
    card                   the card of a result
"""
