"""Parts of the documentation that the code itself writes, as Markdown."""

from spacerobot.view.docs.api import api
from spacerobot.view.docs.effects import effects
from spacerobot.view.docs.equations import assumptions, equations
from spacerobot.view.docs.formats import scene_file, verdict_file

GENERATED = {
    "api": api,
    "assumptions": assumptions,
    "effects": effects,
    "equations": equations,
    "scene_file": scene_file,
    "verdict_file": verdict_file,
}
"""Name in a page -> what writes it."""
