// Distance along the ray, near is bright; the range is that of the frame.
uniform sampler2D depth_buffer;
uniform vec2 range;

void main() {
    float depth = texelFetch(depth_buffer, pixel(), 0).r;
    finish_mapped(1.0 - clamp((depth - range.x) / (range.y - range.x), 0.0, 1.0));
}
