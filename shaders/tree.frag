// A slice through a tree that rays build, through everything, over the dimmed picture: built parts by their level, and
// stripes where nothing is built; lines between parts, and white ones around objects and pieces.
uniform usampler2D tree_buffer;  // the level of the part at each pixel, with flags; NOTHING for none
uniform vec3 palette[2];         // the stripes
uniform float beneath;           // brightness of the picture
uniform float cell_line;         // brightness of the lines
const uint NOTHING = 0xFFFFu, LEVEL = 0xFFu, WAITS = 0x100u, LINE = 0x200u, BORDER = 0x400u, HIDDEN = 0x800u;
const int STRIPE = 4;

void main() {
    ivec2 p = pixel();
    uint code = texelFetch(tree_buffer, p, 0).r;
    if (code != NOTHING) {
        vec3 color = (code & WAITS) != 0u ? palette[(p.x + p.y) / STRIPE % 2] : mapped(in_range(float(code & LEVEL)));
        if ((code & LINE) != 0u) color *= cell_line;
        if ((code & HIDDEN) != 0u) color = shaded(color);
        finish_over((code & BORDER) != 0u ? vec3(1.0) : color);
        return;
    }
    if (primitive_at(p) < 0) { finish(background); return; }
    finish(beneath * displayed(texelFetch(color_buffer, p, 0).rgb));
}
