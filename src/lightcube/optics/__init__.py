"""What stands in the room (block, lamps, screens, turntable), and how light goes through it."""
