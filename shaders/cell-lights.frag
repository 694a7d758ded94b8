// How many lights the cell of each pixel must look at, by their range; grey where that is not known. Lines between cells.
uniform isampler2D cell_lights_buffer;  // lights, -1 where not known
uniform isampler2D cell_buffer;         // number of the cell, -1 for none
uniform float cell_line;                // brightness of the lines

int cell_at(ivec2 p) { return texelFetch(cell_buffer, clamp(p, ivec2(0), textureSize(cell_buffer, 0) - 1), 0).r; }

void main() {
    ivec2 p = pixel();
    if (primitive_at(p) < 0) { finish(background); return; }
    int lights = texelFetch(cell_lights_buffer, p, 0).r, cell = cell_at(p);
    bool on_line = cell_at(p + ivec2(1, 0)) != cell || cell_at(p + ivec2(0, 1)) != cell;
    finish((lights < 0 ? unknown : mapped(in_range(float(lights)))) * (on_line ? cell_line : 1.0));
}
