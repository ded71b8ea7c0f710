"""The answer of a study: what can be promised, what decides it, and what to do.

Reading order; each part imports only those above it:

    wording             inputs and elements by their names
    measured_indices    the index of each input, and what tells it from the others
    sources             how well a number is known, according to its source
    contributions       what inputs contribute
    limits              in which range of the input that decides an event the unwanted side is
    earliest            which rows end first, and what distinguishes them
    tolerance_bound     what can be promised of an output, and its likely range
    regime_mixing       whether the regimes are intermingled
    halved_scatter      laws with half their scatter
    number_targets      what a number of a result is about, by the name that a person reads
    assumptions         what an answer rests on without a measurement
    levels              which level decides
    promised_bounds     which bounds of an output are promised
    repeat_interval     what the same study with another seed would most likely find
    remedies            what could be done
    solver_error        what the numerical error of the rows themselves would do to a promise
    rankings            which inputs contribute most to a target
    parts               what is said of an event and of a quantity
    tighter_tolerances  tighter tolerances
    sample_size         what is not settled, and how many rows would settle it
    quantities          what can be promised of an output, its likely range
    sufficiency         whether the rows are enough for what the study is about
    facts               the answer as a whole: its parts in the order in which they are read
    answer_json         the answer as the command line prints it with ``--json``
    advice              what to do, by rules: mend, add rows, measure, tighten, or nothing
    answer              the answer of a study, computed once from what is known of its result
    verdict             whether the rows are enough for all that a study asks, in sentences
"""
