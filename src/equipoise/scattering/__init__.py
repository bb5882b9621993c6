"""What scatter of the parts and of the robot makes of a design, and which adjuster takes most of it back."""

from equipoise.scattering.band import SAMPLES, Alone, Band, Retuned, Tolerance, followed, tolerance
from equipoise.scattering.scatter import Scatter

__all__ = ["SAMPLES", "Alone", "Band", "Retuned", "Scatter", "Tolerance", "followed", "tolerance"]
