"""The verbs: each one function, one command."""
