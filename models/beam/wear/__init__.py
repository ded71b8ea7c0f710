"""Lives of beams whose gaps grow with the impact work.

Reading order; a module imports only those above it:

    regimes             the regime of a response that drifts with wear, and its changes
    lost_stability      orbits made unstable by wear
    growth              growth of the gaps, and its record
    accelerated_life    one life, many times faster than in reality
    extrapolation       the limit of ever slower lives
    lives               lifetimes in that limit
    fitted_wear         the wear of a site along the path, from noisy means
    random_lives        lifetimes under a random load
"""
