// Rays traced for each pixel, by their range, or their share of those that tracing without culling takes.
uniform isampler2D cost_buffer;
uniform isampler2D saved_buffer;

void main() {
    int cost = texelFetch(cost_buffer, pixel(), 0).r;
    finish_work(cost, cost + texelFetch(saved_buffer, pixel(), 0).r);
}
