"""Lives of beams whose gaps grow with the impact work.

Reading order; a module imports only those above it:

    regimes         the regime of a response that drifts with wear, and its changes
    depths_in_time  how deep each site has worn at given instants
    progress        how far each beam has worn: times, errors and looks noted on the way
    endings         the end of wear
    flows           the gaps grow all the time, where there is no stable orbit
    steps           the gaps grow by a step and are held, near a stable orbit
    rounds          what each beam does next, and what the last round has shown
    worn_beams      many beams, until they are worn down
    lives           their lifetimes
    fitted_wear     the wear of a site along the path, from noisy means
    random_lives    lifetimes under a random load
"""
