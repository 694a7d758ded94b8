// How many clusters of lights the cut at each pixel has, by their range; grey where that is not known yet.
uniform isampler2D cuts_buffer;  // clusters, -1 where not known yet

void main() {
    int nodes = texelFetch(cuts_buffer, pixel(), 0).r;
    if (nodes < 0 && primitive_at(pixel()) >= 0) finish(unknown);
    else finish_mapped(in_range(float(nodes)));
}
