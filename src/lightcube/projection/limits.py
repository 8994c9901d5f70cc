"""How much is kept of a matrix, for all that must know it before anything is compiled."""

#: Pieces of rays that go one by one are kept up to so many, of `PIECE` bytes each; of more rays, and in numbers of 64
#: bits, they are found anew in every product.
MOST_PIECES, PIECE = 1 << 24, 16
