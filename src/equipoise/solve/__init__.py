"""Convex programs over affine residuals, their certificates, and shaping of geometry around them."""
