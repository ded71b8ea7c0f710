"""The answer of a study: tolerance bounds, main drivers, and advice.

Reading order; each part imports only those above it:

    wording             inputs and outputs in words
    measured_indices    index of each input, and its separation from the others
    contributions       contributions of inputs
    earliest            the rows that fail first, and their distinguishing inputs
    limits              ranges of the leading input in which the unwanted side is rare on
    tolerance_bound     tolerance bound that can be promised of an output, and its likely range
    levels              variance components by level, and the uncertainty exponent of regimes
    promised_bounds     promised bounds of an output
    repeat_interval     prediction interval
    parts               events and quantities of an answer, with their sentences
    rankings            ranking of inputs for a target; indistinguishable inputs are grouped
    sufficiency         sufficiency of the rows
    quantities          quantities of an answer: promises, likely ranges, and probabilities
    remedies            remedies: effects of a tighter tolerance, and each piece of advice
    study_answer        the answer of a study
    tighter_tolerances  tighter tolerances
    advice              advice by rules: mend, add rows, measure, tighten, or nothing
    answer              the answer of a study, computed once from its assessments
"""
