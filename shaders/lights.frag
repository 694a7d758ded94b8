// How many lights each pixel faces, by their range; grey where that is not known yet.
uniform isampler2D lights_buffer;  // lights, -1 where not known yet

void main() {
    int due = texelFetch(lights_buffer, pixel(), 0).r;
    if (due < 0 && primitive_at(pixel()) >= 0) finish(unknown);
    else finish_mapped(in_range(float(due)));
}
