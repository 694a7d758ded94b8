"""The paper's kd-tree, whose traversal steps are counted as the paper counts them."""
