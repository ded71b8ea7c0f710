"""The answer of a study: what can be promised, what decides it, and what to do.

Reading order; each part imports only those above it:

    sources             quality of the source of a number: measured, assumed, or chosen
    wording             inputs and elements by their names
    measured_indices    index of each input, and its separation from the others
    assumptions         assumptions of an answer: laws and values without a measurement
    contributions       contributions of inputs
    earliest            the rows that end first, and their distinguishing inputs
    halved_scatter      laws with half their scatter
    limits              ranges of the deciding input in which the unwanted side is rare on
    number_targets      the subject of a number of a result, by the name that a person reads
    regime_mixing       intermingled regimes
    tolerance_bound     tolerance bound that can be promised of an output, and its likely range
    levels              variance components
    promised_bounds     the promised bounds of an output
    repeat_interval     prediction interval
    solver_error        effect of the numerical error of rows on a promise, in words
    rankings            ranking of inputs for a target; indistinguishable inputs are grouped
    parts               events and quantities of an answer, with their sentences
    quantities          quantities of an answer: promises, likely ranges, and probabilities
    sample_size         sample size that settles an answer: intervals narrow as one over root n
    remedies            remedies: effects of a tighter tolerance, and each piece of advice
    tighter_tolerances  tighter tolerances
    sufficiency         sufficiency of the rows for the subject of a study
    facts               the answer as a whole: its parts in the order in which they are read
    advice              advice by rules: mend, add rows, measure, tighten, or nothing
    answer              the answer of a study, computed once from what is known of its result
    verdict             verdict on the number of rows, in sentences
"""
