"""The answer of a study: tolerance bounds, main drivers, and what to do.

Reading order; each part imports only those above it:

    wording            inputs and outputs in words
    compared_indices   index of each input, with the half-width of its difference from another
    earliest           the rows that end first, their distinguishing inputs and regimes
    limits             ranges of the leading input in which the unwanted side of an event is
    tolerance_bound    tolerance bound of an output, and its likely range
    contributions      shares of single inputs and groups, with directions, sizes and sentences
    bound_choice       choose the bound, or quantiles in its place
    tolerance_effects  effect of a tighter tolerance on one statistic, before and after
    rankings           ranking of inputs by their contribution to a target, with its sentences
    events             probabilities of the events that a study asks about
    leading_level      variance components by level, and the level with most of the variance
    repeat_interval    prediction interval of an estimate for a repeat of the study with
    quantities         the answer for each element of an output
    sufficiency        sufficiency of the sample size
    piece_of_advice    a piece of advice
    answer_sentences   the answer in sentences and as a tree of facts
    tightening         effects of halving the scatter of inputs, by importance weights
    advice             advice by rules: mend, add rows, measure, tighten, or nothing
    answer             the answer of a study, computed once from its assessments
"""
