"""Discovery: which springs at all, from a dictionary of candidates."""
