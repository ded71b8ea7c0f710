"""The answer of a study: what can be promised, what decides it, and what to do.

Reading order; a module imports only those above it:

    sources         how well a number is known
    words           inputs and elements by their names, numbers in a person's units
    targets         what a number of a result is about, by the name that a person reads
    promises        what can be promised of an output, and its likely range
    bounds          which bounds of an output are promised
    contributions   what inputs contribute, with direction and size
    repeated        what the same study with another seed would most likely find
    remedies        what a tighter tolerance would change, and each piece of advice
    limits          from which value of an input an event is rare
    earliest        which rows end first, and what distinguishes them
    parts           what is said of an event and of a quantity, each sentence from its numbers
    measured        the index of each input, and what tells it from the others
    rankings        which inputs contribute most, with direction and size
    quantities      what can be promised of an output, its range and its probabilities
    settling        what is not settled, and how many rows would settle it
    enough          whether the rows are enough for what the study is about
    deciding        which level decides: what units share, each one's own, or chance
    whole           the answer as a whole
    halving         laws with half their scatter, and in words
    tightening      what a tighter tolerance would change, from the rows that exist
    tolerances      which tolerance to tighten
    advice          what to do, by rules
    answer          all of it, of a result
    verdict         whether the rows are enough for all that the study asks
    as_json         its numbers in plain data, sentence by sentence
    keyed           its sentences as HTML, each with the keys of its numbers
    folds           what is secondary, to be unfolded
    page            the answer as HTML
"""
