"""Vocabulary of column names in the languages of test machines."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from types import MappingProxyType
from typing import Literal, TypeAlias

from dashpot.base.lazy import compile_on_use
from dashpot.base.units import Dimension

Role: TypeAlias = Literal[
    "time", "displacement", "force", "acceleration", "frequency", "storage", "loss",
    "temperature", "real", "imaginary", "magnitude", "phase", "coherence", "stress", "strain",
    "modulus", "viscosity", "shear_rate", "voltage", "cycle", "velocity", "torque", "loss_factor",
    "hammer", "creep_compliance", "stretch", "complex_modulus", "loss_angle",
]  # fmt: skip

DIMENSION: MappingProxyType[str, Dimension] = MappingProxyType({
    "time": "time", "displacement": "length", "force": "force", "acceleration": "acceleration",
    "frequency": "frequency", "storage": "stress", "loss": "stress", "temperature": "temperature",
    "stress": "stress", "strain": "strain", "modulus": "stress", "voltage": "voltage",
    "velocity": "velocity", "torque": "torque", "hammer": "force", "phase": "angle",
    "creep_compliance": "material compliance", "stretch": "strain", "complex_modulus": "stress",
    "loss_angle": "angle",
})  # fmt: skip
"""The dimension of the unit that a role has."""
OF_A_PART: MappingProxyType[str, Dimension] = MappingProxyType({
    "storage": "stiffness", "loss": "stiffness", "modulus": "stiffness",
    "creep_compliance": "compliance", "complex_modulus": "stiffness",
})  # fmt: skip
"""Role on a part for each role of a material."""

# Names that match as whole words; German and other compounds match as parts of a word.
_EXACT_NAMES: dict[Role, str] = {
    "time": """time zeit gesamtzeit laufzeit prüfzeit messzeit versuchszeit versuchsdauer czas
        godzina temps tiempo tempo tijd tid aika zaman süre čas doba idő timp durata время 时间 時間
        시간 timestamp zeitstempel elapsed uhrzeit masa
        час χρόνος vrijeme vreme aeg laiks laikas""",
    "displacement": """displacement disp displ weg standardweg traversenweg kolbenweg maschinenweg
        verschiebung zusammendrückung stauchung kompression przemieszczenie droga ugięcie
        déplacement
        desplazamiento spostamento deslocamento verplaatsing deplasman yerdeğiştirme siirtymä
        förskjutning posunutí posuv dráha elmozdulás deplasare перемещение
        переміщення μετατόπιση pomak pomik forskydning forskyvning posunutie nihe pārvietojums
        poslinkis 位移 変位 변위 行程 变形
        變形 compression indentation squeeze""",
    "force": """force load kraft standardkraft prüfkraft siła obciążenie fuerza carga forza
        carico força kuvvet yük voima kracht síla zatížení erő terhelés forță сила усилие
        нагрузка зусилля навантаження δύναμη sila jõud spēks jėga
        力 载荷 載荷 荷重 负荷 負荷 负载 压力 하중 힘
        hammer impact excitation impulskraft""",
    "acceleration": """acceleration accel acc accelerometer beschleunigung beschl przyspieszenie
        accélération aceleración accelerazione aceleração versnelling ivme kiihtyvyys zrychlení
        gyorsulás ускорение 加速度 가속도""",
    "frequency": """frequency freq frequenz prüffrequenz częstotliwość fréquence frecuencia
        frequenza frequência frequentie frekans taajuus frekvence frekvencia частота 频率 頻率
        周波数 주파수 omega ω kreisfrequenz""",
    "storage": """storage speichermodul e' g' e_stor e_storage g_stor g_storage k' storagemodulus
        zachowawczy conservation m' 储能模量 貯蔵弾性率 estor gstor elastic_component""",
    "loss": """verlustmodul e'' g'' e" g" e_loss g_loss k'' k" m'' m" lossmodulus stratności perte
        损耗模量 損失弾性率 eloss gloss viscous_component""",
    "loss_factor": """tan_delta tandelta tanδ tan_d tand tan_δ verlustfaktor loss_factor
        lossfactor loss_tangent 损耗因子 tan(delta) tan(d)""",
    "loss_angle": """loss_angle lossangle phase_angle phase_lag phase phasenwinkel verlustwinkel
        delta δ""",
    "temperature": """temperature temp temperatur temperatura température sıcaklık lämpötila teplota
        hőmérséklet температура 温度 溫度 온도""",
    "real": "real re realteil",
    "imaginary": "imaginary imag im imaginärteil",
    "magnitude": "magnitude mag amplitude betrag transmissibility",
    "phase": "phase phasenwinkel winkel arg faza 相位",
    "coherence": "coherence coh kohärenz koherencja cohérence gamma2 γ2 相干",
    "stress": """stress spannung naprężenie contrainte tensión tensione gerilme 应力 應力 応力 응력
        schubspannung""",
    "strain": """strain dehnung odkształcenie déformation deformación deformazione gerinim 应变
        應變 歪み ひずみ 변형률 scherung deformation wydłużenie_względne allongement_relatif""",
    "stretch": """stretch stretch_ratio extension_ratio lambda λ streckung streckgrad volume_ratio
        volumenverhältnis""",
    "modulus": "modulus modul e_relax g_relax relaxationsmodul",
    "creep_compliance": """compliance nachgiebigkeit kriechnachgiebigkeit podatność complaisance
        cedevolezza податливость 柔量 コンプライアンス j(t) d(t)""",
    "viscosity": "viscosity viskosität lepkość viscosité 粘度",
    "shear_rate": "shear_rate scherrate shearrate schergeschwindigkeit",
    "voltage": "voltage spannung_v volts gauge sg0 sg1 sg2 sg3 sg4 sg5",
    "cycle": """cycle cycles zyklus zyklen zyklenzähler cykl cykle lastspiel lastspiele ciclo 循环
        周期""",
    "velocity": """velocity speed geschwindigkeit prędkość vitesse velocidad velocità hız скорость
        速度""",
    "torque": "torque drehmoment moment moment_obrotowy couple coppia tork момент 扭矩",
}  # fmt: skip
# Names that often mean this, and give way to the ones above.
_USUAL_NAMES: dict[Role, str] = {
    "time": "t sec secs seconds sekunden zeitpunkt clock x_value",
    "displacement": """position pos extension stroke travel deflection crosshead traverse piston
        lvdt encoder gap separation height depth hub course allongement enfoncement corsa uzama
        konum ход положение позиция wydłużenie położenie poloha pozíció posición posizione
        x z d l u s y length verformung deformation eindringtiefe lauf opening ekstensometr
        extensometer ストローク ストロ 位置 伸长 行程量 스트로크 elongation alargamiento
        allungamento удлинение 伸び""",
    "force": """f fx fy fz charge effort last drucklast zuglast prüflast kompressionslast lastzelle
        loadcell druckkraft input hammer_force n""",
    "acceleration": "a response antwort réponse odpowiedź ответ 响应",
    "frequency": "f hz w",
    "storage": "gp ep speicher",
    "loss": "gpp epp loss verlust",
    "temperature": "t kammer",
    "stress": "sigma σ tau τ pressure",
    "strain": """epsilon ε gamma γ elongation allongement wydłużenie alargamiento allungamento
        удлинение 伸び 伸长率 compression stauchung""",
    "creep_compliance": "j",
    "modulus": "g(t) e(t) g e",
}  # fmt: skip
COMMANDED = (
    "set", "soll", "sollwert", "command", "commanded", "cmd", "setpoint", "target", "demand",
    "zadana", "zadane", "consigne", "nominal", "reference", "ref", "设定", "目标", "hedef",
)  # fmt: skip
"""Words for set-points."""
DERIVED = (
    "sd", "std", "stdev", "error", "fehler", "rate", "speed", "velocity", "geschwindigkeit",
    "derivative", "noise", "status", "flag", "index", "count", "counter", "filtered", "gefiltert",
    "smoothed", "average", "mean", "avg", "variance", "quality", "log", "lg", "ln",
)  # fmt: skip
"""Words for something computed from a signal, not the signal."""
EXTREMES = (
    "max", "maximum", "min", "minimum", "peak", "valley", "spitze", "spitzen", "amplitude", "ampl",
    "trend",
    "mean", "mittel", "spitzenwert", "maksimum", "pic", "pico", "picco", "最大", "最小",
    "峰值", "谷值",
    "maks", "oberwert", "unterwert", "maxima", "minima", "range",
)  # fmt: skip
"""Words for one value per cycle."""
COUNTED = frozenset((
    "cycles", "segments", "counts", "steps", "zyklen", "cykle", "segmente",
))  # fmt: skip
"""Words in place of a unit in a column of counts."""
STATIC = ("static", "stat", "statisch", "statische", "statischer", "statique", "statico", "静态")
"""Words for the mean of a cycle."""
STEP_TIME = (
    "step", "segment", "schritt", "interval", "section", "abschnitt", "schrittzeit", "kroku",
    "stage", "action",
)  # fmt: skip
"""Clocks that start with a step."""
PARTIAL_TIME = (
    *STEP_TIME, "cycle", "zyklus", "zykluszeit", "block", "phase", "cyklu", "remaining", "rest",
)  # fmt: skip
"""Clocks that start again within a test."""
OF_ACTUAL = ("true", "cauchy", "wahre", "wahrer", "hencky")
"""Words for a stress on the area as it is, or a strain that is a logarithm."""
OF_REST = (
    "nominal", "engineering", "eng", "technical", "technische", "nenn", "nennspannung", "piola",
)  # fmt: skip
"""Words for a stress on the area at rest, or a strain over the length at rest."""
SIDEWAYS = (
    "lateral", "transverse", "transversal", "radial", "width", "quer", "querdehnung", "breite",
    "poprzeczne", "transversale", "trasversale", "横向",
)  # fmt: skip
"""Words for a strain square to the force."""
OF_BASE = (
    "base", "basis", "table", "tisch", "shaker", "input", "excitation", "erreger", "erregung",
    "anregung", "fußpunkt", "fundament", "ground", "floor", "boden", "podstawa", "stół",
    "reference", "control", "drive",
)  # fmt: skip
"""Words for the base among two motions."""
MIN_SCORE = 1.5
"""Lowest score with which a name counts for a role: that of a second meaning."""
WHOLE_TIME = ("run",)
"""Clocks of an instrument that include the time before this record."""
_HUMP = compile_on_use(r"(?<=[a-zäöüß]{2})(?=[A-ZÄÖÜ])")
_GAPS = compile_on_use(r"[\s_\-:;,./\\|*#()\[\]{}<>]+")
_INFORMATIVE_WORDS = (
    *COMMANDED, *DERIVED, *EXTREMES, *STATIC, *PARTIAL_TIME, *OF_ACTUAL, *OF_REST, *SIDEWAYS,
    *OF_BASE, *WHOLE_TIME,
)  # fmt: skip
"""All words that say something about a column beside its role."""
_ORDERS = ("dmy", "mdy", "ymd", "hms", "hm", "ms")
"""Orders of the parts of a clock time; the parts that follow go without saying."""


