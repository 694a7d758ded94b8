// Pixels with a wrong shadow answer in one colour over the dimmed picture, and, where they are marked, rings around them.
uniform vec3 ring_color;
uniform float beneath;  // brightness of the picture

void main() {
    int mark = mark_at(pixel());
    vec3 color = beneath * displayed(texelFetch(color_buffer, pixel(), 0).rgb);
    if (outlines && on_border(primitive_at(pixel()))) color *= 0.35;
    if (marked && mark == RING) color = ring_color;
    if (mark == WRONG) color = wrong_color;
    finish_over(color);
}
