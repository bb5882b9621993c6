"""Independent verification of a design: MuJoCo, energy, and the poses between the samples."""

from equipoise.verb_module import answer_calls

answer_calls(__name__)
