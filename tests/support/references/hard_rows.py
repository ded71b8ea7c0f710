"""Rows on which careless numbers are wrong, with what an independent computation gives."""

STEPPED = {
    "flexural_rigidity": 15.124389425071051,
    "mass_per_length": 0.7096588966058243,
    "length": 0.64,
    "lateral_support_stiffness": 509655.13934131776,
    "rotational_support_stiffness": 476.5556142134245,
    "contact_stiffness": 12908.49454992706,
    "mass_damping": 4.998983905862822,
    "stiffness_damping": 8.984402391711075e-06,
    "force_amplitude": 6.083793062059125,
    "initial_gap": 0.0002507538923479988,
    "forcing_frequency": 32.404504319286346,
}
"""On a periodic orbit, steps of the fast propagator are felt: 66.02658 and 64.93068 mW."""

TRANSIENT = {
    "flexural_rigidity": 16.190230964110246,
    "mass_per_length": 0.7856907343390646,
    "length": 0.6698692095259046,
    "lateral_support_stiffness": 158790.60630717175,
    "rotational_support_stiffness": 489.9200393007782,
    "contact_stiffness": 17355.31911052753,
    "mass_damping": 0.2440592043046072,
    "stiffness_damping": 6.165491287688396e-07,
    "force_amplitude": 4.508046216947531,
    "initial_gap": 0.000296828068216953,
    "forcing_frequency": 22.250885426295625,
}
"""Rattles for more than 4000 periods before it comes to rest between the stops."""

GRAZING = {
    "flexural_rigidity": 11.346301023550934,
    "mass_per_length": 0.792605743176074,
    "length": 0.6299383121503902,
    "lateral_support_stiffness": 205014.74576281,
    "rotational_support_stiffness": 452.3338641735332,
    "contact_stiffness": 12555.429682095471,
    "mass_damping": 1.93977347523968,
    "stiffness_damping": 9.511912763518486e-06,
    "force_amplitude": 0.2968690635872462,
    "initial_gap": 0.00017619127418075736,
    "forcing_frequency": 15.284488083450306,
}
"""Three responses from starts a hair apart; from rest, `exact` comes to 4.49 and 4.79 mW."""

SWITCHING = {
    "flexural_rigidity": 16.71168718741212,
    "mass_per_length": 0.8314880375504374,
    "length": 0.7026825238355952,
    "lateral_support_stiffness": 167008.60055490787,
    "rotational_support_stiffness": 630.3635527964735,
    "contact_stiffness": 12657.094082516141,
    "mass_damping": 1.7802155659439085,
    "stiffness_damping": 1.476910231996747e-05,
    "force_amplitude": 5.8933821123765835,
    "initial_gap": 0.00025193654559998253,
    "forcing_frequency": 6.806813388153093,
}
"""Dwells for thousands of periods in one of two states, 37.8 and 50 mW; the mean is some 42 mW."""

DELAYED = {
    "flexural_rigidity": 14.796984484925424,
    "mass_per_length": 0.6855149554863037,
    "length": 0.64,
    "lateral_support_stiffness": 250631.48255586112,
    "rotational_support_stiffness": 529.4024847819575,
    "contact_stiffness": 12143.957433033454,
    "mass_damping": 1.049026745232819,
    "stiffness_damping": 3.0301530142559724e-05,
    "force_amplitude": 6.085520627366001,
    "initial_gap": 0.000278230690751726,
    "forcing_frequency": 32.291460710059006,
}
"""Loses the stability of its orbit on the way: 858032 and 1286817 s to 125 and 250 um."""

LIGHT = {
    "length": 0.6573167532903915,
    "flexural_rigidity": 14.274560106838022,
    "mass_per_length": 0.6940185757018333,
    "lateral_support_stiffness": 257276.3220206441,
    "rotational_support_stiffness": 235.68159610739062,
    "contact_stiffness": 12388.780311147055,
    "force_amplitude": 6.816074018969023,
    "forcing_frequency": 27.66656661656863,
    "initial_gap": 0.00029112362147372514,
    "gap_asymmetry": -0.5743009783507685,
    "mass_damping": 0.29380787768098676,
    "stiffness_damping": 3.869572200914478e-06,
}
"""Lightly damped. A hair of the start decides between orbits of two periods, of 429.8 and 213.8 mW,
each other's mirror images, and an aperiodic motion of 87 mW."""
