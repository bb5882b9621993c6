"""equipoise designs balanced mechanisms: springs and counterweights that take the weight off motors."""
