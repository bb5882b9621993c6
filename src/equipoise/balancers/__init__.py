"""What one adds to a mechanism: springs (path x law) and counterweights."""
