"""What share of a balance a pattern explains, where the noise is known and where it is not."""

from __future__ import annotations

import pytest

from spacerobot.diagnosis.locate.located import ALL, Total
from spacerobot.diagnosis.locate.scores import Verdict
from spacerobot.diagnosis.locate.search import Search


@pytest.mark.parametrize(("known", "share"), [(True, 1.0), (False, 0.05)])
def test_noise_that_nobody_states_accounts_for_none_of_what_is_left(known: bool, share: float) -> None:
    """Weights that guess the noise twice too large: a twentieth of what is left is no more than that."""
    search = Search()
    search.totals["command"] = Total("command", "N", chi2=100.0, freedom=400, p=1.0)
    found = Verdict(log_p=-9.0, score=5.0, fall=5.0, coefficient=0.1, error=0.02, p_flips=1e-4, at=float("nan"))
    assert search._row(("command", ALL, "gain"), found, 1e-3, known).share == pytest.approx(share)
