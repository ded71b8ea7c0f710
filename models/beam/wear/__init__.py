"""Lives of beams whose gaps grow with the impact work.

regimes             the regime of a response that drifts with wear, and its changes
lost_stability      orbits that wear has made unstable
accelerated_life    one life, many times faster than in reality
lives               lifetimes in the limit of slow wear
random_lives        the same under a random load
"""
