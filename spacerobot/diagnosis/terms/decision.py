"""Every threshold that can change a verdict, by kind, and where its value comes from.

Odds and effect sizes decide; a test of significance alone never does, for in long recordings any harmless defect of a
law is significant. Numerical tolerances stand where they are used.
"""

from __future__ import annotations

# Odds: falls of chi-squared in units of the noise as it is.

PENALTY = 8.0
"""Cost of one effect parameter: the look over forty effects finds a chance fall of chi-squared of this size."""

EARN = 20.0
"""Fall of the penalised cost that an effect must bring, after correction for the noise's level and colour."""

HELD_OFF = (EARN + PENALTY) ** 0.5
"""Standard deviations between what readings say of a believed value and what is stated of it from which giving the
value up earns what an effect must.
"""

MARGIN = 10.0
"""Lead below which two sets cannot be told apart, odds of 150 to 1; and which a set must have over a part of it."""

SLACK = 3.0
"""Cost by which a larger model may exceed a smaller one before the optimiser is blamed."""

FRACTION = 0.25
"""Share of the lead over the nearest rival by which a fit may stop short of the truth: the answer would turn only if
the chosen set's fit stopped short by all of it.
"""

CROWD = 3
"""Effects of the machine, not of its sensors, in one set from which on a single law without a name may be the simpler
story, and is tried; in a set that is not told apart from others, one less. By the price of their parameters (BIC) the
cheaper is said.
"""

# A law's own defects, as shares of what it explains.

SMALL = 1e-3
"""What a richer law in its place, or a further effect beside it, may owe to a law's own small defects: a law that is
wrong by three per cent of its force.
"""

SLIGHT = 0.05
"""That share for a further effect where the simpler set leaves nothing but noise. Between either and what statistics
ask for, the two are not told apart: with many samples a harmless defect of the first law is always significant.
"""

STAND_IN = 1.0 / 64.0
"""What a law's own defect may cost, and so misplace its numbers, where it stands for a richer one: a law wrong by an
eighth of its force. Measured on the sealed servo arms of docs/proof_records.jsonl and of the batch after it: one mode
for seven joints costs up to so much at its true mass and damping in 39 of 40, up to a hundredth in 33.
"""

# Errors on unseen trials, as shares.

WORTH_OF_REST = 0.05
WORTH_OF_BASELINE = 0.02
"""A further parameter must lower the held-out rms by these shares of itself and of the baseline's: an effect size."""

EXACT = 1e-3
"""Share of the mean square that two models leave below which a trial is as good as predicted exactly: the logarithm of
nothing, where a joint or a counter stood still, would outweigh every other trial."""

TIE = 0.01
"""Rivals whose held-out rms differ by less than this share are not told apart."""

MOST_LEFT = 0.5
"""Share of what a name leaves, rms, that a curve at one port must take for a law to be learned where no noise is stated
(more than half is that law's). Curves at the real arms' joints take a third at most (a Staubli's friction by rate).
"""

REPEATS = 2
"""Trials of a part up to which no curve that is not believed takes a name back: two that begin alike repeat whatever is
wrong with them, and a curve of the place foretells that (a ball's two drops from one bridge).
"""

REWORDED = 1e-4
"""Candidates of one size whose held-out rms agree to this share are one model in two wordings."""

AS_GOOD = 1.005
"""Error on unseen trials over the curve's, up to which a formula says as much: half a per cent is a tenth of what 200
independent readings a trial leave uncertain.
"""

SPOKEN = 0.5
"""Of fewer than three telling trials, those that say at least this share of what the clearest says must all agree."""

DOUBT = 0.5
"""Confidence in a choice whose best rival predicts as well as it does."""

# What is left over, against noise.

SIGNIFICANT = 5.0
"""Standard errors of an excess over the noise before contact (of a level, of the autocorrelation from sample to sample)
that are too much."""

GROUP_LIMIT = 6.0
"""The same of one channel of one trial, the worst of many."""

LEVEL_LIMIT = 0.03
"""Excess of chi-squared per sample over the noise that is too much to be ignored, however sure less of it is."""

LOUD = 1.3
"""What is left of a balance is more than noise from so many times on what the stated noise of its sensors makes of it;
less may be rounding, and filters of the loggers."""

QUIET, GOOD_PART = 5.0, 0.1
"""Where no noise is stated something is missing from so many times on what the logs' own scatter makes of a balance, if
it is that share of what is read: sensors err by more than they scatter, models of arms by a few per cent. So many times
the stated noise of readings no name may leave: it explains much, and is not the physics."""

STRIKING = 0.2
"""Share of what a balance leaves over that one pattern must explain to be called a mismatch: an effect size."""

LOCATED = 0.01
"""p below which a pattern in a balance counts as found."""

CHANCE = 0.05
"""Probability with which what means nothing may look like so much."""

# Values, believed and fitted.

MOVED = 3.0
"""Stated sigmas beyond which a believed value counts as wrong."""

FEW = 2
"""Believed values that may well be wrong at once: as likely as one missing effect that explains as much. Where more
would have to be, something is missing that bends them all. A value that stays bent beside named effects counts with
them: of 2,667 sealed campaigns no set was right beside which more were bent than this (0 of 6), and 13 of 13 were where
one effect and one value were meant.
"""

BENT = 0.9
"""How sure that is."""

TWICE = 2.0 / 3.0
"""Difference of two levels over their mean where one is twice the other: friction that is not the same both ways."""

OUTER = 0.5
"""Share of the way that a place went which a stop leaves free: what acts over more of it is a spring, and stands for
any slow defect of a model (a stop of 0.04 rad in a motion of half a radian, of an arm whose links are somewhat off)."""

AT_BOUND = 1e-3
"""Distance from a bound, as a share of it, within which a value sits there: searches stop at a bound to the last
digit, and nothing physical is known to a thousandth of where somebody drew a line."""

MISSED = 6.0
"""Standard errors by which a size may come back wrong from a synthetic copy before its interval is blamed."""

ROUGH = 60.0
"""And by which it may before the fit is: a cost that contacts make jagged has minima beside the one whose curvature and
profile are known. What a copy missed its size by is then the standard error that is stated, and a second copy tries it.
"""
