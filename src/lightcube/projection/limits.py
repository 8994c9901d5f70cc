"""How much is kept of a matrix, for all that must know it before anything is compiled."""

#: Bytes that the pieces of rays which go one by one may take together unless it is said, and those of each: they are
#: kept in products of 32-bit numbers; where there is no room for all, they are found anew in every product.
ROOM, PIECE = 1 << 30, 16
