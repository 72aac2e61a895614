"""What one part of a machine feels of what sits at places that it shares with others, beside effects of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from spacerobot.diagnosis.fitting.noise import floor_of
from spacerobot.diagnosis.selection.nested_laws import chance_edge
from spacerobot.diagnosis.selection.shared_sources import ROUNDING
from spacerobot.diagnosis.terms.data import TrialData


@dataclass(frozen=True, eq=False)
class Felt:
    """What numbers of what is at shared places would do for one part. N numbers, S readings.

    Attributes:
        trials: under the weights of its baseline.
        columns: by how much its weighted readings rise with each number, shape (S, N).
        left: what its baseline leaves over, shape (S,), that these would have to bring.
        own: what effects of its own would bring, shape (S, E).
        ways: in which sense each of them can, shape (E,): 1, -1, or 0 in both.
        spent: how many of these were taken out of the rest.
        unit: noise that the weights stand for, in that of the machine's own weights.
    """

    trials: tuple[TrialData, ...]
    columns: np.ndarray
    left: np.ndarray
    own: np.ndarray
    ways: np.ndarray
    spent: int = 0
    unit: float = 1.0

    def floor(self, brought: np.ndarray | float) -> float:
        """By what its weights must fall for chi-squared to count independent readings, with so much brought (S,)."""
        sizes = [t.valid.size for t in self.trials]
        rest = (self.left - brought)[: sum(sizes)]
        parts = np.split(rest, np.cumsum(sizes)[:-1])
        told = floor_of({t.id: p for t, p in zip(self.trials, parts, strict=True)}, self.trials)
        readings = sum(t.samples for t in self.trials)
        exact = ROUNDING * float(np.sqrt(np.mean(self.left**2)))  # readings without noise are no surer than this
        least = max(exact, np.finfo(float).tiny)
        return max(*told.values(), least) * float(np.sqrt(readings / max(readings - self.spent, 1)))

    def squares(self, brought: np.ndarray) -> float:
        """Their sum, of what so much of the numbers, shape (N,), leaves."""
        return float(np.sum((self.left - self.columns @ brought) ** 2))

    def noise(self, brought: np.ndarray) -> float:
        """What is left then if it is noise, in the machine's own weights."""
        return self.unit * self.floor(self.columns @ brought)

    @cached_property
    def beside_own(self) -> Felt:
        """Beside all that the part may lack itself."""
        return self._beside(self.own, self.left, None)

    def beside_shown(self, brought: np.ndarray) -> Felt:
        """Beside those of its own effects alone that show more than chance would, where so much of the numbers, shape
        (N,), is there: what it may lack and does not tells nothing, but would hide as much as it can imitate."""
        left = self.left - self.columns @ brought
        whole = self.beside_own
        noise, shown = whole.floor(whole.columns @ brought), list[int]()
        edge, rest, others = chance_edge(1, self.own.shape[1]), left, self.own / np.linalg.norm(self.own, axis=0)
        while len(shown) < self.own.shape[1]:
            free = np.sum(others**2, axis=0)
            along = others.T @ rest
            gain = np.where(free > ROUNDING, along**2 / np.maximum(free, ROUNDING), 0.0) / noise**2
            gain[along * self.ways < 0.0] = 0.0
            k = int(np.argmax(gain))
            if gain[k] <= edge:
                break
            shown.append(k)
            unit = others[:, k] / np.sqrt(free[k])
            rest, others = rest - unit * (unit @ rest), others - np.outer(unit, unit @ others)
        return self._beside(self.own[:, shown], left, noise)

    def _beside(self, own: np.ndarray, left: np.ndarray, noise: float | None) -> Felt:
        """The same with all taken out that effects of the part's own, shape (S, E), can imitate.

        Where a load and a sensor's scale trade places exactly, the less of them is meant: an effect that explains all
        that is left, shape (S,), costs as much as one reading under this noise; what these effects leave, if None.
        """
        if not own.size:
            return self
        sized = own / np.linalg.norm(own, axis=0)
        basis, size, _ = np.linalg.svd(sized, full_matrices=False)
        basis = basis[:, size > ROUNDING * size[0]]
        noise = self.floor(basis @ (basis.T @ left)) if noise is None else noise
        least = noise / max(float(np.linalg.norm(left)), np.finfo(float).tiny)
        priced = np.concatenate([sized, least * np.eye(own.shape[1])])
        basis = np.linalg.qr(priced)[0]

        def freed(x: np.ndarray) -> np.ndarray:
            longer = np.concatenate([x, np.zeros((own.shape[1], *x.shape[1:]))])
            return np.asarray(longer - basis @ (basis.T @ longer))

        return replace(self, columns=freed(self.columns), left=freed(self.left), own=own, spent=own.shape[1])
