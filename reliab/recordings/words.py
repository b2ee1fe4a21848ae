"""Words and units by which laboratories name their channels: what is measured, in which part of the test.

English first, then German, Italian, Spanish, French, Turkish and Chinese in pinyin; what is written in
Chinese, Japanese or Korean signs is translated first. A word is recognised wherever it stands in a name
("Act1_DispCmd", "Axial Displacement (mm)"). Nothing else in the package lists one.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from reliab.core.units import canonical_unit
from reliab.core.vocabulary import STANDARD_GRAVITY


class Measurand(StrEnum):
    """What a channel measures."""

    TIME = "time"
    DISPLACEMENT = "displacement"
    FORCE = "force"
    ACCELERATION = "acceleration"
    VELOCITY = "velocity"
    VOLTAGE = "voltage"
    VALVE = "valve"
    ROTATION = "rotation"
    STRAIN = "strain"
    PRESSURE = "pressure"
    TEMPERATURE = "temperature"
    CURRENT = "current"
    ERROR = "error"
    COUNT = "count"
    STATE = "state"


class ChannelRole(StrEnum):
    """On which side of the transfer system a channel stands."""

    COMMAND = "command"
    MEASURED = "measured"
    GROUND = "ground"


QUANTITIES: Final[Mapping[Measurand, str]] = {
    Measurand.TIME: (
        "time times timer tout timestamp elapsed seconds zeit laufzeit messzeit uhrzeit zeitstempel tempo "
        "tiempo temps shijian zaman sure"
    ),
    Measurand.DISPLACEMENT: (
        "pot potentiometer laser wa heidenhain keyence celesco balluff magnetostrictive ultrasonic "
        "disp displ dis dsp displacement displacements stroke position pos lvdt ldt temposonic "
        "temposonics encoder travel deflection elongation weg wegaufnehmer kolbenweg verschiebung hub "
        "auslenkung spostamento spost corsa posizione desplazamiento desp carrera posicion "
        "deplacement depl course weiyi xingcheng deplasman deplasmani dep degistirme konum konumu"
    ),
    Measurand.FORCE: (
        "messdose kraftmessdose "
        "force forces load loads loadcell lc frc forc kraft kraefte last pruefkraft forza carico "
        "carga fuerza effort charge li lizhi zaihe hezai shear reaction restoring cella celda kuvvet kuvveti "
        "yuk yuku hucre hucresi"
    ),
    Measurand.ACCELERATION: (
        "acc accel accl acceleration accelerometer beschleunigung beschl accelerazione aceleracion "
        "acceleration ddot jiasudu ivme ivmesi"
    ),
    Measurand.VELOCITY: "vel velo velocity speed geschwindigkeit velocita velocidad vitesse sudu hiz hizi",
    Measurand.VOLTAGE: "volt volts voltage spannung tensione tension voltaje dianya dac adc "
    "voltaj voltaji gerilim",
    Measurand.VALVE: "valve servovalve spool ventil servoventil valvola servovalvola valvula "
    "servovalvula vanne servovanne servofa valf valfi servovalf",
    Measurand.ROTATION: (
        "rotation rot angle winkel drehwinkel rotazione angolo giro angulo zhuanjiao moment torque"
    ),
    Measurand.STRAIN: "strain strains gauge gage dehnung deformacion deformazione yingbian",
    Measurand.PRESSURE: "pressure press druck oeldruck pressione presion "
    "pression olio huile oil yali basinc basinci",
    Measurand.TEMPERATURE: "temperature temp temperatur temperatura wendu sicaklik sicakligi",
    Measurand.CURRENT: "current amp amps amperage strom corrente corriente courant dianliu akim akimi",
    Measurand.ERROR: "error err abweichung regelabweichung errore erreur ecart "
    "diff difference residual residuo wucha hata hatasi",
    Measurand.COUNT: (
        "count counter index sample samples cycle cycles segment row zyklus zyklen ciclo ciclos"
    ),
    Measurand.STATE: (
        "status state flag trigger trig sync interlock mode enable gain pid power energy rate rms"
    ),
}
"""Words that say what is measured."""

ROLES: Final[Mapping[ChannelRole, str]] = {
    ChannelRole.COMMAND: (
        "command commanded commands cmd cmnd comm commandsignal targ target targeted tgt desired "
        "reference ref setpoint demand dem soll sollwert sollweg vorgabe comando riferimento consigna "
        "referencia deseado objetivo "
        "comandado comandato imposto desiderato consigne commande cible mingling zhiling mubiao qiwang komut "
        "komutu hedef referans istenen kumanda obiettivo rif wanted"
    ),
    ChannelRole.MEASURED: (
        "measured measurement meas msd actual achieved feedback feedbk fbk fdbk fb istwert istweg ist "
        "gemessen misurato misurata misura effettivo medido medida mesure mesuree shice "
        "fankui celiang shiji olculen olcum olcumu gerceklesen gercek geribesleme "
        "rilevato rilevata mis eff mes reel retroaction"
    ),
    ChannelRole.GROUND: (
        "ground groundmotion base table shake shaketable earthquake eq quake excitation boden tisch "
        "erdbeben suolo tavola sisma terremoto suelo sismo sol seisme dizhen dimian zhendongtai yer zemin "
        "taban deprem"
    ),
}
"""Words that say on which side of the transfer system a channel stands."""

WEAK_ROLES: Final[Mapping[ChannelRole, str]] = {
    ChannelRole.COMMAND: "input des in set",
    ChannelRole.MEASURED: "response resp output out sensor real reached act",
}
"""Words that say so only where no column does with a plainer one: `act` may be the actuator's."""

