"""The averaged theory: at which angle and speed the vibrators run together, by formula.

Read `averaged` first; it solves the torques of `balance`, whose moments come from the `receptance`
of the `linear_machine`, on which `feed` acts as an apparent mass.
"""
