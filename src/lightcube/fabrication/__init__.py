"""What leaves the program to be made: files for printers, lasers and other programs, and what those would cast."""
