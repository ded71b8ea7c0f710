"""Learning from inspections: what measurements say of inputs, of units, and of lives to come.

Reading order; a module imports only those above it:

    inspections       what was measured, as lines of a file
    likelihood        how probable an inspection is, given the truth
    worn_depth        the depth worn by a time, between the declared ones
    looks             what was looked at, in the rows of a result
    integrated        the input that only scales lives, integrated on a grid
    importance        rows not drawn from the study's laws, and what they count
    unit_likelihood   all inspections of a unit, were it each of some rows
    evidence          what inspections say of worlds
    drawn_scale       the integrated input as the inspections leave it
    posterior         the rows as the inspections leave them
    trust             whether rows can represent that
    proposal          where to draw new rows if they cannot
    repetition        one independent repetition of the sampler that draws them
    result            the posterior as a result, and the rows of one unit
    ledger            each measurement used once
    inputs_learnt     inputs before and after, and what is confounded
    over_shared       how the probability of an end spreads over what units share
    remaining         lives to come
    taught            how much each inspection taught
    strangeness       how strange the inspections are before anything is learnt
    answer            all that the inspections say
    next_inspection   what the next one is worth
"""
