"""How kernels are compiled (`kernels`), kept on the disk (`kernel_cache`) and run by all cores (`parallel`). Whatever
has a kernel uses it; it knows none of them.
"""
