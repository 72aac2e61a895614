"""What other languages call the things that labs measure, said in English before names are read."""

from __future__ import annotations

import functools
import re
import unicodedata

_STEMS = {
    "kraft": "force", "drehmoment": "torque", "geschwindigkeit": "velocity", "drehzahl": "velocity",
    "winkel": "angle", "spannung": "voltage", "ziel": "target", "schlitten": "slider",
    "handgelenk": "wrist", "greifer": "gripper", "gelenk": "joint", "achse": "axis", "sollwert": "setpoint",
    "istwert": "actual", "zeit": "time", "plattform": "platform",
}  # fmt: skip
"""German writes words together (Kontaktkraft, Schlittenweg): these are found at either end of a word."""

_WORDS = {
    word: english
    for english, words in {
        "actual": "ist", "angle": "angolo angulo hoek uhel kat угол aci vinkel",
        "current": "strom courant corriente corrente prad proud stroom ток akim",
        "deg": "graus grados gradi graden stopnie градусы derece",
        "force": "fuerza forza forca sila kracht сила kuvvet",
        "joint": "articulation articulacion giunto junta przegub gewricht kloub сустав eklem",
        "mass": "masse masa massa hmotnost масса kutle", "measured": "mesure",
        "position": "weg lage posicion posizione posicao polozenie poloha positie положение konum",
        "setpoint": "soll sollwert consigne consigna referencia riferimento zadana zadany zadane задание referans",
        "slider": "suwak suwaka curseur chariot cursore carrello carro corredera carrinho slede jezdec каретка",
        "spring": "feder resorte ressort molla",
        "target": "satellit cible objetivo bersaglio alvo cel celu doel цель hedef",
        "time": "temps tiempo tempo czas tijd cas время zaman tid",
        "torque": "couple coppia binario koppel момент tork",
        "velocity": "vitesse velocidad velocita velocidade predkosc rychlost snelheid скорость hiz hastighet",
        "voltage": "tension tensao napiecie напряжение spanning", "wrist": "poignet muneca polso punho nadgarstek",
    }.items()
    for word in words.split()
}  # fmt: skip
"""Whole words, without their accents."""

_WRITTEN_THROUGH = {
    "目標": "setpoint", "目標値": "setpoint", "指令": "command", "ターゲット": "target", "標的": "target",
    "対象": "target",
    "衛星": "satellite", "手首": "wrist", "スライダ": "slider", "ハンド": "hand", "手先": "hand", "関節": "joint",
    "位置": "position", "変位": "position", "角度": "angle", "速度": "velocity", "角速度": "omega", "力": "force",
    "トルク": "torque", "電流": "current", "電圧": "voltage", "時刻": "time", "時間": "time", "質量": "mass",
    "目标": "target", "手腕": "wrist", "滑块": "slider", "位移": "position", "力矩": "torque", "时间": "time",
    "关节": "joint", "电流": "current", "电压": "voltage", "质量": "mass",
}  # fmt: skip
"""Scripts without blanks: found anywhere, the longest first."""

_ENDS = re.compile(rf"^(?:{'|'.join(_STEMS)})|(?:{'|'.join(_STEMS)})$", re.IGNORECASE)
_THROUGH = re.compile("|".join(sorted(_WRITTEN_THROUGH, key=len, reverse=True)))
STROKES = str.maketrans("łøđı", "lodi")
"""Letters that are another's with a stroke, or without its dot."""
_LETTERS = re.compile(r"[^\W\d_]+")


@functools.lru_cache(maxsize=10_000)
def english(text: str) -> str:
    """`text` with the words that are known here said in English; all else stays as it is."""
    text = _THROUGH.sub(lambda found: f" {_WRITTEN_THROUGH[found.group(0)]} ", text)
    text = _LETTERS.sub(_parted, text)
    return _LETTERS.sub(lambda found: _WORDS.get(_bare(found.group(0)), found.group(0)), text)


def words_in(name: str) -> list[str]:
    """The words of a name in lower case: "Current_VX [m/s]" is current, vx."""
    text = re.sub(r"[\[(][^\])]*[\])]\s*$", "", name.replace("$\\theta$", "theta"))
    text = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", english(text))
    return [w.lower() for w in re.split(r"[\W_]+", text) if w]


def _bare(word: str) -> str:
    """`word` in lower case without its accents."""
    parts = unicodedata.normalize("NFKD", word.lower().translate(STROKES))
    return unicodedata.normalize("NFC", "".join(c for c in parts if not unicodedata.combining(c)))


def _parted(word: re.Match[str]) -> str:
    return _ENDS.sub(lambda part: f" {_STEMS[part.group(0).lower()]} ", word.group(0))
