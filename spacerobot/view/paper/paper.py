"""The paper's table, figures and findings: the front door."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from spacerobot.support.errors import NotFoundError
from spacerobot.support.files import write_text
from spacerobot.theory.table1 import EQUIVALENT_DAMPING
from spacerobot.view.paper.data import PaperData, compute
from spacerobot.view.paper.figures import FIGURES
from spacerobot.view.paper.page import page


@dataclass(frozen=True, eq=False)
class Paper:
    """Everything that the paper's page shows.

    Attributes:
        data: theory, simulated trials and checks.
    """

    data: PaperData

    def __repr__(self) -> str:
        return f"Paper({len(self.data.conditions)} conditions; figures {', '.join(FIGURES)})"

    @property
    def names(self) -> tuple[str, ...]:
        """Of the figures."""
        return tuple(FIGURES)

    def figure(self, name: str) -> Figure:
        """One of the figures.

        Raises:
            NotFoundError: no such figure.
        """
        if name not in FIGURES:
            raise NotFoundError("figure", name, FIGURES)
        return FIGURES[name](self.data)

    def write(self, path: str | Path) -> Path:
        """The page as one HTML file, whole or not at all."""
        write_text(Path(path), page(self.data, {name: self.figure(name) for name in FIGURES}))
        return Path(path)


def paper(seed: int = 0, equivalent_damping: float = EQUIVALENT_DAMPING) -> Paper:
    """The paper's conditions, from theory and simulated trials; some ten seconds.

    Args:
        seed: of the trials' scatter.
        equivalent_damping: c_eq of the guide [N s/m].
    """
    return Paper(compute(seed, equivalent_damping))