CALCULATION_WORDS: Final = "predicted estimated est simulated sim model ideal emulated numerical"
"""Words of what was calculated: the output of a model is no measurement."""

ALTERATION_WORDS: Final = (
    f"{CALCULATION_WORDS} drift filtered filt raw compensated comp compensation corrected smoothed delayed "
    "initial old previous offset peak max min mean gefiltert roh kompensiert "
    "filtrato compensato filtrado compensado lvbo buchang"
)
"""Words of a history that was changed, or is a part of one: another column is preferred."""

NEUTRAL: Final = (
    "actuator axial axis ax channel ch hydraulic north south east west horizontal vertical lateral long "
    "main outer inner kolben piston signal sig data rig jack ram cylinder cyl specimen test floor story "
    "zylinder kanal attuatore actuador canale canal tongdao of the x y z"
)
"""Words that decide nothing; they are known so that names without gaps can be taken apart."""

SYMBOLS: Final[Mapping[str, tuple[Measurand, ChannelRole | None]]] = {
    "t": (Measurand.TIME, None),
    **dict.fromkeys(("xc", "uc", "dc", "xd", "ud"), (Measurand.DISPLACEMENT, ChannelRole.COMMAND)),
    **dict.fromkeys(("xm", "um", "dm"), (Measurand.DISPLACEMENT, ChannelRole.MEASURED)),
    **dict.fromkeys(
        ("fm", "fe", "fr", "fs", "frest", "fmeas", "fmeasured", "fact"),
        (Measurand.FORCE, ChannelRole.MEASURED),
    ),
    **dict.fromkeys(
        ("ag", "agm", "xgdd", "xddg", "ugdd", "uddg", "xgddot", "ugddot", "ddxg", "ddug"),
        (Measurand.ACCELERATION, ChannelRole.GROUND),
    ),
}
"""Symbols of equations, as whole names without the signs in them: x_c, u_m."""

COMMAND_ENDINGS: Final = "cdtr"
"""Last letters of names that mean the command, where the same name ends in one of the next, too."""

MEASURED_ENDINGS: Final = "ma"

SIGNS: Final[Mapping[str, str]] = {
    "time": "时间 時間 시간 时刻 時刻",
    "displacement": "位移 变位 変位 變位 行程 ストローク 변위",
    "position": "位置 위치",
    "force": "恢复力 復元力 恢復力 荷载 荷載 荷重 载荷 載荷 反力 力 ロードセル 하중 힘",
    "acceleration": "加速度 가속도",
    "velocity": "速度 속도",
    "voltage": "电压 電圧 電壓 전압",
    "current": "电流 電流 전류",
    "valve": "伺服阀 伺服閥 阀控 阀 閥 サーボ弁 サーボバルブ バルブ 弁 밸브",
    "pressure": "压力 圧力 壓力 油压 油圧 油壓 압력",
    "temperature": "温度 溫度 油温 油溫 온도",
    "strain": "应变 應變 ひずみ 歪み 歪 변형률",
    "rotation": "转角 轉角 回転角 转动 角度 弯矩 彎矩 扭矩 회전",
    "error": "误差 誤差 偏差 残差 殘差 오차",
    "status": "状态 狀態 状態 标志 상태",
    "count": "序号 編號 编号 番号 번호",
    "command": "命令 指令 目标 目標 给定 給定 期望 参考 參考 명령 목표 기준",
    "measured": (
        "实测 實測 実測 反馈 反饋 回馈 测量 測量 量测 量測 計測 测得 測定 フィードバック 実 측정 계측"
    ),
    "response": "响应 響應 応答 输出 輸出 出力 응답 출력",
    "input": "输入 輸入 入力 입력",
    "ground": "地震动 地震動 地震 地动 地動 地面 地表 地盘 地盤 台面 台上 振动台 振動台 振動臺 입력지진 지반",
    "filtered": "滤波 濾波 フィルタ 필터",
    "compensated": "补偿 補償 보상",
    "predicted": "预测 預測 予測 예측",
    "simulated": "仿真 模拟 模擬 解析",
    "actuator": "作动器 作動器 致動器 油压缸 油壓缸 油圧シリンダ アクチュエータ ジャッキ 가력기",
}
"""Words in Chinese, Japanese and Korean signs, written without gaps, by the word that means the same."""


