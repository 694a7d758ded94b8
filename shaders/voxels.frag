// A slice through voxels over the dimmed picture, by what is known of each voxel; lines where voxels, or blocks, end.
uniform usampler2D slice_buffer;  // the state of the voxel at each pixel, and whether its border is there; NOTHING for none
uniform vec3 palette[3];
uniform float beneath;            // brightness of the picture
uniform float cell_line;          // brightness of the lines
const uint NOTHING = 255u, LINE = 4u, STATE = 3u;

void main() {
    uint code = texelFetch(slice_buffer, pixel(), 0).r;
    if (code != NOTHING) {
        finish_over(palette[code & STATE] * ((code & LINE) != 0u ? cell_line : 1.0));
        return;
    }
    if (primitive_at(pixel()) < 0) { finish(background); return; }
    finish(beneath * displayed(texelFetch(color_buffer, pixel(), 0).rgb));
}