def normalise_name(name: str) -> str:
    """Fold case, width and spacing; camelCase and digits part words; accents stay."""
    text = _HUMP.sub(" ", unicodedata.normalize("NFKC", name))
    return _GAPS.sub(" ", text.casefold()).strip()


def remove_accents(text: str) -> str:
    """Drop the accents, as mangled headers do."""
    if text.isascii():
        return text
    return "".join(
        c
        for c in unicodedata.normalize("NFKD", text.replace("ł", "l").replace("ı", "i"))
        if not unicodedata.combining(c)
    )


def _lexicon(words: dict[Role, str]) -> MappingProxyType[str, tuple[Role, ...]]:
    lexicon: dict[str, tuple[Role, ...]] = {}
    for role, line in words.items():
        for word in line.split():
            for spelling in {word.casefold(), remove_accents(word.casefold())}:
                if role not in lexicon.get(spelling, ()):
                    lexicon[spelling] = (*lexicon.get(spelling, ()), role)
    return MappingProxyType(lexicon)


FIRST = _lexicon(_EXACT_NAMES)
SECOND = _lexicon(_USUAL_NAMES)
_SIZE = compile_on_use(
    r"(?<!\w)[ekg]\*|\|[ekg]\||(?<![a-z])[kc][ _]?dyn(?![a-z])"
    r"|(?<![a-z])(?:dyn|complex|komplex|absolute)[^ '\"]{0,7} (?:[a-z]{1,12} )?"
    r"(?:stiffness|steifigkeit|modulus|modul|federrate|spring rate)"
)
_NO_SIZE = compile_on_use(
    r"storage|loss|speicher|verlust|real|imag|phase|angle|winkel|viscos|compliance|[ekg]['\"′″]"
)
_BLANKS = compile_on_use(r" {2,}")
_EAST = MappingProxyType({word: roles for word, roles in FIRST.items() if ord(word[0]) > 0x3000})
"""Words found inside others without a blank."""
_STEMS = MappingProxyType(
    {
        word: roles
        for word, roles in FIRST.items()
        if len(word) >= 4 or word in {"weg", "čas"} or word in _EAST
    }
)
"""Words that others end with."""
_STEM_ENDINGS = frozenset(word[-2:] for word in _STEMS)
_MAX_STEM_LENGTH = max(map(len, _STEMS))
_NUMBER = compile_on_use(r"(?<![0-9])[0-9]{2,}+(?=[\])}\s]*+\Z)")


