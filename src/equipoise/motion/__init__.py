"""Motions: drivers of joints over time with exact velocities and accelerations."""

from equipoise.motion.drivers import Cycloidal, Driver, Expression, Samples, TimePolynomial, TimeSpline, as_driver
from equipoise.motion.motion import Motion, read_motion

__all__ = [
    "Cycloidal",
    "Driver",
    "Expression",
    "Motion",
    "Samples",
    "TimePolynomial",
    "TimeSpline",
    "as_driver",
    "read_motion",
]
