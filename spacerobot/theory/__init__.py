"""The equations of the paper by number, and the closed forms that contact results are checked against.

The paper is Uyama, N. et al., "Experimental evaluation of contact/impact dynamics between a space robot with
a compliant wrist and a free-flying object", i-SAIRAS 2012. The chain, with its equation numbers:

1. `equations_of_motion`: equivalent mass at the hand (1); hand, wrist, target on two springs (2 to 4);
   `exact` follows them without discretisation, for contacts that can pull and contacts that cannot.
2. `frequencies`: natural frequencies (5; the printed form is wrong, and both are here), of the springs alone
   (6, 7), and their limits (8).
3. `reduction`: one mass m~ on the wrist spring (9 to 11), and the two readings of its damping.
4. `response`: the motion of a hit and its end (12 to 15), and the pull that this end needs.
5. `contact_time` (16) and `restitution` (17 to 19), under both end conditions.
6. `table1`: the rig. `equations`: all numbers, with how sure each one is. `assumptions`: what the chain rests
   on.

Closed forms beyond the paper: `kelvin_voigt`, `hunt_crossley`, `power_law` (Hertz), `coulomb_slider`.
Needs only numpy. Arguments out of range raise ValueError.
"""