def tokens(name: str) -> list[str]:
    """Return the words of a name."""
    return normalise_name(name).split()


def has_word(name: str, words: tuple[str, ...]) -> bool:
    """Return whether one of the words is in the name, as a word or (CJK) as a part."""
    name = replace_channel_number(name)
    single, inner_words = _split_search_words(words)
    return not single.isdisjoint(_split_name_words(name)) or any(
        word in name for word in inner_words
    )


@lru_cache(maxsize=1 << 16)
def _split_name_words(name: str) -> frozenset[str]:
    """Return the words of a name, with their numbers and without."""
    names = tokens(name)
    return frozenset((*names, *(word.rstrip("0123456789") for word in names)))


@lru_cache(maxsize=64)
def _split_search_words(words: tuple[str, ...]) -> tuple[frozenset[str], tuple[str, ...]]:
    """Return the search words that must be whole words, and those that may be parts."""
    return frozenset(words), tuple(word for word in words if ord(word[0]) > 0x3000)


def _may_mean(spelling: str) -> bool:
    """Return whether a word may have a role; most of thousands of names have none."""
    is_certain = spelling in FIRST or spelling in SECOND
    return is_certain or spelling[-2:] in _STEM_ENDINGS or not spelling.isascii()


def _roles(spelling: str) -> Iterator[tuple[Role, float]]:
    """The roles that one word may mean, and how surely."""
    first = FIRST.get(spelling, ())
    yield from ((role, 3.0) for role in first)
    yield from ((role, MIN_SCORE) for role in SECOND.get(spelling, ()))
    if first:
        return
    # German puts the head of a compound last: Standardkraft is a force
    for start in range(max(1, len(spelling) - _MAX_STEM_LENGTH), len(spelling)):
        yield from ((role, 2.5) for role in _STEMS.get(spelling[start:], ()))
    if not spelling.isascii():
        for stem, roles in _EAST.items():
            if stem in spelling:
                yield from ((role, 2.5) for role in roles)


