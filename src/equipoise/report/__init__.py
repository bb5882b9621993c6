"""What the user reads: prose for the terminal, one HTML page, pictures."""

from equipoise.verb_module import answer_calls

answer_calls(__name__)
