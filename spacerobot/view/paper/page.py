"""The paper's page: one HTML file that needs no other, with every figure inside."""

from __future__ import annotations

from importlib.resources import files

from jinja2 import Environment, StrictUndefined
from matplotlib.figure import Figure

from spacerobot import __version__
from spacerobot.theory import assumptions, equations, table1
from spacerobot.view.paper.data import TABLE1_HEADER, PaperData, table1_rows
from spacerobot.view.paper.trials import SPEED_SCATTER
from spacerobot.view.plotting import svg_uri


def page(data: PaperData, figures: dict[str, Figure]) -> str:
    """The page as HTML text.

    Args:
        data: all results.
        figures: by the names of `figures.FIGURES`.
    """
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(
        files("spacerobot.view").joinpath("templates/paper.html").read_text(encoding="utf-8")
    )
    keys = list(data.findings)
    return template.render(
        d=data,
        images={name: svg_uri(figure) for name, figure in figures.items()},
        table1_header=TABLE1_HEADER,
        table1_rows=table1_rows(),
        contact_damping=table1.CONTACT_DAMPING,
        scatter=SPEED_SCATTER,
        assumptions=assumptions.ASSUMPTIONS,
        chosen=(keys[0], keys[-1]),
        equations=equations.EQUATIONS,
        version=__version__,
    )
