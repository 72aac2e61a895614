"""What the documentation takes from the code is there, whole, and typeset."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

import spacerobot
from spacerobot.effects.registry import all_effects
from spacerobot.theory.equations import EQUATIONS
from spacerobot.view.docs import GENERATED
from spacerobot.view.docs.effects import ports
from spacerobot.view.report.formula import mathml

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_the_catalogue_names_every_effect_and_parameter() -> None:
    text = GENERATED["effects"]()
    for name, one in all_effects().items():
        assert f"### `{name}`" in text
        assert one.formula in text
        for parameter in one.parameters:
            assert f"| `{parameter.name}` | {parameter.unit} |" in text


@pytest.mark.parametrize("name", sorted(all_effects()))
def test_every_formula_is_typeset(name: str) -> None:
    assert str(mathml(all_effects()[name].formula)).startswith("<math")


def test_ports_are_those_of_the_mechanism() -> None:
    assert ports(all_effects()["coulomb_friction"])[0] == "wrist"
    assert "joint.NAME" in ports(all_effects()["viscous_friction"])
    assert ports(all_effects()["hidden_oscillator"]) == ("target",)


def test_equations_have_their_numbers_and_their_code() -> None:
    text = GENERATED["equations"]()
    for equation in EQUATIONS:
        assert re.search(rf"^\| {equation.number} \| .* \| `spacerobot.theory.{equation.where}` \|", text, re.MULTILINE)


def test_the_api_has_every_public_name() -> None:
    text = GENERATED["api"]()
    for name in spacerobot.__all__:
        assert name == "__version__" or re.search(rf"^::: spacerobot\.[\w.]+\.{name}$", text, re.MULTILINE)


def test_pages_ask_for_parts_that_exist() -> None:
    asked = {
        m for page in DOCS.glob("*.md") for m in re.findall(r"^<!-- generated: (\w+) -->$", page.read_text(), re.M)
    }
    assert set(GENERATED) <= asked <= {*GENERATED, "commands"}


def test_the_scene_file_of_the_page_can_be_read() -> None:
    from spacerobot.simulation.scene_file import scene_from_text

    text, _, further = GENERATED["scene_file"]().removeprefix("```toml\n").partition("\n```")
    assert scene_from_text(text, where="docs").robot == "pa10_wrist"
    assert "# N s/m" in text
    assert "| `servo.stiffness` | N m/rad or N/m |" in further


def test_what_is_read_in_the_checkout_is_current() -> None:
    """In a process of its own: other tests add effects to this one's catalogue."""
    if sys.version_info[:2] != (3, 11):
        pytest.skip("argparse breaks its lines otherwise in another Python")
    script = DOCS / "hooks" / "generated.py"
    said = subprocess.run([sys.executable, str(script), "--check"], capture_output=True, text=True, check=False)
    assert said.returncode == 0, said.stderr
    for name in ("effects.md", "commands.md"):
        assert len((DOCS / name).read_text(encoding="utf-8").splitlines()) > 200


def test_a_page_that_is_not_current_is_found(tmp_path: Path) -> None:
    """The mark takes whatever stood there before, and what is written is taken again."""
    spec = importlib.util.spec_from_file_location("generated", DOCS / "hooks" / "generated.py")
    assert spec is not None
    assert spec.loader is not None
    hook = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(hook)
    bare = "# A page\n\n<!-- generated: equations -->\n\nafter\n"
    once = hook.held(bare)
    assert hook.held(once) == once != bare
    assert hook.held(once.replace("| Eq", "| No")) == once
    assert hook.on_page_markdown(once) == hook.on_page_markdown(bare)
