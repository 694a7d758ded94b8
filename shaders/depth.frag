// Distance along the ray, near is bright; the range is that of the frame, or chosen.
uniform sampler2D depth_buffer;

void main() {
    float depth = texelFetch(depth_buffer, pixel(), 0).r;
    finish_mapped(1.0 - clamp(in_range(depth), 0.0, 1.0));
}
