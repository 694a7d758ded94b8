"""What became of the rays of one pixel, and why: `why.py` for each light, `ray_tree.py` ray by ray."""
