// The shadow mode of the unit that is seen, for one light: bits 2 + 2 l and the next. Units that move
// (occlusion mode 3) have none and get the palette's last colour; so has a light that culling does not cover. Where a
// unit would be culled by its mode if it were fully rendered (occlusion mode 2), there are stripes.
uniform vec3 palette[5];
uniform int light;   // -1: not covered by culling
uniform int stripe;  // pixels across which a stripe goes, and the gap beside it
const int FULLY_RENDERED = 2, DYNAMIC = 3, INIT = 0, FULL_SHADOW = 1, NON_SHADOW = 2;

void main() {
    ivec2 p = pixel();
    int unit = unit_at(p);
    if (unit < 0) { finish(background); return; }
    int mode = light < 0 ? INIT : mode_bits(unit, 2 + 2 * light), seen = mode_bits(unit, 0);
    bool untrusted = (mode == FULL_SHADOW || mode == NON_SHADOW) && seen != FULLY_RENDERED;
    if (untrusted && (p.x + p.y) / stripe % 2 == 1) mode = INIT;
    if (seen == DYNAMIC) mode = 4;
    finish(shaded(palette[mode]));
}