_POUND: Final = 4.4482216152605  # N

UNITS: Final[Mapping[Measurand, Mapping[str, float]]] = {
    Measurand.TIME: {
        **dict.fromkeys(("s", "sek", "sekunden", "sn", "saniye", "秒", "초"), 1.0),
        "ms": 1e-3,
        "us": 1e-6,
        "ns": 1e-9,
        "min": 60.0,
        **dict.fromkeys(("h", "hr", "hour", "hours", "std", "stunden"), 3600.0),
        **dict.fromkeys(("d", "day", "days", "tage"), 86400.0),
        **dict.fromkeys(("week", "weeks"), 604800.0),
    },
    Measurand.DISPLACEMENT: {
        "m": 1.0,
        "cm": 1e-2,
        "mm": 1e-3,
        **dict.fromkeys(("um", "micron", "microns"), 1e-6),
        **dict.fromkeys(("in", "inch", "inches", "in.", '"'), 0.0254),
        **dict.fromkeys(("ft", "feet", "foot"), 0.3048),
        "mil": 2.54e-5,
    },
    Measurand.ACCELERATION: {
        **dict.fromkeys(("m/s2", "ms2"), 1.0),
        "cm/s2": 1e-2,
        "mm/s2": 1e-3,
        "in/s2": 0.0254,
        "ft/s2": 0.3048,
        **dict.fromkeys(("g", "grav"), STANDARD_GRAVITY),
        "mg": 1e-3 * STANDARD_GRAVITY,
    },
    Measurand.FORCE: {
        **dict.fromkeys(("n", "newton", "newtons"), 1.0),
        **dict.fromkeys(("kn", "kilonewton", "kilonewtons"), 1e3),
        "MN": 1e6,
        **dict.fromkeys(("lbf", "lb", "lbs", "pound", "pounds"), _POUND),
        **dict.fromkeys(("kip", "kips", "klbf"), 1e3 * _POUND),
        **dict.fromkeys(("kgf",), STANDARD_GRAVITY),
        **dict.fromkeys(("tf", "tonf"), 1e3 * STANDARD_GRAVITY),
    },
    Measurand.VELOCITY: dict.fromkeys(
        ("m/s", "mm/s", "cm/s", "in/s", "m/sec", "mm/sec", "in/sec", "mps", "rad/s", "deg/s"), 1.0
    ),
    Measurand.VOLTAGE: dict.fromkeys(("v", "volt", "volts", "mv", "vdc"), 1.0),
    Measurand.CURRENT: dict.fromkeys(("a", "ma", "amp", "amps"), 1.0),
    Measurand.PRESSURE: dict.fromkeys(("pa", "kpa", "mpa", "bar", "psi", "ksi"), 1.0),
    Measurand.STRAIN: dict.fromkeys(
        ("ue", "µe", "ustrain", "µstrain", "microstrain", "mm/mm", "in/in", "m/m"), 1.0
    ),
    Measurand.ROTATION: {
        **dict.fromkeys(("deg", "°"), math.pi / 180.0),
        "mrad": 1e-3,
        **dict.fromkeys(("rad", "nm", "n.m", "n-m", "knm", "kn.m", "kn-m", "n*m"), 1.0),
    },
    Measurand.TEMPERATURE: dict.fromkeys(("c", "°c", "degc", "f", "°f", "degf", "k"), 1.0),
    Measurand.STATE: dict.fromkeys(("hz", "1/s", "%", "w", "kw", "j", "kj"), 1.0),
    Measurand.COUNT: dict.fromkeys(("-", "counts", "cnt", "segments", "cycles"), 1.0),
}
"""Factors to SI units by `canonical_unit`; of quantities that no test is judged by they are unused and 1."""

