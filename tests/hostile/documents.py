"""Documents that several tests give."""

#: A stage of one picture, `one.png` beside it.
STAGE = """
[cube]
shape = [6, 5, 7]
size_mm = 100
[[lamp]]
name = "lamp"
direction = [1, 0, -0.2]
[[screen]]
name = "wall"
centre_mm = [150, 0, -30]
size_mm = [75, 75]
[[picture]]
file = "one.png"
screen = "wall"
"""
