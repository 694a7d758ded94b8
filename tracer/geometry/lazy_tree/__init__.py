"""The kd-tree with subtrees that are built when the first ray arrives."""
