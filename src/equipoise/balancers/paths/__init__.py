"""Paths: how a deformation follows the mechanism, one class per file."""

from equipoise.balancers.paths.absolute import Absolute
from equipoise.balancers.paths.angle import Angle
from equipoise.balancers.paths.cable import Cable
from equipoise.balancers.paths.cam import Cam
from equipoise.balancers.paths.drum import Drum
from equipoise.balancers.paths.four_bar import FourBar
from equipoise.balancers.paths.gear import Gear
from equipoise.balancers.paths.inverted_slider_crank import InvertedSliderCrank
from equipoise.balancers.paths.line import Line
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Need, Path, Place, Sketch
from equipoise.balancers.paths.pinion import Pinion
from equipoise.balancers.paths.profile import ConstantEnergy, ConstantTorque, Lift, Profile
from equipoise.balancers.paths.pulley import Pulley
from equipoise.balancers.paths.reel import Reel
from equipoise.balancers.paths.scotch_yoke import ScotchYoke
from equipoise.balancers.paths.shaft import Shaft
from equipoise.balancers.paths.slider_crank import SliderCrank
from equipoise.balancers.paths.swivel import Swivel
from equipoise.balancers.paths.turn import Turn
from equipoise.balancers.paths.winding import Winding

__all__ = [
    "Absolute",
    "Angle",
    "Cable",
    "Cam",
    "ConstantEnergy",
    "ConstantTorque",
    "Drum",
    "FourBar",
    "Gear",
    "InvertedSliderCrank",
    "Lift",
    "Line",
    "Mount",
    "Need",
    "Path",
    "Pinion",
    "Place",
    "Profile",
    "Pulley",
    "Reel",
    "ScotchYoke",
    "Shaft",
    "Sketch",
    "SliderCrank",
    "Swivel",
    "Turn",
    "Winding",
]
