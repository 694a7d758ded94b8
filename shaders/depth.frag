// Distance along the ray, near is bright; the range is that of the frame.
uniform sampler2D depth_buffer;
uniform sampler2D color_map;
uniform vec2 range;

void main() {
    float depth = texelFetch(depth_buffer, pixel(), 0).r;
    if (primitive_at(pixel()) < 0) { finish(background); return; }
    float t = clamp((depth - range.x) / (range.y - range.x), 0.0, 1.0);
    finish(texture(color_map, vec2(1.0 - t, 0.5)).rgb);
}
