"""Methods beside the paper's: what each keeps of a scene, and how its kernels ask for it.

Certified cells, area lights, regions, voxels, environments and the light buffer are siblings, a package each: all prove
what is visible by `tracer.visibility`, and none imports another.  Only `tracer.methods` uses them, and what shows them.
"""
