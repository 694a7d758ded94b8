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

The signs are turned so that T is positive.  Where T's sign is the same, beyond rounding, for all of the light the
triangle is *firm*.  Only of firm triangles is U turned linear in L.

*What float32 may be wrong by.*  Let eps = 2^-24.  Each component of s and d is wrong by eps of itself, each of a cross
product by less than 3 eps of the product of the lengths, and a dot product by 3 eps of the same.  So U is wrong by at
most 9 eps |s| |e2| |d|, V by 9 eps |s| |e1| |d|, and D by 9 eps |e1| |e2| |d|, of which 4 eps come with n.  D and T
share one n, so that its error tells in B by 4 eps |e1| |e2| |P - a| alone; the rest of B's is 4 eps |n| (|d| + |s|),
and 3 eps |T| for t.  That is how rays can end so close above their own triangle.  W bears the errors of all three.  The
reciprocal that u and v are multiplied with adds 6 eps |D|, and the fast structure takes a triangle to be 2e-6 of itself
larger.  The bounds m are these sums, a quarter enlarged (`error_bounds.bounds`).  The functions are computed here in
float32, too: that adds as much again to U, V and W, and 8 eps |e1| |e2| |P - a| and 2 eps |n| |P| to B, which is taken
from P - a.  Over hulls |s|, |d|, |P - a| and |D| are the greatest that there are.

In the kd-tree a resting triangle is met by rays that are carried to it in float32: its corners are somewhere within
`blur` of where they are taken to be.  Between two rays that pass a point that close U changes by no more than |e| |d| a
unit of length, and five times that where the light is as near as the triangle is long: so m grows by 5 blur |e| |d|,
and that of B by 4 blur |n|.  Only T's sign is known worse by as much as the light is far.

*Verdicts.*  Let f- and f+ be the least and the greatest of a function over both hulls.

1. Hit, where the triangle is firm, U-, V- and W- are above 3.5 m and B- above m, and T above LAMP of |D|.  One m is for
   the comparisons, one for our own errors.  The rest lets the structures ask at all: they do so where t lies in a box
   or beyond a plane, and t is wrong by 13 eps |s| |n| / D.  Along the plane of the triangle that is less than 2.5 m,
   and so a point that far inside the triangle stays there.  Across it, it is 13 eps |d|, for which boxes are padded as
   long as no ray is longer than `SureHitLength`.
2. Miss, where one of U+, V+, W+ and B+ is below -m; or where a sum of two functions with positive factors, bounds added
   to both, is negative at all corners: both would have to be -m at least.
3. Miss by a plane.  A hit has B of -m at least, and so D of T - m: the *depth*.  Then the point where line and plane
meet
   has barycentric coordinates of -m / depth at least, and lies beyond P by m / depth of |d| at most.  A triangle that
   lies before a plane by more than 2 (m / depth) of its own extent across it, and that, is missed by all rays behind
   it. With the whole scene's longest ray, that is its *error radius* (`occluders`): no ray that passes that far by hits
   it.
4. Miss by a box.  Where functions are noise, as the light lies in the triangle's plane, a hit counts only near the
   triangle all the same: the kd-tree asks where the ray is at t (`hit_triangle`), the fast structure in which block's
   box.  What passes this box by, REPORTED of the light's distance larger, does not hit.

All else is unsure, and left to rays.  Two hulls of points make rays: there, 1 and 2 say nearly all (`light_space`).

*To read*, in this order: `error_bounds`, the numbers and the evaluator; `light_space` (point lights; points and boxes),
`classify` (point lights; prisms) with `fused` triangles, `area_light_tests` (balls; points), `hidden_lights` (boxes;
boxes).  Then what is looked for and where: `shaft` and `beams`, `occluders` and `tree_walk`, `search`.
"""
