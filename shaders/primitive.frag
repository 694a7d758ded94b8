// A colour of its own for every primitive: its number, well mixed, picks hue, strength and brightness.
uint mixed(uint n) {  // the finaliser of a good integer hash (lowbias32)
    n ^= n >> 16; n *= 0x7feb352du;
    n ^= n >> 15; n *= 0x846ca68bu;
    return n ^ (n >> 16);
}

vec3 hue(float h) { return clamp(abs(fract(h + vec3(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0, 0.0, 1.0); }

void main() {
    int primitive = primitive_at(pixel());
    if (primitive < 0) { finish(background); return; }
    uint n = mixed(uint(primitive) + 1u);
    float strength = 0.35 + 0.5 * float((n >> 16) & 255u) / 255.0;
    float brightness = 0.6 + 0.4 * float((n >> 24) & 255u) / 255.0;
    finish(shaded(mix(vec3(1.0), hue(float(n & 65535u) / 65536.0), strength) * brightness));
}