def names_magnitude(name: str) -> bool:
    """Return whether a name means the magnitude of a complex modulus or stiffness.

    >>> names_magnitude("|K*|"), names_magnitude("Dynamic storage modulus")
    (True, False)
    """
    text = unicodedata.normalize("NFKC", name).casefold().replace("_", " ").replace(".", " ")
    text = _BLANKS.sub(" ", text)
    return bool(_SIZE.search(text)) and not _NO_SIZE.search(text)


@lru_cache(maxsize=1 << 16)
def replace_channel_number(name: str) -> str:
    """Return a name with 00 in place of its channel number of two digits or more.

    >>> replace_channel_number("ai_0017"), replace_channel_number(
    ...     "Channel [3917]"), replace_channel_number("T2")
    ('ai_00', 'Channel [00]', 'T2')
    """
    return _NUMBER.sub("00", name)


@lru_cache(maxsize=1 << 16)
def find_informative_words(name: str) -> str:
    """Return a name without its number; "" if none of its words has a meaning.

    >>> find_informative_words("Force 0017"), find_informative_words("ceoeeaa")
    ('Force 00', '')
    """
    name = replace_channel_number(name)
    return name if matches(name) or has_word(name, _INFORMATIVE_WORDS) else ""


def matches(name: str) -> MappingProxyType[Role, float]:
    """Return a score of a name for each role: 3 exact, 2.5 part of a word, 1.5 uncertain."""
    return _matches(replace_channel_number(name))


@lru_cache(maxsize=1 << 16)
def _matches(name: str) -> MappingProxyType[Role, float]:
    scores: dict[Role, float] = {}
    whole_name = unicodedata.normalize("NFKC", name).casefold().strip().replace(" ", "_")
    names = tokens(name)
    stems = {word.rstrip("0123456789") for word in names} - {*names, ""}
    for word in {whole_name, *names, *stems}:
        penalty = 0.3 if word in stems else 0.0  # T beats T2, Force beats Force 1
        for spelling in filter(_may_mean, {word, remove_accents(word)}):
            for role, value in _roles(spelling):
                scores[role] = max(value - penalty, scores.get(role, 0.0))
    for phrase in map("_".join, pairwise(names)):  # "tan delta 2"
        for role in FIRST.get(remove_accents(phrase), ()):
            scores[role] = 3.0
    if "force" in scores:
        scores["hammer"] = scores["force"]
    if names_magnitude(name):
        scores["complex_modulus"] = 3.0
    if names[:1] == ["tan"]:  # of delta, or of d, which alone may be a displacement
        scores.pop("loss_angle", None)
        scores.pop("displacement", None)
    if {"loss_angle", "loss_factor"} & scores.keys() and scores.get("loss", 0.0) < 2.0:
        scores.pop("loss", None)
    return MappingProxyType(scores)


@lru_cache(maxsize=1024)
def clock_order(word: str | None) -> str:
    """Return the order in which ``mm:ss`` or ``TT.MM.JJJJ hh:mm`` names the parts, or "".

    >>> clock_order("mm:ss"), clock_order("TT.MM.JJJJ hh:mm"), clock_order("min")
    ('ms', 'dmy', '')
    """
    parts = re.findall(r"[^\W\d_]+", (word or "").casefold())
    letters = "".join(part[0] for part in parts).replace("j", "y").replace("t", "d")
    return next((order for order in _ORDERS if letters.startswith(order)), "")
