"""From a force curve to metal: cams and drums, their profiles, a wrap simulation, DXF and CSV."""

from equipoise.make.cams import CamWithSpring, ConstantForceCam, DrumWithTorsion
from equipoise.make.curves import ForceCurve, arm_curve, law_curve
from equipoise.make.export import write_csv, write_dxf
from equipoise.make.profile import Winding, WoundProfile, wind
from equipoise.make.requests import MakeArmCam, MakeCam, MakeConstantForceCam, MakeDrum
from equipoise.make.synthesis import Part, arm_cam, make_part, make_spring
from equipoise.make.wrap import Wrapped, simulate

__all__ = [
    "CamWithSpring",
    "ConstantForceCam",
    "DrumWithTorsion",
    "ForceCurve",
    "MakeArmCam",
    "MakeCam",
    "MakeConstantForceCam",
    "MakeDrum",
    "Part",
    "Winding",
    "WoundProfile",
    "Wrapped",
    "arm_cam",
    "arm_curve",
    "law_curve",
    "make_part",
    "make_spring",
    "simulate",
    "wind",
    "write_csv",
    "write_dxf",
]