ANGLES: Final = ("rad", "mrad", "deg", "°")
"""Units of rotations that an actuator of several may command."""

TIMES: Final = UNITS[Measurand.TIME]
"""Units of time [s]."""

_SIGNS: Final = str.maketrans({"μ": "µ", "·": ".", "⋅": ".", "−": "-", "[": "", "]": "", "(": "", ")": ""})
_UNIT_BY_NAME: Final = {name: (quantity, name) for quantity, names in UNITS.items() for name in names}
_AMBIGUOUS: Final = frozenset({"mN", "mn", "millis", "micros"})  # counts of a timer, for all that is known
_NOT_ENDINGS: Final = frozenset({"a", "c", "d", "f", "h", "k", "std", "-", "%", "min", "in.", '"'})
_SPACED_UNITS: Final = frozenset(
    {"mm", "cm", "kn", "ms", "sec", "kip", "kips", "lbf", "µm", "gal", "m/s2", "m/s^2", "mm/s"}
)
_BRACKETS: Final = re.compile(r"(?:[\[({]|<)\s*([^\])}>]{1,20}?)\s*(?:[\])}]|>)\s*$")
_ENDING: Final = re.compile(r"(?<=[^\W_])_([a-zµμ°]+(?:/s(?:\^?2|²)?|ps2|s2)?)$", re.IGNORECASE)
_RATE: Final = re.compile(r"(?<=[^\W_])_((?!in_s(?:ec)?$)[a-z]+_s(?:ec)?(?:\^?2|²)?)$", re.IGNORECASE)
_MULTIPLE: Final = re.compile(r"(\d{0,9}\.?\d+(?:e-?\d{1,2})?)\s*[*x]?\s*([^\d/].*)", re.IGNORECASE)
_LAST_WORD: Final = re.compile(r"(?<!\d)[\s,;-]+(?:in\s+|/\s*)?([^\s\[({]+)$")


def units_text(units: Mapping[str, float]) -> str:
    """List units for a message, each by its first spelling.

    >>> units_text(UNITS[Measurand.DISPLACEMENT])
    'm, cm, mm, um, in, ft, mil'
    """
    first: dict[float, str] = {}
    for name, factor in units.items():
        first.setdefault(factor, name)
    return ", ".join(first.values())


@dataclass(frozen=True, kw_only=True)
class Unit:
    """A unit of a channel."""

    text: str  # As it is written
    quantity: Measurand
    factor: float  # to the SI unit


def unit_of(text: str) -> Unit | None:
    """Read a unit as programs write it; None where it is none that is known.

    >>> unit_of("[kN]").factor, unit_of("MN").factor, unit_of("0.1 ms").factor, unit_of("furlong")
    (1000.0, 1000000.0, 0.0001, None)
    """
    plain = text.partition(" since ")[0].strip().translate(_SIGNS).strip()  # "seconds since 2026-01-01"
    multiple = _MULTIPLE.fullmatch(plain)
    single = plain if multiple is None else multiple[2]
    is_name = re.fullmatch(r"[a-z]\W", single, re.IGNORECASE)  # "d." and "F."
    spellings = (single, single.lower(), "" if is_name else canonical_unit(single))
    unit = next((_UNIT_BY_NAME[name] for name in spellings if name in _UNIT_BY_NAME), None)
    if unit is None or single in _AMBIGUOUS:
        return None
    quantity, name = unit
    times = 1.0 if multiple is None else float(multiple[1])
    return Unit(text=plain, quantity=quantity, factor=times * UNITS[quantity][name])


def split_unit(name: str) -> tuple[str, Unit | None]:
    """Take the unit from the end of a name: "Disp (mm)", "disp_mm", "acc_mm_s2", "Axial Disp mm".

    >>> split_unit("Axial Displacement [mm]")[0], split_unit("command_m")[1].text
    ('Axial Displacement', 'm')
    """
    trimmed = name.strip()
    for pattern, allowed_units in (
        (_BRACKETS, bool),
        (_RATE, bool),
        (_ENDING, lambda text: text.lower() not in _NOT_ENDINGS),
        (_LAST_WORD, lambda text: text.lower() in _SPACED_UNITS),
    ):
        match = pattern.search(trimmed)
        if match is not None and allowed_units(match[1]) and (unit := unit_of(match[1].replace("_", "/"))):
            return trimmed[: match.start()].strip(), unit
    return trimmed, None
