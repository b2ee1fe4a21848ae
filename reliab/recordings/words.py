"""Words by which laboratories name their channels: what is measured, and in which part of the test.

English first, then German, Italian, Spanish, French and Chinese in pinyin. A word is recognised wherever it
stands in a name ("Act1_DispCmd", "Axial Displacement (mm)"). Nothing else in the package lists one; the page
of `reliab explore` takes them from here.
"""

from collections.abc import Mapping
from enum import StrEnum
from typing import Final


class Quantity(StrEnum):
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


class Role(StrEnum):
    """On which side of the transfer system a channel stands."""

    COMMAND = "command"
    MEASURED = "measured"
    GROUND = "ground"


QUANTITIES: Final[Mapping[Quantity, str]] = {
    Quantity.TIME: (
        "time times timer tout timestamp elapsed seconds zeit laufzeit messzeit uhrzeit zeitstempel tempo "
        "tiempo temps shijian"
    ),
    Quantity.DISPLACEMENT: (
        "pot potentiometer laser wa "
        "disp displ dis dsp displacement displacements stroke position pos lvdt ldt temposonic "
        "temposonics encoder travel deflection elongation weg wegaufnehmer kolbenweg verschiebung hub "
        "auslenkung spostamento spost corsa posizione desplazamiento desp carrera posicion "
        "deplacement weiyi xingcheng"
    ),
    Quantity.FORCE: (
        "messdose kraftmessdose "
        "force forces load loads loadcell lc frc forc kraft kraefte last pruefkraft forza carico "
        "carga fuerza effort li lizhi zaihe hezai shear reaction restoring"
    ),
    Quantity.ACCELERATION: (
        "acc accel accl acceleration accelerometer beschleunigung beschl accelerazione aceleracion jiasudu"
    ),
    Quantity.VELOCITY: "vel velo velocity speed geschwindigkeit velocita velocidad vitesse sudu",
    Quantity.VOLTAGE: "volt volts voltage spannung tensione voltaje dianya dac adc",
    Quantity.VALVE: "valve servovalve spool ventil servoventil valvola valvula servofa",
    Quantity.ROTATION: (
        "rotation rot angle winkel drehwinkel rotazione angolo giro angulo zhuanjiao moment torque"
    ),
    Quantity.STRAIN: "strain strains gauge gage dehnung deformacion yingbian",
    Quantity.PRESSURE: "pressure press druck oeldruck pressione presion yali",
    Quantity.TEMPERATURE: "temperature temp temperatur temperatura wendu",
    Quantity.CURRENT: "current amp amps amperage strom corrente corriente dianliu",
    Quantity.ERROR: "error err abweichung regelabweichung errore diff difference residual wucha",
    Quantity.COUNT: (
        "count counter index sample samples cycle cycles segment row zyklus zyklen ciclo ciclos"
    ),
    Quantity.STATE: (
        "status state flag trigger trig sync interlock mode enable gain pid power energy rate rms"
    ),
}
"""Words that say what is measured."""

ROLES: Final[Mapping[Role, str]] = {
    Role.COMMAND: (
        "command commanded commands cmd cmnd comm commandsignal targ target targeted tgt desired "
        "reference ref setpoint demand dem soll sollwert sollweg vorgabe comando riferimento consigna "
        "referencia deseado objetivo "
        "comandado comandato imposto desiderato consigne mingling zhiling mubiao qiwang"
    ),
    Role.MEASURED: (
        "measured measurement meas msd actual achieved feedback feedbk fbk fdbk fb istwert istweg ist "
        "gemessen misurato misurata misura effettivo medido medida mesure shice fankui celiang shiji"
    ),
    Role.GROUND: (
        "ground groundmotion base table shake shaketable earthquake eq quake excitation boden tisch "
        "erdbeben suolo tavola sisma terremoto suelo sismo dizhen dimian zhendongtai"
    ),
}
"""Words that say on which side of the transfer system a channel stands."""

WEAK_ROLES: Final[Mapping[Role, str]] = {
    Role.COMMAND: "input des in set",
    Role.MEASURED: "response resp output out sensor real reached act",
}
"""Words that say so only where no column does with a plainer one: `act` may be the actuator's."""

ALTERED: Final = (
    "drift filtered filt raw compensated comp compensation corrected smoothed delayed predicted "
    "estimated est "
    "simulated sim model ideal initial old previous offset peak max min mean gefiltert roh kompensiert "
    "filtrato compensato filtrado compensado lvbo buchang"
)
"""Words of a history that was changed, or is a part of one: another column is preferred."""

NEUTRAL: Final = (
    "actuator axial axis ax channel ch hydraulic north south east west horizontal vertical lateral long "
    "main outer inner kolben piston signal sig data rig jack ram cylinder cyl specimen test floor story "
    "zylinder kanal attuatore actuador canale canal tongdao of the x y z"
)
"""Words that decide nothing; they are known so that names without gaps can be taken apart."""

SYMBOLS: Final[Mapping[str, tuple[Quantity, Role | None]]] = {
    "t": (Quantity.TIME, None),
    **dict.fromkeys(("xc", "uc", "dc", "xd", "ud"), (Quantity.DISPLACEMENT, Role.COMMAND)),
    **dict.fromkeys(("xm", "um", "dm"), (Quantity.DISPLACEMENT, Role.MEASURED)),
    **dict.fromkeys(("fm", "fe", "fmeas", "fmeasured", "fact"), (Quantity.FORCE, Role.MEASURED)),
    **dict.fromkeys(("ag", "agm", "xgdd", "xddg", "ugdd", "uddg"), (Quantity.ACCELERATION, Role.GROUND)),
}
"""Symbols of equations, as whole names without the signs in them: x_c, u_m."""

COMMAND_ENDINGS: Final = "cdtr"
"""Last letters of names that mean the command, where the same name ends in one of the next, too."""

MEASURED_ENDINGS: Final = "ma"
