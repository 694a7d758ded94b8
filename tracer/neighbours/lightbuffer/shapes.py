"""What the kernels of the light buffer read and write: the tables of a face being divided, and what is kept of it.

A face is divided as `divide` says.  Its *items* are the primitives that a ray through the face may hit, with a row of
ITEM numbers and one of SPAN numbers each.
"""

from __future__ import annotations

import numpy as np

# Columns of an item: coefficients, of (x, y, 1) on the face, of U, V and D - U - V (`tracer.visibility.error_bounds`),
# which are greater than minus the bound at the end wherever a ray may hit; of the *near* function, which times the
# depth of a point is at least 1 wherever the item may block it; their error bounds; and what makes of it the *far*
# function, which times the depth is more than 1 only where the item surely does: times KEEP, less LESS.
U, V, W, NEAR, OF_U, OF_V, KEEP, LESS = 0, 3, 6, 9, 12, 13, 14, 15
ITEM = 16
# Columns of a span: least and greatest x and y of hits; the inverse of their least depth; 1 for what may cover a cell
# for certain, else 0; and the number of the item's row.
LOW_X, HIGH_X, LOW_Y, HIGH_Y, NEAREST, COVERS, NUMBER = range(7)
SPAN = 8

# Columns of what is known of a cell.  Two planes, each three numbers: their products with the way from the light to a
# point say that nothing is in between where the first is less than 1, and that something is where the second is more
# than 1.  Then the first of its candidates in the lists, and how many there are, int32; where rays are not tested
# against any, there are 0, and the first number is that of the row of what covers the cell, -1 for nothing.
LIT, BLOCKED, FIRST, COUNT = 0, 3, 6, 7
RECORD = 8
WIDTH_BITS = 5  # of a cell's number: the logarithm of how many cells its region is wide; the rest names its record
NOTHING = 0  # the record of cells in which nothing is: the first of every cube
NEVER = np.float32(1e30)  # instead of a coefficient of a plane: no point is before it
