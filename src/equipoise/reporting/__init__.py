"""What the user reads: prose for the terminal, one HTML page, pictures."""
