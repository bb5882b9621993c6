"""Gas springs as a data sheet describes them: bore, rod, stroke, bottle."""

from __future__ import annotations

import math
from typing import Literal

from equipoise.balancers.laws.charge import ROOM, STANDARD, positive, say
from equipoise.balancers.laws.gas import Gas
from equipoise.balancers.laws.nitrogen import Nitrogen
from equipoise.errors import InputError
from equipoise.units import Length, Number, Pressure, Temperature, Volume


def gas_cylinder(
    bore: Length,
    stroke: Length,
    retracted: Length,
    auxiliary: Volume,
    *,
    rod: Length = 0.0,
    chamber: Literal["cap", "rod", "both"] = "cap",
    charged_length: Length | None = None,
    pressure: Pressure | None = None,
    exponent: Number | Nitrogen = 1.4,
    reading: Literal["absolute", "gauge"] = "gauge",
    ambient: Pressure = STANDARD,
    charged_at: Temperature = ROOM,
    temperature: Temperature = ROOM,
) -> Gas:
    """The gas law of a pneumatic cylinder with an auxiliary volume, or of a strut.

        cap:   A = pi bore^2 / 4,          V = Vaux + A (l - retracted), pushes
        rod:   A = pi (bore^2 - rod^2) / 4, V = Vaux + A (retracted + stroke - l), pulls
        both:  A = pi rod^2 / 4,           V = Vaux + A (l - retracted), pushes (the piston lets the gas pass)

    bore and rod are diameters, m; stroke and the pin-to-pin length `retracted` in m; auxiliary Vaux in m^3 is the gas
    left at full compression: in the dead space and in the bottle. The pressure is stated at charged_length, m, half
    way by default, as `gauge` unless said. Both variants of Quaglia & Yin 2015, Fig. 28, push or pull
    [quaglia_yin_2015]. Raises InputError for lengths, a volume or an area that are not positive, a rod as thick as
    the bore, a charged length that the cylinder does not reach, and for what Gas refuses.
    """
    where = "law gas_cylinder"
    for name, value in (("bore", bore), ("stroke", stroke), ("retracted", retracted), ("auxiliary", auxiliary)):
        positive(value, name, where)
    if not 0 <= rod < bore:
        raise InputError(f"the rod is {say(rod)} m, it must be between 0 and the bore, {say(bore)} m", where=where)
    if chamber != "cap" and not rod > 0:
        raise InputError(f"chamber {chamber!r} needs a rod", where=where, hint="give the rod's diameter")
    at = retracted + stroke / 2 if charged_length is None else charged_length
    if not retracted <= at <= retracted + stroke:
        raise InputError(
            f"the charged length is {say(at)} m, the cylinder reaches {say(retracted)} to {say(retracted + stroke)} m",
            where=where,
        )
    squares = {"cap": bore**2, "rod": bore**2 - rod**2, "both": rod**2}
    area = math.pi / 4 * squares[chamber]
    swept = retracted + stroke - at if chamber == "rod" else at - retracted
    return Gas(
        area,
        auxiliary + area * swept,
        at,
        pressure,
        exponent,
        "pull" if chamber == "rod" else "push",
        reading,
        ambient,
        charged_at,
        temperature,
    )
