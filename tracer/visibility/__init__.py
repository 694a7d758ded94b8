"""Prove what surely blocks, or surely misses, all shadow rays from a light to a receiver.

A light is a *hull* of places from which rays start: a point, a ball around a lamp's samples, a box around the samples
of several.  A receiver is a hull of places where they end: a point, the prism above a cell, a box of space.  Whatever
is proved has to hold of the float32 numbers that the ray kernels compute.  `tracer.neighbours` use this package, each
for receivers of its own; it knows none of them.

*The question.*  A ray starts at L, ends at P, and has the direction d = P - L.  A triangle has a corner a, edges e1 and
e2, and n = e1 x e2; let s = L - a.  Both acceleration structures compute

    U = d . (e2 x s)     V = d . (s x e1)     D = -d . n     T = s . n     W = D - U - V     B = D - T

and report a hit where, times the sign of D, none of U, V, W and B is negative and T is positive; and where t = T / D
lies beyond the part LAMP of the way that the lamp may take up.

*The functions are extreme at the corners.*  As s . (e2 x s) = 0, U = (P - a) . (e2 x s): linear in P for each L, and
linear in L for each P.  So is V.  B = (a - P) . n is linear in P alone, T in L alone, so that D and W are as U.  Over
two convex hulls such a function is greatest where both P and L are extreme points: fix L, then P.  For x in a hull, a
linear function f with gradient g has these extremes:

    a point c:                   f(c)
    a ball of radius r at c:     f(c) - r |g|  to  f(c) + r |g|
    a box of half sides h at c:  f(c) - h . |g|  to  f(c) + h . |g|
    a prism:                     the least and the greatest at its six corners

All functions are taken times the sign of T, the *side* on which the light is.  Only where this is the same, beyond
rounding, for all of the light, are they still linear in L: then the side is *sure*.

*What float32 may be wrong by.*  Let eps = 2^-24.  Each component of s and d has a relative error of eps, each of a
cross product an error below 3 eps of the product of the lengths, and a dot product one below 3 eps of the same.  In U
these are eps for s and eps for d, 3 eps for the cross and 3 eps for the dot product, and eps for what is of second
order: U is wrong by at most 9 eps |s| |e2| |d|, V by 9 eps |s| |e1| |d|, and D by 9 eps |e1| |e2| |d|, of which at most
4 eps come with n.  D and T share one n, so that its error enters B by 4 eps |e1| |e2| |P - a| alone; the rest of B's is
4 eps |n| (|d| + |s|), and 3 eps |T| for t.  That is how rays can end so close above their own triangle.  W bears the
errors of all three.  The reciprocal that u and v are multiplied with adds 6 eps |D|, and the fast structure takes a
triangle to be 2e-6 of itself larger.  The bounds m are these sums, a quarter enlarged (`error_bounds.bounds`).  The
functions are computed here in float32, too: that adds as much again to U, V and W, and 8 eps |e1| |e2| |P - a| and 2
eps |n| |P| to B, which is taken from P - a.  Over hulls |s|, |d|, |P - a| and |D| are the greatest that there are.

*The range.*  SMALL is added to all bounds, for what underflows.  Where an edge, |s| or |d| is longer than LARGE, or
float32 cannot hold a product of them, bounds are infinite or NaN, and nothing is certain.  So verdicts 1 to 3 are given
for lengths from about 1e-10 to those of 1e9 that scene files may have.  Verdict 4 says what kernels report, at any
length: of triangles smaller than 1e-15 they do not report all that rays cross.

*Corners that are not known.*  In the kd-tree a resting triangle is met by rays that are carried to it in float32.  It
is as if each corner were somewhere within c, its `corner_error`, of where it is taken to be.  Each point of the real
triangle is then within c of the other.  U is a determinant: its gradient in one end of its edge is |d| times the
distance of the line from the other end.  A line that hits either triangle is no further than |e| + 2 c from the corners
of both, with e the longer edge, so that between them U differs by less than 2 c (|e| + 2 c) |d|: 5 c (|e| + c) |d|,
which m grows by, is more.  The bound of B grows by 4 c |n|, so that an end beyond it is not within c of the plane; and
T is only certain where no displaced plane has the light on its other side (`unsure_of_t`).

*Verdicts.*  Let f- and f+ be the least and the greatest of a function over both hulls.

1. Hit, where the side is sure, U-, V- and W- are above 3.5 m and B- above m, and T above LAMP of |D|.  Of the 3.5 m
   one is for the comparisons and one for our own errors.  The rest is for boxes: the structures report a hit only
   where t lies in a box, or beyond a plane.  The line passes the box, as it passes the triangle; but t is wrong by
   (4 eps |e1| |e2| |X - a| + 11 eps |n| |s|) / D at most, where X is the hit.  *Across* the plane that moves X by no
   more than 11 eps |s|, and what n adds, for which boxes are padded as long as no ray is longer than `SureHitLength`,
   13 eps of it.  *Along* the plane, the second term moves U by 11 eps |s| |e2| |d|, less than the 1.5 m that are
   left.  The first is much less than it looks: as (X - a) . n = 0 before rounding, each of its products has one
   factor for each axis, so that it is small wherever the box is thin.  No proof is given here that this is enough for
   a sliver that is lit from much closer than it is long; sixteen million such hits were tried, and all were reported.
2. Miss, where one of U+, V+, W+ and B+ is below -m; or where a sum of two functions with positive factors, bounds added
   to both, is negative at all corners: both would have to be -m at least.
3. Miss by a plane.  A hit has a B of at least -m, and so a D of at least T - m: the *depth*.  The point where the line
   meets the triangle's plane then has barycentric coordinates of at least -m / depth, and lies beyond P by at most
   m / depth of |d|.  If all of the triangle is before a plane by more than the sum of both, 2 (m / depth) of its own
   extent across the plane and (m / depth) |d|, then no ray behind that plane hits it.  With the longest ray of the
   scene, that sum is the triangle's *error radius* (`occluders`): no ray hits it that stays further away.
4. Miss by a box.  Where functions are noise, as the light lies in the triangle's plane, a hit counts only near the
   triangle all the same: the kd-tree asks where the ray is at t (`hit_triangle`), the fast structure in which block's
   box.  A ray reports no hit if it misses this box, made larger by REPORTED of the light's distance.

All else is unsure, and left to rays.  Two hulls of points make rays: there, 1 and 2 say nearly all (`light_space`).

*To read*, in this order: `error_bounds`, the numbers and the evaluator; `light_space` (point lights; points and boxes),
`classify` (points and balls; prisms) with `fused` triangles, `area_light_tests` (balls; points), `hidden_lights`
(boxes; boxes).  Then what is looked for and where: `shaft` and `beams`, `occluders` and `tree_walk`, `search`.
"""
