"""The colours of the room, in linear light, and what it is made of: the page that is turned by hand has the same."""

#: The floor, far away, its lines; the table, its rim; a wall, a screen's back; a lamp that is off, edges, thin lines.
FLOOR, FAR, LINES = (0.05, 0.052, 0.058), (0.009, 0.0095, 0.0115), (0.1, 0.103, 0.11)
TABLE, RIM = (0.16, 0.16, 0.165), (0.5, 0.5, 0.5)
WALL, BACK = (0.022, 0.023, 0.026), (0.03, 0.03, 0.032)
OFF, EDGE, HINT = (0.12, 0.12, 0.13), (0.75, 0.86, 1.0), (0.9, 0.92, 1.0)
#: How dark shadows on the floor are, how much light air and walls throw back, and how much glass shines.
SHADE, GLOW, EMBER = 0.6, 0.5, 0.5
#: A lamp's radius and the width of a frame, in widths of the cube, and how far a wall goes on beyond its picture, in
#: widths of that; and paper beyond the pictures of films, in widths of those.
LAMP_RADIUS, FRAME, WALL_WIDTH, PAPER = 0.036, 0.014, 0.85, 0.06
#: Part of a picture that is seen through the screen's paper from behind.
THROUGH = 0.35
#: Glass is drawn clearer: a grey absorbance a lets through (1 + a / GREY) ^ -GREY, what a colour has more likewise.
GREY, COLOUR = 0.8, 1.1
