"""How good a cube is: figures, between the stops, in a set-up that is off."""
