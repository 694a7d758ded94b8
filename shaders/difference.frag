// Pixels with a wrong shadow answer in one colour on black, and, where they are marked, rings around them.
uniform vec3 ring_color;

void main() {
    int mark = mark_at(pixel());
    vec3 color = outlines && on_border(primitive_at(pixel())) ? vec3(0.15) : vec3(0.0);
    if (marked && mark == RING) color = ring_color;
    if (mark == WRONG) color = wrong_color;
    finish_over(color);
}
