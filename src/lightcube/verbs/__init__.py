"""What can be asked of the program, without a terminal and without a network."""
