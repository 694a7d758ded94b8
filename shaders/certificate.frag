// The certificate of each pixel's cell for one light, where a shadow mode has its bits; what moves (occlusion mode 3)
// has none and gets the palette's last colour. Between cells there are lines.
uniform usampler2D certificate_buffer;  // low and high half of the packed word of certificates
uniform isampler2D cell_buffer;         // number of the cell, -1 for none
uniform vec3 palette[5];
uniform int light;                      // -1: not covered by culling
uniform float cell_line;                // brightness of the lines
const int DYNAMIC = 3;

int cell_at(ivec2 p) { return texelFetch(cell_buffer, clamp(p, ivec2(0), textureSize(cell_buffer, 0) - 1), 0).r; }

void main() {
    ivec2 p = pixel();
    int unit = unit_at(p);
    if (unit < 0) { finish(background); return; }
    int certificate = light < 0 ? 0 : two_bits(texelFetch(certificate_buffer, p, 0).rg, 2 + 2 * light);
    if (mode_bits(unit, 0) == DYNAMIC) certificate = 4;
    int cell = cell_at(p);
    bool on_line = cell_at(p + ivec2(1, 0)) != cell || cell_at(p + ivec2(0, 1)) != cell;
    finish(shaded(palette[certificate]) * (on_line ? cell_line : 1.0));
}
