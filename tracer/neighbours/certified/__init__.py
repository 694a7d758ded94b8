"""Certified cells: shadow answers that are proved for whole pieces of a surface, before rays ask for them.

A triangle is cut, virtually and on demand, into a quadtree of cells (`quadtree`, `cells`).  For a cell and a light,
against all static geometry, `certify` finds one of these:

- FULL: some triangles together hide the light from all of the cell;
- LIT: no primitive comes between;
- CANDIDATES: only these few may;
- else the cell is divided, where rays request it, and its parts start from what may come between.

The rays to a cell end in a prism above it (`cell_prism`); what is sure of a prism, `tracer.visibility` proves.

While a frame is shaded, rays look up the cells they end in (`view`, `lookup`), which costs no step through a tree, and
test candidates instead of the tree (`candidates`).  Where they find too little they request more (`requests`).  The
`scheduler` spends a budget on what is requested most, by what certificates are worth (`cost_model`): requests are
gathered into tasks (`gather_requests`), which are run in parallel (`tasks`).  The `store` holds what is known, and
drops what no longer holds when something moves (`invalidate`).  What a cancelled frame has certified can be undone
(`journal`).  `slack` tells those who look how far a light may move before they fail.

Only `tracer.methods.certified` uses it.  docs/certified-cells.md tells it all.
"""
