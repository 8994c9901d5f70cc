"""Program 3: from a cube to its shadows at any angle."""
