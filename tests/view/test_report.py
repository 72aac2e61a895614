"""The report of a diagnosis: what it says of each kind of verdict, and that it can be opened anywhere."""

from __future__ import annotations

import base64
import copy
import functools
import hashlib
import itertools
import json
import re
from html.parser import HTMLParser
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from helpers_report import DELAY, KINDS, SIGMA, STIFFNESS, evidence, verdict

from spacerobot.support.errors import InputError
from spacerobot.view.report import write_plots, write_report
from spacerobot.view.report.evidence import read_evidence
from spacerobot.view.report.page import page
from spacerobot.view.report.story import tell
from spacerobot.view.report.traces_json import embedded

_VOID = {"meta", "link", "input", "br", "img", "hr"}


class Page(HTMLParser):
    """Reads a page strictly: every element closed in order, and what a test wants to know of it."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.faults: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.script: list[str] = []
        self.shown: list[str] = []
        self.feed(text)
        self.close()
        self.faults += [f"<{tag}> never closed" for tag in self.open]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        names = [name for name, _ in attrs]
        if len(names) != len(set(names)):
            self.faults.append(f"<{tag}> has an attribute twice")
        self.elements.append((tag, dict(attrs)))
        if tag not in _VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"</{tag}> closes something else")

    def handle_data(self, data: str) -> None:
        here = self.open[-1] if self.open else ""
        if here == "script":
            self.script.append(data)
        elif here != "style":
            self.shown.append(data)

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.shown))

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


def report(folder: Path, told: dict[str, Any], shown: dict[str, Any] | None = None) -> str:
    path = folder / "report.html"
    write_report(told, evidence() if shown is None else shown, path)
    return path.read_text(encoding="utf-8")


@functools.cache
def plain(kind: str) -> str:
    """The page of a verdict as it comes, made once for all that only read it."""
    with TemporaryDirectory() as folder:
        return report(Path(folder), verdict(kind))


@pytest.fixture(scope="module")
def plots(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """The plots of a verdict as it comes: their folder and their names."""
    folder = tmp_path_factory.mktemp("plots")
    return folder, write_plots(verdict("named"), evidence(), folder)


SAYS = {
    "named": "The model lacks Coulomb friction in the wrist's guide, 0.604 N (95 %: 0.585 to 0.623)",
    "ambiguous": "these data cannot tell which: Coulomb friction in the wrist's guide or Stribeck friction",
    "unknown": "no effect of the catalogue explains",
    "nothing_missing": "Nothing is missing that these data could show",
    "learned": "What is missing is a force that depends on its rate, at the wrist: learned from the recordings",
    "wrong_parameter": "wrist stiffness is 561.3 N/m (95 %: 559.0 to 563.6), not 530 N/m, 5.9 of its stated sigmas",
    "not_trusted": "No answer: the fit failed its own checks: starts agree",
}


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_of_verdict_is_told_in_its_own_words(kind: str) -> None:
    page = Page(plain(kind))
    text = page.text.replace("\u00a0", " ")
    assert SAYS[kind] in text
    assert not any(other in text for name, other in SAYS.items() if name != kind)
    assert text.index(SAYS[kind]) < text.index("Located:") < text.index("Rivals:") < text.index("Limits:")


def test_wrong_values_may_be_one_of_the_explanations(tmp_path: Path) -> None:
    told = verdict("ambiguous")
    told["alternatives"].append({"effects": [], "parameters": {"target.mass": 9.4, "wrist.mass": 0.72}, "score": -2.6})
    text = Page(report(tmp_path, told)).text.replace("\u00a0", " ")
    assert "Something is missing, or was believed wrongly, and these data cannot tell which" in text
    assert "another target mass and wrist mass than believed" in text
    assert "@" not in text.split("Located:")[0]


@pytest.mark.parametrize("kind", KINDS)
def test_page_is_well_formed_small_and_asks_for_nothing(kind: str) -> None:
    text = plain(kind)
    page = Page(text)
    assert not page.faults
    assert len(text.encode()) < 5_000_000
    for tag, attributes in page.elements:
        for name in ("src", "href", "xlink:href", "action", "data", "poster", "srcset"):
            value = attributes.get(name) or "#"
            assert value.startswith(("#", "data:")), f"<{tag} {name}={value}>"
    style = "".join(re.findall(r"<style>(.*?)</style>", text, re.S))
    assert "url(" not in style
    assert "@import" not in style


def test_the_reader_of_pages_can_find_faults() -> None:
    assert Page("<p><b>x</p></b>").faults
    assert Page("<div>").faults
    assert not Page("<p>x<br></p>").faults


def test_policy_allows_exactly_the_scripts_that_are_there() -> None:
    text = plain("named")
    policy = next(m["content"] for m in Page(text).all("meta") if m.get("http-equiv") == "Content-Security-Policy")
    assert policy is not None
    assert "default-src 'none'" in policy
    scripts = re.findall(r"<script>(.*?)</script>", text, re.S)
    digests = {base64.b64encode(hashlib.sha256(s.encode()).digest()).decode() for s in scripts}
    allowed = set(re.findall(r"'sha256-([^']+)'", policy.split("script-src")[1].split(";")[0]))
    assert digests == allowed
    assert "unsafe" not in policy


HOSTILE = "</script><script>window.hit=1</script><img src=x onerror=alert(1)>\"'&{{7*7}}$x$"


def _poisoned(value: Any) -> Any:
    """Every text of a structure made hostile, except the few words that the format fixes."""
    if isinstance(value, dict):
        fixed = ("verdict", "stage", "spacerobot")
        return {k: v if k in fixed else _poisoned(v) for k, v in value.items()}
    if isinstance(value, list):
        return [_poisoned(v) for v in value]
    return HOSTILE if isinstance(value, str) and value != "inf" else value


@pytest.mark.parametrize("kind", KINDS)
def test_every_text_is_inert(tmp_path: Path, kind: str) -> None:
    shown = _poisoned(evidence())
    shown["study"]["channels"] = {HOSTILE: {"unit": HOSTILE, "sigma": 1.0, "stream": HOSTILE}}
    shown["timing"][HOSTILE] = HOSTILE
    told = _poisoned(verdict(kind))
    told["parameters"] = dict.fromkeys([HOSTILE] * len(told["parameters"]), STIFFNESS)
    for effect in told["effects"]:
        effect["parameters"] = dict.fromkeys([HOSTILE] * len(effect["parameters"]), STIFFNESS)
    page = Page(report(tmp_path, told, shown))
    assert not page.faults
    assert not page.all("img")
    assert len(page.all("script")) == 4
    assert not [a for _, attributes in page.elements for a in attributes if a.startswith("on")]
    assert "window.hit=1</script>" not in "".join(page.script)
    assert "49" not in tell(told, read_evidence(shown)).headline


def test_for_eyes_ears_and_keys() -> None:
    text = plain("named")
    page = Page(text)
    assert all(a.get("aria-label") for a in page.all("svg"))
    assert len(re.findall(r"<caption>", text)) == len(page.all("table"))
    levels = [int(tag[1]) for tag, _ in page.elements if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(b - a <= 1 for a, b in itertools.pairwise(levels))
    ids = [a["id"] for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))
    links = [str(a.get("href"))[1:] for a in page.all("a")]
    assert set(links) <= set(ids)
    assert page.all("html")[0]["lang"] == "en"
    assert {"main", "nav", "header", "footer"} <= {tag for tag, _ in page.elements}
    assert "prefers-color-scheme" in text
    assert "@media print" in text


def test_formula_is_mathml() -> None:
    text = plain("named")
    assert re.search(r"<math[^>]*>.*<msub><mi>F</mi><mi>c</mi></msub>", text, re.S)


def test_embedded_traces_keep_the_numbers() -> None:
    traces = read_evidence(evidence()).traces
    text, kept = embedded(traces)
    assert kept == len(traces)
    for trace, item in zip(traces, json.loads(text), strict=True):
        for name in ("measured", "before", "after"):
            values = np.array([np.nan if v is None else v for v in item[name]])
            np.testing.assert_allclose(values, getattr(trace, name), atol=SIGMA[trace.channel] / 20.0)


def test_a_campaign_too_large_for_a_page_is_cut_and_says_so(tmp_path: Path) -> None:
    shown = evidence()
    shown["traces"] = [dict(t, trial=f"{i}-{t['trial']}") for i in range(60) for t in shown["traces"]]
    shown["hypotheses"] = [*shown["hypotheses"], *[dict(shown["hypotheses"][-1]) for _ in range(4000)]]
    text = report(tmp_path, verdict("named"), shown)
    assert len(text.encode()) < 5_000_000
    said = re.search(r"(\d+) of 720 traces are carried here", text)
    assert said
    assert int(said.group(1)) == len(json.loads(re.search(r'id="traces">(.*?)</script>', text, re.S).group(1)))  # type: ignore[union-attr]
    assert "more scored worse" in text


def test_evidence_may_be_absent(tmp_path: Path) -> None:
    told = verdict("nothing_missing")
    told["held_out"]["overall"] = dict.fromkeys(told["held_out"]["overall"])
    page = Page(report(tmp_path, told, {}))
    assert not page.faults
    assert "No traces were kept." in page.text
    assert write_plots(told, {}, tmp_path / "plots") == []


def test_evidence_of_another_form_is_refused(tmp_path: Path) -> None:
    shown = evidence()
    shown["traces"][0]["after"] = [1.0]
    with pytest.raises(InputError, match="differs in length"):
        report(tmp_path, verdict("named"), shown)
    with pytest.raises(InputError, match="not a list of numbers"):
        report(tmp_path, verdict("named"), {"traces": [{"time": ["x"], "measured": [1.0]}]})
    assert not list(tmp_path.iterdir())


def test_a_sensor_is_not_called_physics() -> None:
    told = verdict("named")
    told["effects"] = [copy.deepcopy(DELAY)]
    story = tell(told, read_evidence(evidence()))
    assert "Not the physics but the reading" in story.sentence
    assert "lacks a time offset in the force sensor, 4.200\u00a0ms" in story.sentence
    told["effects"].append(copy.deepcopy(verdict("named")["effects"][0]))
    assert "a sensor misreads" in tell(told, read_evidence(evidence())).sentence


def test_the_first_picture_of_a_sensors_verdict_is_of_that_sensor(tmp_path: Path) -> None:
    told = verdict("named")
    told["effects"] = [copy.deepcopy(DELAY)]
    caption = r'<figure class="hero">.*?<figcaption>(\S+) in trial'
    assert re.search(caption, report(tmp_path, told), re.S).group(1) == "contact.force"  # type: ignore[union-attr]
    assert re.search(caption, plain("named"), re.S).group(1) == "target.x"  # type: ignore[union-attr]


def test_many_located_balances_are_folded_away(tmp_path: Path) -> None:
    shown = evidence()
    shown["located"] = [dict(shown["located"][0], balance=f"b{i}") for i in range(40)]
    page = Page(report(tmp_path, verdict("named"), shown))
    assert not page.faults
    assert "30 more" in page.text
    assert "b39" in page.text


def test_moved_values_are_told_beside_an_effect() -> None:
    told = verdict("named")
    told["parameters"] = verdict("wrong_parameter")["parameters"]
    assert "Believed values moved too: wrist stiffness to 561.3" in " ".join(tell(told, read_evidence({})).more)


def test_plots_are_written_twice(plots: tuple[Path, list[str]]) -> None:
    folder, names = plots
    assert sorted(names) == sorted(p.name for p in folder.iterdir())
    assert {"held_out_target_x.png", "held_out_target_x.svg", "rivals.svg", "held_out_error.png"} <= set(names)
    assert {n.rpartition(".")[0] for n in names if n.endswith(".png")} == {
        n.rpartition(".")[0] for n in names if n.endswith(".svg")
    }


def test_plots_are_the_same_from_two_processes(plots: tuple[Path, list[str]], tmp_path: Path) -> None:
    folder, one = plots
    two = write_plots(verdict("named"), evidence(), tmp_path, jobs=2)
    assert one == two
    for name in one:
        assert (folder / name).read_bytes() == (tmp_path / name).read_bytes()


def test_no_text_decides_where_a_plot_goes_or_breaks_it(tmp_path: Path) -> None:
    shown = _poisoned(evidence())
    shown["traces"][0]["channel"] = "../../up"
    names = write_plots(verdict("named"), shown, tmp_path / "plots")
    assert sorted(names) == sorted(p.name for p in (tmp_path / "plots").iterdir())
    assert [p.name for p in tmp_path.iterdir()] == ["plots"]


def test_same_input_same_page(tmp_path: Path) -> None:
    assert report(tmp_path, verdict("named")) == plain("named")


def test_the_winner_s_row_is_first_and_marked() -> None:
    """Wherever its fit stands among the others, with the held-out errors of the two that were predicted unseen."""
    rivals = [{**h, "held_out": None} for h in evidence()["hypotheses"]]
    backwards = {**evidence(), "hypotheses": rivals[::-1]}
    text = page(verdict("named"), read_evidence(backwards))
    table = text[text.index("Fitted in full") :]
    first = table[table.index("<tbody>") : table.index("</tr>", table.index("<tbody>"))]
    assert 'class="won"' in first
    assert "Coulomb friction in the wrist" in first
    assert "1.02" in first
    assert table.count('class="won"') == 1
    assert "8.31" in table, "the baseline's"


def test_every_row_of_the_held_out_column_is_filled() -> None:
    """Rivals that predicted no unseen trial stand in a table of their own, without that column."""
    rivals = [{**h, "held_out": None} for h in evidence()["hypotheses"]]
    text = page(verdict("named"), read_evidence({**evidence(), "hypotheses": rivals}))
    tables = re.findall(r"<caption>(Fitted in full[^<]*)</caption>(.*?)</table>", text, re.DOTALL)
    (first, told), (second, others) = tables
    assert "Held-out error" in told
    assert "Held-out error" not in others
    rows = re.findall(r"<tr[^>]*><th scope=\"row\">.*?</th>(.*?)</tr>", told.partition("<tbody>")[2])
    assert len(rows) > 1
    assert not [r for r in rows if r.startswith('<td class="n">–')]
    assert "unseen" in second, first
    fitted = [h for h in rivals if h["stage"] == "fitted"]
    assert told.count("<tr") + others.count("<tr") == len(fitted) + 2


def test_a_rival_that_folds_chose_shows_its_error_there() -> None:
    """Over those folds alone, and how many they are; a rival that none chose has none."""
    rivals = [{**h, "held_out": None} for h in evidence()["hypotheses"] if h["stage"] == "fitted"]
    rival = next(h for h in rivals if [e["effect"] for e in h["effects"]] not in ([], ["coulomb_friction"]))
    found = verdict("named")
    own = {"left_out": ["01"], "leads_to": "another set", "selected": rival["effects"]}
    folds = [{**own, "rms_selected": 3.0}, {**own, "rms_selected": 4.0}, found["held_out"]["folds"][0]]

    def cells(some: list[dict[str, Any]]) -> str:
        told = {**found, "held_out": {**found["held_out"], "folds": some}}
        return page(told, read_evidence({**evidence(), "hypotheses": rivals}))

    assert re.search(r"3\.5\d*.σ <span class=\"quiet\">in 2 of 3</span>", cells(folds))  # the root of 12.5
    assert "in 1 of 1<" not in cells(folds[2:]), "the chosen one has its error over all"


def test_unknown_shows_the_baseline_alone() -> None:
    text = page(verdict("unknown"), read_evidence(evidence()))
    assert "line after" not in text[: text.index('id="rivals"')]
    assert 'class="won"' not in text
    assert "8.3 times the sensor noise" in text


def test_values_that_moved_and_those_held_exact_are_listed() -> None:
    found = {
        **verdict("named"),
        "exact": ["target.mass"],
        "moved": {
            "wrist.equivalent_damping": {"value": 2.0, "believed": 9.7, "in_sigmas": -2.3},
            "wrist.stiffness": {"value": 531.0, "believed": 530.0, "in_sigmas": 0.2},
        },
    }
    text = page(found, read_evidence(evidence()))
    assert text.index("wrist.equivalent_damping") < text.index("wrist.stiffness</code>")
    assert "Held exactly as stated: target.mass" in text


def test_an_error_without_a_sigma_is_a_share_of_the_spread_in_its_card_too(tmp_path: Path) -> None:
    told = verdict("named")
    told["held_out"]["unit"] = "spread"
    told["held_out"]["overall"] |= {"rms_before": 0.0171, "rms_after": 0.000572}
    html = report(tmp_path, told)
    assert "1.71 % of the spread" in html
    assert "0.0572 % of the spread" in html
