"""Opaque objects: hulls of silhouettes, what can be built, and the meshes that are printed of them."""
